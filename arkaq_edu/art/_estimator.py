"""What the four networks share: scikit-learn's conventions, and room for a growing number of rows.

A network adds three things: what its parameters allow, how it learns rows, and how it recalls them.
"""

from __future__ import annotations

from typing import Any, Self

import numpy as np
from numpy.typing import ArrayLike, NDArray

from arkaq_edu._checks import affordable, array
from arkaq_edu.art._scikit import (
    BaseEstimator,
    ClusterMixin,
    check_array,
    check_is_fitted,
    validate_data,
)

Floats = NDArray[np.float64]
Labels = NDArray[np.int64]


class Categories(ClusterMixin, BaseEstimator):
    """Categories that are founded and learned one pattern at a time.

    The arrays named in `_rows` have one row per category and spare rows for new ones. The first
    `_n` rows are in use.
    """

    _rows: tuple[str, ...] = ("_centers", "_counts")
    _centers: Floats
    _counts: Labels
    _n: int
    labels_: Labels
    n_features_in_: int
    _checked: Any  # the parameters as `_parameters` returned them, or None if they must be checked

    def __setattr__(self, name: str, value: Any) -> None:
        """Set an attribute; if it is a parameter, it is checked before it is used."""
        super().__setattr__(name, value)
        if not name.startswith("_"):
            self.__dict__["_checked"] = None

    def _parameters(self, n_features: int) -> Any:
        """Return the validated parameters as a NamedTuple."""
        raise NotImplementedError

    def _valid(self) -> Any:
        """Return the validated parameters; they are checked once, not for each pattern."""
        if self._checked is None:
            self._checked = self._parameters(self.n_features_in_)
        return self._checked

    def _learn_rows(self, X: Floats, parameters: Any) -> tuple[Labels, int]:
        """Learn the rows of `X`; return their categories and the new number of categories."""
        raise NotImplementedError

    def _recall_rows(self, X: Floats, parameters: Any) -> Labels:
        """Return the category of each row of `X`; learn nothing."""
        raise NotImplementedError

    def _admit(self, X: Floats) -> Floats:
        """Return finite patterns in the form that the network takes, or raise `ValueError`."""
        return X

    def fit(self, X: ArrayLike, y: Any = None) -> Self:
        """Forget everything, then learn the patterns once each, in the given order.

        Parameters
        ----------
        X : array-like of shape (n_samples, n_features)
            The patterns, finite.
        y : ignored
            Part of scikit-learn's interface.

        Returns
        -------
        self

        Raises
        ------
        ValueError
            For a parameter out of range, or an `X` of the wrong shape, not finite, or not of the
            kind that the network takes.
        """
        return self._fit(X, fresh=True)

    def partial_fit(self, X: ArrayLike, y: Any = None) -> Self:
        """Learn more patterns, in the given order, and keep the present categories.

        Parameters, errors and result are those of `fit`. A stream learned in pieces gives the same
        categories as the whole stream learned at once.
        """
        return self._fit(X, fresh=not self.__sklearn_is_fitted__())

    def learn_one(self, x: ArrayLike) -> int:
        """Learn one pattern of shape (n_features,) and return its category, in microseconds.

        The categories change as under `partial_fit` with one row. `labels_` does not change.

        Raises
        ------
        ValueError
            As for `fit`.
        """
        if not self.__sklearn_is_fitted__():
            return int(self.partial_fit([array("x", x, (None,))]).labels_[0])
        return int(self._learn(self._pattern(x), self._valid())[0])

    def predict(self, X: ArrayLike) -> Labels:
        """Return the category of each pattern; learn nothing.

        Parameters
        ----------
        X : array-like of shape (n_samples, n_features)
            The patterns, finite.

        Returns
        -------
        ndarray of shape (n_samples,)
            Indices into `cluster_centers_`, or -1 where the class says so.

        Raises
        ------
        sklearn.exceptions.NotFittedError
            If nothing has been learned yet.
        ValueError
            As for `fit`.
        """
        check_is_fitted(self)
        rows = self._patterns(X)
        validate_data(self, X, reset=False, skip_check_array=True)
        return self._recall_rows(rows, self._valid())

    def category(self, x: ArrayLike) -> int:
        """Return the category of one pattern of shape (n_features,), in microseconds.

        It is the category that `predict` returns, and the errors are the same.
        """
        if not self.__sklearn_is_fitted__():
            check_is_fitted(self)  # raises; too slow to call every time
        return int(self._recall_rows(self._pattern(x), self._valid())[0])

    @property
    def cluster_centers_(self) -> Floats:
        """The centers, shape (n_clusters, n_features), in the order of founding (a copy)."""
        return self._centers[: self._n].copy()

    @property
    def counts_(self) -> Labels:
        """How many patterns each category has learned (a copy)."""
        return self._counts[: self._n].copy()

    @property
    def n_clusters_(self) -> int:
        """Number of categories."""
        return self._n

    def __sklearn_is_fitted__(self) -> bool:
        return hasattr(self, "_n")

    def _fit(self, X: ArrayLike, fresh: bool) -> Self:
        rows = self._patterns(X)
        parameters = self._parameters(rows.shape[1])
        validate_data(self, X, reset=fresh, skip_check_array=True)  # number and names of features
        if fresh:
            for name in self._rows:
                setattr(self, name, np.empty((0, rows.shape[1])))
            self._counts, self._n = np.empty(0, np.int64), 0
        self.labels_ = self._learn(rows, parameters)
        self._checked = parameters
        self._resize(self._n)
        return self

    def _learn(self, X: Floats, parameters: Any) -> Labels:
        if self._n + len(X) > len(self._counts):  # each pattern may found a category
            self._resize(max(self._n + len(X), 2 * self._n))
        labels, n = self._learn_rows(X, parameters)
        if n > self._n:
            self._n = n
        return labels

    def _resize(self, capacity: int) -> None:
        """Give the arrays `capacity` rows."""
        for name in self._rows:
            used = getattr(self, name)[: self._n]
            spare = np.empty((capacity - self._n, *used.shape[1:]), used.dtype)
            setattr(self, name, np.concatenate([used, spare]))

    def _patterns(self, X: ArrayLike) -> Floats:
        """Return `X` as validated rows."""
        affordable("X", getattr(X, "shape", ()))
        try:
            rows = check_array(X, dtype=np.float64, order="C", estimator=self, input_name="X")
        except (TypeError, ValueError, OverflowError) as refusal:
            kind = TypeError if isinstance(refusal, TypeError) else ValueError
            raise kind(f"X must hold patterns as rows of finite numbers: {refusal}") from None
        array("X", X, rows.shape)  # refuses what scikit-learn lets pass: masks, text, huge numbers
        # Kernels are compiled for arrays that can be written to.
        return np.require(self._admit(rows), requirements=["C", "W"])

    def _pattern(self, x: ArrayLike) -> Floats:
        """Return the pattern `x` as one validated row."""
        return self._admit(np.array(array("x", x, (self.n_features_in_,)), ndmin=2))

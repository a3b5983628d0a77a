"""What all networks of the ART room share: scikit-learn's manners, and the state they keep."""

from __future__ import annotations

import math
from typing import Any, Self

import numpy as np
from numpy.typing import ArrayLike, NDArray
from sklearn.base import BaseEstimator, ClusterMixin
from sklearn.utils.validation import check_array, check_is_fitted, validate_data

from arkaq_edu._checks import array

Floats = NDArray[np.float64]
Labels = NDArray[np.int64]


class Categories(ClusterMixin, BaseEstimator):
    """Categories that are founded and learned one pattern at a time.

    A network says what it does with the patterns in `_learn_rows` and `_recall_rows`, what its
    parameters allow in `_parameters`, and which of its arrays have a row for each category in
    `_rows`. Categories are kept in arrays with room to spare, of which the first `_n` rows count.
    """

    _rows: tuple[str, ...] = ("_centers", "_counts")
    _centers: Floats
    _counts: Labels
    _n: int
    labels_: Labels
    n_features_in_: int

    def _wishes(self) -> tuple:
        """Return the parameters as the user set them."""
        raise NotImplementedError

    def _parameters(self) -> tuple:
        """Return the parameters, validated, in the form the kernels take."""
        raise NotImplementedError

    def _learn_rows(self, X: Floats, done: int, labels: Labels) -> tuple[int, int]:
        """Learn ``X[done:]``; return where it stopped for want of room, and the new `_n`."""
        raise NotImplementedError

    def _recall_rows(self, X: Floats, labels: Labels) -> None:
        """Write the category of each row of `X` into `labels`, learning nothing."""
        raise NotImplementedError

    def _admit(self, X: Floats) -> Floats:
        """Return finite patterns as the network takes them, or refuse them."""
        return X

    def fit(self, X: ArrayLike, y: Any = None) -> Self:
        """Forget everything, then learn the patterns in the order given, once each.

        Parameters
        ----------
        X : array-like of shape (n_samples, n_features)
            The patterns, finite.
        y : ignored
            Present for scikit-learn's sake.

        Returns
        -------
        self

        Raises
        ------
        ValueError
            For a parameter out of range, or an `X` of the wrong shape, not finite, or not of the
            kind the network takes.
        """
        self._parameters()
        return self._learn(self._patterns(X, reset=True), fresh=True)

    def partial_fit(self, X: ArrayLike, y: Any = None) -> Self:
        """Learn more patterns, in the order given, with the categories there are.

        Parameters, errors and result as for `fit`. A stream learned in pieces gives the same
        categories as the stream learned whole.
        """
        fresh = not self.__sklearn_is_fitted__()
        return self._learn(self._patterns(X, reset=fresh), fresh)

    def learn_one(self, x: ArrayLike) -> int:
        """Learn one pattern of shape (n_features,) and return its category, in microseconds.

        It does to the categories what `partial_fit` does with one row; `labels_` stays as it is.

        Raises
        ------
        ValueError
            For a parameter out of range, or an `x` of the wrong shape, not finite, or not of the
            kind the network takes.
        """
        if not self.__sklearn_is_fitted__():
            return int(self.partial_fit([np.asarray(x)]).labels_[0])
        label = np.empty(1, np.int64)
        self._present(self._pattern(x), label)
        return int(label[0])

    def predict(self, X: ArrayLike) -> Labels:
        """Return the category of each pattern; nothing is learned.

        Parameters
        ----------
        X : array-like of shape (n_samples, n_features)
            The patterns, finite.

        Returns
        -------
        ndarray of shape (n_samples,)
            Indices into `cluster_centers_`; -1 where the class says so.

        Raises
        ------
        sklearn.exceptions.NotFittedError
            If nothing has been learned yet.
        ValueError
            For an `X` of the wrong shape, not finite, or not of the kind the network takes.
        """
        check_is_fitted(self)
        return self._recall(self._patterns(X, reset=False))

    def category(self, x: ArrayLike) -> int:
        """Return the category of one pattern of shape (n_features,), in microseconds.

        It is the category that `predict` gives. Errors as for `predict`.
        """
        if not self.__sklearn_is_fitted__():  # check_is_fitted itself takes ten times as long
            check_is_fitted(self)
        return int(self._recall(self._pattern(x))[0])

    @property
    def cluster_centers_(self) -> Floats:
        """The centers, shape (n_clusters, n_features), in the order of their founding (a copy)."""
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

    def _begin(self, **rows: NDArray) -> None:
        """Take over the arrays of `_rows`, which may have no row yet."""
        self._given = self._wishes()
        self._settings = self._parameters()
        for name, values in rows.items():
            setattr(self, name, values)
        self._n = len(self._counts)
        self._arrange(max(64, self._n))
        self.labels_ = np.empty(0, np.int64)

    def _no_rows(self, n_features: int) -> dict[str, NDArray]:
        """Return the arrays of a network without a category."""
        none = {name: np.empty((0, n_features)) for name in self._rows}
        return none | {"_counts": np.empty(0, np.int64)}

    def _arrange(self, capacity: int) -> None:
        """Give the categories room for `capacity` of them, under the present settings."""
        for name in self._rows:
            old = getattr(self, name)
            new = np.empty((capacity, *old.shape[1:]), old.dtype)
            new[: self._n] = old[: self._n]
            setattr(self, name, new)

    def _learn(self, X: Floats, fresh: bool) -> Self:
        if fresh:
            self._begin(**self._no_rows(X.shape[1]))
        labels = np.empty(len(X), np.int64)
        self._present(X, labels)
        self.labels_ = labels
        return self

    def _heed(self) -> None:
        """Follow `set_params`, if it was called since the last pattern."""
        wishes = self._wishes()
        if wishes != self._given:
            self._settings = self._parameters()
            self._given = wishes
            self._arrange(len(self._counts))

    def _recall(self, X: Floats) -> Labels:
        """Return the category of each row of `X`, learning nothing."""
        self._heed()
        labels = np.empty(len(X), np.int64)
        self._recall_rows(X, labels)
        return labels

    def _present(self, X: Floats, labels: Labels) -> None:
        """Learn the rows of `X`, writing the category of each into `labels`."""
        self._heed()
        done = 0
        while True:
            done, self._n = self._learn_rows(X, done, labels)
            if done == len(X):
                return
            self._arrange(2 * self._n)

    def _patterns(self, X: ArrayLike, *, reset: bool) -> Floats:
        """Return `X` for the kernels: validated, and writeable, for they are compiled for that."""
        checked = check_array(X, dtype=np.float64, order="C", estimator=self, input_name="X")
        admitted = self._admit(checked)
        validate_data(self, X, reset=reset, skip_check_array=True)  # number and names of features
        return np.require(admitted, requirements=["C", "W"])

    def _pattern(self, x: ArrayLike) -> Floats:
        """Return `x` as one row for the kernels."""
        try:
            row = np.array(x, dtype=np.float64)
        except (TypeError, ValueError):
            row = np.empty(0)
        if row.shape != (self.n_features_in_,) or not all(map(math.isfinite, row.tolist())):
            row = array("x", x, (self.n_features_in_,))  # refuses it, and says why
        return self._admit(row[np.newaxis])

"""The segmentation that the thesis runs (section 4.2.2): Euclidean distance, online k-means."""

from __future__ import annotations

import math
import sys
from typing import Any, Self

import numpy as np
from numpy.typing import ArrayLike, NDArray
from sklearn.base import BaseEstimator, ClusterMixin
from sklearn.utils.validation import check_is_fitted, validate_data

from .._checks import array, integer, number
from .._compiled import kernel
from ._grid import ANY_DISTANCE, bucket_of, half_cells_per_unit, link, link_all, nearest, unlink


@kernel
def learn(X, start, labels, centers, counts, n, heads, nexts, scale, vigilance, rate, limit):
    """Present the patterns ``X[start:]`` in order; return where it stopped and how many centres.

    It stops early when a centre is to be founded and ``len(centers)`` leaves no room for it.
    A `rate` of 0 stands for one over the count.
    """
    for t in range(start, len(X)):
        x = X[t]
        j, d2 = nearest(x, centers, n, heads, nexts, scale, 1)
        if math.sqrt(d2) < vigilance:
            counts[j] += 1
            eta = rate if rate > 0 else 1.0 / counts[j]
            old = bucket_of(centers[j], scale, len(heads))
            for i in range(len(x)):
                centers[j, i] += eta * (x[i] - centers[j, i])
            new = bucket_of(centers[j], scale, len(heads))
            if new != old:
                unlink(j, old, heads, nexts)
                link(j, new, heads, nexts)
        elif n < limit:
            if n == len(centers):
                return t, n
            j = n
            n += 1
            centers[j] = x
            counts[j] = 1
            link(j, bucket_of(x, scale, len(heads)), heads, nexts)
        else:
            j, d2 = nearest(x, centers, n, heads, nexts, scale, ANY_DISTANCE)
        labels[t] = j
    return len(X), n


@kernel
def recall(X, labels, centers, n, heads, nexts, scale):
    """Write the index of the nearest centre of each pattern of `X` into `labels`."""
    for t in range(len(X)):
        labels[t] = nearest(X[t], centers, n, heads, nexts, scale, ANY_DISTANCE)[0]


class EuclideanART(ClusterMixin, BaseEstimator):
    """Categories by Euclidean distance: the nearest centre learns, or a new one is founded.

    For each pattern `x`, in the order of presentation, the nearest centre `m` is found. If its
    distance is strictly smaller than `vigilance`, it moves towards the pattern,
    ``m += eta * (x - m)``; otherwise a new centre is founded at `x`. Of centres equally near the
    one founded first is taken.

    The literature knows this as leader clustering with an online k-means update. It has neither
    the F1 loops of ART2 nor its normalisation; what it shares with the family is that recognising
    and learning are one act, gated by a vigilance. Here vigilance is a distance: the smaller, the
    more categories.

    Two choices decide whether counts of centres can be compared between programs at all. The
    comparison is strict: a pattern at a distance of exactly `vigilance` founds a centre. And the
    update factor is fixed at `learning_rate`, as in the thesis, so that a centre follows its
    latest patterns; the online k-means of the textbooks, whose centre is the mean of its
    patterns, is ``learning_rate="count"``.

    The work per pattern does not grow with the number of centres as long as these differ in their
    first three features and lie within 10**8 vigilances of the origin; the centres are those of a
    search through all of them, to the last bit.

    Parameters
    ----------
    vigilance : float in [1e-150, 1e150], default=0.1
        Distance below which a pattern belongs to a centre, in the units of the patterns.
    learning_rate : float in (0, 1] or "count", default=0.5
        Update factor eta. The thesis never gives it; its counts of centres speak for about 0.5.
        ``"count"``: one over the number of patterns the centre has learned, this one included.
    max_clusters : int >= 1 or None, default=None
        Greatest number of centres. Once there are so many, a pattern that would found another
        belongs to its nearest centre, however far; nothing is learned from it.

    Attributes
    ----------
    cluster_centers_ : ndarray of shape (n_clusters, n_features)
        The centres, in the order in which they were founded (a copy).
    counts_ : ndarray of shape (n_clusters,)
        How many patterns each centre has learned, the one that founded it included (a copy).
    n_clusters_ : int
        Number of centres.
    labels_ : ndarray of shape (n_samples,)
        The category of each pattern of the last `fit` or `partial_fit`, as it was decided when
        the pattern was presented. Centres move on, so `predict` on the same patterns may differ.
    n_features_in_ : int
        Number of features.
    feature_names_in_ : ndarray of shape (n_features_in_,)
        Names of the features, if the patterns came as a table with names.

    References
    ----------
    Thesis sections 2.4 and 4.2.2, equations 4.4-4.6, figure 4.2.
    J. A. Hartigan, Clustering Algorithms, Wiley 1975, chapter 3 (leader algorithm).
    J. MacQueen, Some methods for classification and analysis of multivariate observations,
    Proc. 5th Berkeley Symposium, 1967 (online k-means).

    Examples
    --------
    The second pattern is near enough to the first centre, the third is not:

    >>> art = EuclideanART(vigilance=0.5, learning_rate=0.5)
    >>> art.fit([[0.0, 0.0], [0.25, 0.0], [1.0, 1.0]]).cluster_centers_
    array([[0.125, 0.   ],
           [1.   , 1.   ]])
    >>> art.labels_, art.counts_
    (array([0, 0, 1]), array([2, 1]))
    >>> art.predict([[0.4, 0.4], [9.0, 9.0]])
    array([0, 1])

    A distance of exactly the vigilance founds a centre:

    >>> EuclideanART(vigilance=0.5).fit_predict([[0.0], [0.5]])
    array([0, 1])

    One pattern at a time, as an agent meets them:

    >>> art.learn_one([1.2, 1.0]), art.category([0.3, 0.3])
    (1, 0)
    """

    def __init__(
        self,
        vigilance: float = 0.1,
        learning_rate: float | str = 0.5,
        max_clusters: int | None = None,
    ) -> None:
        self.vigilance = vigilance
        self.learning_rate = learning_rate
        self.max_clusters = max_clusters

    @classmethod
    def from_centers(
        cls,
        centers: ArrayLike,
        counts: ArrayLike,
        vigilance: float,
        learning_rate: float | str = 0.5,
        max_clusters: int | None = None,
    ) -> Self:
        """Return a fitted estimator with given centres: the way back from a file.

        `cluster_centers_`, `counts_` and the parameters are all there is to save: what is learned
        from then on is, to the last bit, what the saved estimator would have learned. `labels_` is
        empty until the next `fit` or `partial_fit`.

        Parameters
        ----------
        centers : array-like of shape (n_clusters, n_features)
            The centres, at least one, in the order in which they were founded.
        counts : array-like of shape (n_clusters,)
            How many patterns each centre has learned, at least one.
        vigilance, learning_rate, max_clusters
            As for the class.

        Raises
        ------
        ValueError
            For an argument of the wrong shape, not finite or out of range.

        Examples
        --------
        >>> art = EuclideanART(0.2).fit([[0.0], [0.1], [1.0]])
        >>> twin = EuclideanART.from_centers(art.cluster_centers_, art.counts_, 0.2)
        >>> twin.learn_one([0.15]), twin.cluster_centers_
        (0, array([[0.1],
               [1. ]]))
        """
        self = cls(vigilance, learning_rate, max_clusters)
        places = array("centers", centers, (None, None))
        if 0 in places.shape:
            raise ValueError(f"centers must have a row and a column at least, got {places.shape}")
        taken = array("counts", counts, (len(places),))
        if (taken < 1).any() or (taken % 1 != 0).any():
            raise ValueError(f"counts must be integers >= 1, got {counts!r}")
        self._begin(places, taken.astype(np.int64))
        self.n_features_in_ = places.shape[1]
        return self

    def fit(self, X: ArrayLike, y: Any = None) -> Self:
        """Forget everything, then learn the patterns in the order given, once each.

        Parameters
        ----------
        X : array-like of shape (n_samples, n_features)
            The patterns, finite.
        y : ignored
            Present for scikit-learn's sake.

        Raises
        ------
        ValueError
            For a parameter out of range, or an `X` of the wrong shape or not finite.
        """
        self._parameters()
        patterns = self._patterns(X, reset=True)
        self._begin(patterns[:0], np.empty(0, np.int64))
        return self._learn(patterns)

    def partial_fit(self, X: ArrayLike, y: Any = None) -> Self:
        """Learn more patterns, in the order given, with the centres there are.

        Parameters, errors and result as for `fit`. A stream learned in pieces gives the same
        centres as the stream learned whole.
        """
        fresh = not self.__sklearn_is_fitted__()
        patterns = self._patterns(X, reset=fresh)
        if fresh:
            self._begin(patterns[:0], np.empty(0, np.int64))
        return self._learn(patterns)

    def learn_one(self, x: ArrayLike) -> int:
        """Learn one pattern of shape (n_features,) and return its category, in microseconds.

        It does to the centres what `partial_fit` does with one row; `labels_` stays as it is.

        Raises
        ------
        ValueError
            For a parameter out of range, or an `x` of the wrong shape or not finite.
        """
        if not self.__sklearn_is_fitted__():
            return int(self.partial_fit([np.asarray(x)]).labels_[0])
        label = np.empty(1, np.int64)
        self._present(self._pattern(x), label)
        return int(label[0])

    def predict(self, X: ArrayLike) -> NDArray[np.int64]:
        """Return the index of the nearest centre of each pattern; nothing is learned.

        Parameters
        ----------
        X : array-like of shape (n_samples, n_features)
            The patterns, finite.

        Returns
        -------
        ndarray of shape (n_samples,)
            Of centres equally near, the lowest index.

        Raises
        ------
        sklearn.exceptions.NotFittedError
            If there are no centres yet.
        ValueError
            For an `X` of the wrong shape or not finite.
        """
        check_is_fitted(self)
        return self._recall(self._patterns(X, reset=False))

    def category(self, x: ArrayLike) -> int:
        """Return the index of the nearest centre of one pattern of shape (n_features,), quickly.

        Raises
        ------
        sklearn.exceptions.NotFittedError
            If there are no centres yet.
        ValueError
            For an `x` of the wrong shape or not finite.
        """
        if not self.__sklearn_is_fitted__():  # check_is_fitted itself takes ten times as long
            check_is_fitted(self)
        return int(self._recall(self._pattern(x))[0])

    @property
    def cluster_centers_(self) -> NDArray[np.float64]:
        """The centres, shape (n_clusters, n_features), in the order of their founding (a copy)."""
        return self._centers[: self._n].copy()

    @property
    def counts_(self) -> NDArray[np.int64]:
        """How many patterns each centre has learned (a copy)."""
        return self._counts[: self._n].copy()

    @property
    def n_clusters_(self) -> int:
        """Number of centres."""
        return self._n

    def __sklearn_is_fitted__(self) -> bool:
        return getattr(self, "_n", 0) > 0

    def _parameters(self) -> tuple[float, float, int]:
        """Return vigilance, update factor (0: one over the count) and limit, validated."""
        # Beyond these limits the square of the vigilance would leave the range of a float.
        vigilance = number("vigilance", self.vigilance, 1e-150, 1e150)
        limit = sys.maxsize
        if self.max_clusters is not None:
            limit = integer("max_clusters", self.max_clusters, 1)
        if isinstance(self.learning_rate, str):
            if self.learning_rate != "count":
                allowed = "a number in (0, 1] or 'count'"
                raise ValueError(f"learning_rate must be {allowed}, got {self.learning_rate!r}")
            return vigilance, 0.0, limit
        return vigilance, number("learning_rate", self.learning_rate, 0, 1, open_low=True), limit

    def _begin(self, centers: NDArray[np.float64], counts: NDArray[np.int64]) -> None:
        """Take over `centers`, which may be none."""
        self._given = self.vigilance, self.learning_rate, self.max_clusters
        self._settings = self._parameters()
        self._centers, self._counts, self._n = centers, counts, len(centers)
        self._arrange(max(64, self._n))
        self.labels_ = np.empty(0, np.int64)

    def _arrange(self, capacity: int) -> None:
        """Move the centres to arrays with room for `capacity`, and build their table anew."""
        n, (_, n_features) = self._n, self._centers.shape
        centers, counts = np.empty((capacity, n_features)), np.empty(capacity, np.int64)
        centers[:n], counts[:n] = self._centers[:n], self._counts[:n]
        self._scale = half_cells_per_unit(self._settings[0])
        heads = np.empty(2 << capacity.bit_length(), np.int64)
        nexts = np.empty(capacity, np.int64)
        link_all(centers, n, heads, nexts, self._scale)
        self._centers, self._counts, self._heads, self._nexts = centers, counts, heads, nexts

    def _learn(self, X: NDArray[np.float64]) -> Self:
        labels = np.empty(len(X), np.int64)
        self._present(X, labels)
        self.labels_ = labels
        return self

    def _present(self, X: NDArray[np.float64], labels: NDArray[np.int64]) -> None:
        """Learn the rows of `X`, writing the category of each into `labels`."""
        given = self.vigilance, self.learning_rate, self.max_clusters
        if given != self._given:  # set_params since the last pattern
            self._settings = self._parameters()
            self._given = given
            self._arrange(len(self._centers))
        done = 0
        while True:
            done, self._n = learn(
                X, done, labels, self._centers, self._counts, self._n, self._heads, self._nexts,
                self._scale, *self._settings,
            )  # fmt: skip
            if done == len(X):
                return
            self._arrange(2 * self._n)

    def _recall(self, X: NDArray[np.float64]) -> NDArray[np.int64]:
        """Return the index of the nearest centre of each row of `X`."""
        labels = np.empty(len(X), np.int64)
        recall(X, labels, self._centers, self._n, self._heads, self._nexts, self._scale)
        return labels

    def _patterns(self, X: ArrayLike, *, reset: bool) -> NDArray[np.float64]:
        """Return `X` for the kernels: validated, and writeable, for they are compiled for that."""
        checked: Any = validate_data(self, X, dtype=np.float64, order="C", reset=reset)
        return np.require(checked, requirements=["C", "W"])

    def _pattern(self, x: ArrayLike) -> NDArray[np.float64]:
        """Return `x` as one row for the kernels."""
        try:
            row = np.array(x, dtype=np.float64)
        except (TypeError, ValueError):
            row = np.empty(0)
        if row.shape != (self.n_features_in_,) or not all(map(math.isfinite, row.tolist())):
            row = array("x", x, (self.n_features_in_,))  # refuses it, and says why
        return row[np.newaxis]

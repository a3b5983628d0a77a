"""The segmentation that the thesis runs (section 4.2.2): Euclidean distance, online k-means."""

from __future__ import annotations

import sys
from typing import NamedTuple, Self

import numpy as np
from numpy.typing import ArrayLike

from arkaq_edu._checks import LARGEST, array, integer, number, shown
from arkaq_edu._compiled import kernel
from arkaq_edu.art._estimator import Categories, Floats, Labels
from arkaq_edu.art.index import Index, add, build, nearest, nearest_of_all, remove

MOST_COUNTED = 2**53  # larger counts are not exact as floats


class Parameters(NamedTuple):
    """The parameters of the rule; an `eta` of 0 stands for one over the count."""

    vigilance: float
    eta: float
    max_clusters: int


@kernel
def learn(X, centers, counts, n, index, parameters):
    """Present the patterns in order; return their categories and the number of centers."""
    vigilance, eta, max_clusters = parameters
    labels = np.empty(len(X), np.int64)
    for t in range(len(X)):
        x = X[t]
        i, distance = nearest(x, centers, index)  # eq 4.4 and 4.5
        if distance < vigilance:
            counts[i] += 1
            step = eta if eta > 0.0 else 1.0 / counts[i]
            remove(i, centers, index)
            centers[i] += step * (x - centers[i])  # eq 4.6
            add(i, centers, index)
        elif n < max_clusters:
            i, n = n, n + 1
            centers[i] = x
            counts[i] = 1
            add(i, centers, index)
        else:
            i = nearest_of_all(x, centers, n)
        labels[t] = i
    return labels, n


@kernel
def recall(X, centers, n, index):
    """Return the nearest center of each pattern, however far."""
    labels = np.empty(len(X), np.int64)
    for t in range(len(X)):
        i, _ = nearest(X[t], centers, index)
        labels[t] = i if i >= 0 else nearest_of_all(X[t], centers, n)
    return labels


class EuclideanART(Categories):
    """Categories by Euclidean distance: the nearest center learns, or a new one is founded.

    For each pattern `x`, in the order of presentation, the nearest center `m` is found. If its
    distance is strictly smaller than `vigilance`, it moves toward the pattern,
    ``m += eta * (x - m)``. Otherwise a new center is founded at `x`. Of centers equally near, the
    one founded first is taken.

    The literature knows this as leader clustering with an online k-means update. It has neither
    the F1 loops of ART2 nor its normalization. What it shares with the family is that recognizing
    and learning are one act, gated by a vigilance. Vigilance is a distance here: the smaller, the
    more categories. `predict` and `category` return the nearest center, however far.

    Two choices decide whether counts of centers can be compared between programs at all. The
    comparison is strict: a pattern at a distance of exactly `vigilance` founds a center. And the
    update factor is fixed at `learning_rate`, as in the thesis, so that a center follows its
    latest patterns. In the online k-means of the textbooks a center is the mean of its patterns;
    that is ``learning_rate="count"``.

    The work per pattern does not grow with the number of centers, as long as these differ in their
    first two features (`arkaq_edu.art.index`). The result is that of a search through all centers,
    to the last bit.

    Parameters
    ----------
    vigilance : float in [1e-100, 1e100], default=0.1
        Distance below which a pattern belongs to a center, in the units of the patterns.
    learning_rate : float in (0, 1] or "count", default=0.5
        Update factor eta. The thesis never gives it; its counts of centers suggest about 0.5.
        ``"count"`` means one over the number of patterns the center has learned, this one included.
    max_clusters : int >= 1 or None, default=None
        Greatest number of centers. Once it is reached, a pattern that would found another center
        belongs to its nearest center, however far, and nothing is learned from it.

    Attributes
    ----------
    cluster_centers_ : ndarray of shape (n_clusters, n_features)
        The centers, in the order in which they were founded (a copy).
    counts_ : ndarray of shape (n_clusters,)
        How many patterns each center has learned, the one that founded it included (a copy).
    n_clusters_ : int
        Number of centers.
    labels_ : ndarray of shape (n_samples,)
        The category of each pattern of the last `fit` or `partial_fit`, decided when the pattern
        was presented. Centers move on, so `predict` on the same patterns may differ.
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
    The second pattern is near the first center, the third is not:

    >>> art = EuclideanART(vigilance=0.5, learning_rate=0.5)
    >>> art.fit([[0.0, 0.0], [0.25, 0.0], [1.0, 1.0]]).cluster_centers_
    array([[0.125, 0.   ],
           [1.   , 1.   ]])
    >>> art.labels_, art.counts_
    (array([0, 0, 1]), array([2, 1]))
    >>> art.predict([[0.4, 0.4], [9.0, 9.0]])
    array([0, 1])

    A distance of exactly the vigilance founds a center:

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
        """Return a fitted estimator with given centers, for example from a file.

        `cluster_centers_`, `counts_` and the parameters are the whole state. The new estimator
        learns exactly what the saved one would have learned. `labels_` is empty until the next
        `fit` or `partial_fit`.

        Parameters
        ----------
        centers : array-like of shape (n_clusters, n_features)
            The centers, at least one, in the order in which they were founded.
        counts : array-like of shape (n_clusters,)
            How many patterns each center has learned, at least one.
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
            raise ValueError(
                f"centers must have at least one row and one column, got {places.shape}"
            )
        taken = array("counts", counts, (len(places),))
        if not ((1 <= taken) & (taken <= MOST_COUNTED) & (taken % 1 == 0)).all():
            raise ValueError(f"counts must be integers in [1, 2**53], got {shown(counts)}")
        self.n_features_in_ = places.shape[1]
        self._valid()
        self._centers, self._counts, self._n = places, taken.astype(np.int64), len(places)
        self._resize(self._n)
        self.labels_ = np.empty(0, np.int64)
        return self

    def _parameters(self, n_features: int) -> Parameters:
        # Squares of distances stay in the range of a float between these limits.
        vigilance = number("vigilance", self.vigilance, 1 / LARGEST, LARGEST)
        limit = sys.maxsize
        if self.max_clusters is not None:
            limit = integer("max_clusters", self.max_clusters, 1)
        if not isinstance(self.learning_rate, str):
            eta = number("learning_rate", self.learning_rate, 0, 1, open_low=True)
            return Parameters(vigilance, eta, limit)
        if self.learning_rate != "count":
            allowed = "a number in (0, 1] or 'count'"
            raise ValueError(f"learning_rate must be {allowed}, got {shown(self.learning_rate)}")
        return Parameters(vigilance, 0.0, limit)

    def _resize(self, capacity: int) -> None:
        super()._resize(capacity)
        self._index = build(self._centers, self._n, self._valid().vigilance)

    def _indexed(self, vigilance: float) -> Index:
        """Return the index of the centers, built anew if the vigilance has changed."""
        if self._index.vigilance != vigilance:
            self._index = build(self._centers, self._n, vigilance)
        return self._index

    def _learn_rows(self, X: Floats, parameters: Parameters) -> tuple[Labels, int]:
        index = self._indexed(parameters.vigilance)
        return learn(X, self._centers, self._counts, self._n, index, parameters)

    def _recall_rows(self, X: Floats, parameters: Parameters) -> Labels:
        return recall(X, self._centers, self._n, self._indexed(parameters.vigilance))

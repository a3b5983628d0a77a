"""The segmentation that the thesis runs (section 4.2.2): Euclidean distance, online k-means."""

from __future__ import annotations

import sys
from typing import Self

import numpy as np
from numpy.typing import ArrayLike

from arkaq_edu._checks import array, integer, number
from arkaq_edu.art._estimator import Categories, Floats, Labels
from arkaq_edu.art.index import half_cells_per_unit, learn, link_all, recall


class EuclideanART(Categories):
    """Categories by Euclidean distance: the nearest center learns, or a new one is founded.

    For each pattern `x`, in the order of presentation, the nearest center `m` is found. If its
    distance is strictly smaller than `vigilance`, it moves toward the pattern,
    ``m += eta * (x - m)``; otherwise a new center is founded at `x`. Of centers equally near the
    one founded first is taken.

    The literature knows this as leader clustering with an online k-means update. It has neither
    the F1 loops of ART2 nor its normalization; what it shares with the family is that recognizing
    and learning are one act, gated by a vigilance. Here vigilance is a distance: the smaller, the
    more categories. `predict` and `category` give the nearest center, however far.

    Two choices decide whether counts of centers can be compared between programs at all. The
    comparison is strict: a pattern at a distance of exactly `vigilance` founds a center. And the
    update factor is fixed at `learning_rate`, as in the thesis, so that a center follows its
    latest patterns; the online k-means of the textbooks, whose center is the mean of its
    patterns, is ``learning_rate="count"``.

    The work per pattern does not grow with the number of centers as long as these differ in their
    first three features and lie within 10**8 vigilances of the origin; the centers are those of a
    search through all of them, to the last bit.

    Parameters
    ----------
    vigilance : float in [1e-150, 1e150], default=0.1
        Distance below which a pattern belongs to a center, in the units of the patterns.
    learning_rate : float in (0, 1] or "count", default=0.5
        Update factor eta. The thesis never gives it; its counts of centers speak for about 0.5.
        ``"count"``: one over the number of patterns the center has learned, this one included.
    max_clusters : int >= 1 or None, default=None
        Greatest number of centers. Once there are so many, a pattern that would found another
        belongs to its nearest center, however far; nothing is learned from it.

    Attributes
    ----------
    cluster_centers_ : ndarray of shape (n_clusters, n_features)
        The centers, in the order in which they were founded (a copy).
    counts_ : ndarray of shape (n_clusters,)
        How many patterns each center has learned, the one that founded it included (a copy).
    n_clusters_ : int
        Number of centers.
    labels_ : ndarray of shape (n_samples,)
        The category of each pattern of the last `fit` or `partial_fit`, as it was decided when
        the pattern was presented. Centers move on, so `predict` on the same patterns may differ.
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
    The second pattern is near enough to the first center, the third is not:

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
        """Return a fitted estimator with given centers: the way back from a file.

        `cluster_centers_`, `counts_` and the parameters are all there is to save: what is learned
        from then on is, to the last bit, what the saved estimator would have learned. `labels_` is
        empty until the next `fit` or `partial_fit`.

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
            raise ValueError(f"centers must have a row and a column at least, got {places.shape}")
        taken = array("counts", counts, (len(places),))
        if (taken < 1).any() or (taken % 1 != 0).any():
            raise ValueError(f"counts must be integers >= 1, got {counts!r}")
        self._begin(_centers=places, _counts=taken.astype(np.int64))
        self.n_features_in_ = places.shape[1]
        return self

    def _wishes(self) -> tuple:
        return self.vigilance, self.learning_rate, self.max_clusters

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

    def _arrange(self, capacity: int) -> None:
        """Give the centers room for `capacity` of them, and build their table anew."""
        super()._arrange(capacity)
        self._scale = half_cells_per_unit(self._settings[0])
        self._heads = np.empty(2 << capacity.bit_length(), np.int64)
        self._nexts = np.empty(capacity, np.int64)
        link_all(self._centers, self._n, self._heads, self._nexts, self._scale)

    def _learn_rows(self, X: Floats, done: int, labels: Labels) -> tuple[int, int]:
        return learn(
            X, done, labels, self._centers, self._counts, self._n, self._heads, self._nexts,
            self._scale, *self._settings,
        )  # fmt: skip

    def _recall_rows(self, X: Floats, labels: Labels) -> None:
        recall(X, labels, self._centers, self._n, self._heads, self._nexts, self._scale)

"""ART 2-A: categories by angle (section 4.2.1), the network the original ARKAQ used."""

from __future__ import annotations

import math

import numpy as np

from arkaq_edu._checks import number
from arkaq_edu._compiled import kernel
from arkaq_edu.art._estimator import Categories, Floats, Labels


@kernel
def normalize(x, unit):
    """Write `x` scaled to norm 1 into `unit`; return false if it has no direction."""
    peak = 0.0
    for i in range(len(x)):
        peak = max(peak, abs(x[i]))
    if peak == 0.0:
        return False
    total = 0.0
    for i in range(len(x)):
        unit[i] = x[i] / peak  # first by the peak, so that no square leaves the range of a float
        total += unit[i] * unit[i]
    norm = math.sqrt(total)
    for i in range(len(x)):
        unit[i] /= norm
    return True


@kernel
def enter(x, theta, pattern):
    """Write unit vector `x`, freed of components below `theta`, into `pattern`: the F0 stage."""
    if not normalize(x, pattern):
        return False
    for i in range(len(x)):
        if abs(pattern[i]) < theta:
            pattern[i] = 0.0
    return normalize(pattern, pattern)


@kernel
def most_aligned(pattern, templates, n):
    """Return the template of largest cosine (of equals the first), and the cosine."""
    best, best_cosine = -1, -np.inf
    for j in range(n):
        cosine = 0.0
        for i in range(len(pattern)):
            cosine += pattern[i] * templates[j, i]
        if cosine > best_cosine:
            best, best_cosine = j, cosine
    return best, best_cosine


@kernel
def learn(X, start, labels, templates, counts, n, vigilance, rate, theta):
    """Present the patterns ``X[start:]`` in order; return where it stopped and how many templates.

    It stops early when a category is to be founded and ``len(templates)`` leaves no room for it.
    """
    pattern, update = np.empty(X.shape[1]), np.empty(X.shape[1])
    for t in range(start, len(X)):
        labels[t] = -1
        if not enter(X[t], theta, pattern):
            continue
        j, cosine = most_aligned(pattern, templates, n)
        if cosine > vigilance:
            counts[j] += 1
            for i in range(len(pattern)):
                # What a template has lost to noise it does not take up again.
                update[i] = 0.0 if abs(templates[j, i]) < theta else pattern[i]
            if normalize(update, update):
                for i in range(len(pattern)):
                    update[i] = rate * update[i] + (1.0 - rate) * templates[j, i]
                normalize(update, templates[j])
        else:
            if n == len(templates):
                return t, n
            j = n
            n += 1
            templates[j] = pattern
            counts[j] = 1
        labels[t] = j
    return len(X), n


@kernel
def recall(X, labels, templates, n, theta):
    """Write the index of the most aligned template of each pattern of `X` into `labels`."""
    pattern = np.empty(X.shape[1])
    for t in range(len(X)):
        labels[t] = -1
        if enter(X[t], theta, pattern):
            labels[t] = most_aligned(pattern, templates, n)[0]


class ART2A(Categories):
    """Categories by angle: the most aligned template turns to the pattern, or one is founded.

    A pattern is scaled to unit norm, so that its dot product with a template, which has unit norm
    too, is the cosine of the angle between them. If the cosine of the most aligned template is
    strictly larger than `vigilance`, the template turns toward the pattern,
    ``z = unit(beta * x + (1 - beta) * z)``; otherwise a new template is founded at the pattern.
    (Where the two cancel, which takes a negative vigilance, the template stays.)
    Here vigilance is a similarity: the larger, the more categories.

    The thesis scales each feature to [-1, 1] and takes the norm to be 1 by that; it runs from 0 to
    1.41, and the largest raw dot product then is seldom the largest cosine. Right is: first center
    the features (the scaling to [-1, 1] does so), then scale each pattern to unit norm. It follows
    that an angle says nothing of the distance from the center, and that with a single feature only
    the patterns +1 and -1 remain. A pattern of zeros has no angle: it belongs to category -1.

    `predict` and `category` give the most aligned template, however far (section 5.2.1).

    The network is ART 2-A in the conservative limit (an uncommitted node is chosen only where no
    template matches), with two liberties: features may be negative, the noise threshold then
    holding for their magnitude; and the comparison is strict, as the thesis has it.

    Parameters
    ----------
    vigilance : float in [-1, 1), default=0.95
        Cosine above which a pattern belongs to a template. The default is that of figure 5.9.
    learning_rate : float in (0, 1], default=0.5
        Update factor beta; 1 puts a template on its latest pattern. The thesis never gives it;
        the default is that of `EuclideanART`.
    theta : float in [0, 1), default=0
        Noise threshold: components of the unit pattern that are smaller are set to 0, and the rest
        scaled to unit norm again. A pattern of which nothing remains belongs to category -1.

    Attributes
    ----------
    cluster_centers_ : ndarray of shape (n_clusters, n_features)
        The templates, of unit norm, in the order in which they were founded (a copy).
    counts_ : ndarray of shape (n_clusters,)
        How many patterns each template has learned, the one that founded it included (a copy).
    n_clusters_ : int
        Number of templates.
    labels_ : ndarray of shape (n_samples,)
        The category of each pattern of the last `fit` or `partial_fit`, as it was decided when
        the pattern was presented. Templates turn on, so `predict` may differ.
    n_features_in_ : int
        Number of features.
    feature_names_in_ : ndarray of shape (n_features_in_,)
        Names of the features, if the patterns came as a table with names.

    References
    ----------
    Thesis section 4.2.1, equations 4.1-4.3, figures 4.1 and 5.9.
    G. A. Carpenter, S. Grossberg, D. B. Rosen, ART 2-A: an adaptive resonance algorithm for rapid
    category learning and recognition, Neural Networks 4 (1991) 493-504.

    Examples
    --------
    >>> art = ART2A(vigilance=0.9, learning_rate=0.5)
    >>> art.fit_predict([[1.0, 0.0], [0.0, 5.0], [3.0, 0.0], [0.1, 0.1], [0.0, 0.0]])
    array([ 0,  1,  0,  2, -1])
    >>> art.cluster_centers_.round(3)
    array([[1.   , 0.   ],
           [0.   , 1.   ],
           [0.707, 0.707]])

    Distance does not matter, only direction:

    >>> art.predict([[0.01, 0.002], [1000.0, 200.0]])
    array([0, 0])
    """

    def __init__(
        self, vigilance: float = 0.95, learning_rate: float = 0.5, theta: float = 0.0
    ) -> None:
        self.vigilance = vigilance
        self.learning_rate = learning_rate
        self.theta = theta

    def _wishes(self) -> tuple:
        return self.vigilance, self.learning_rate, self.theta

    def _parameters(self) -> tuple[float, float, float]:
        return (
            number("vigilance", self.vigilance, -1, 1, open_high=True),
            number("learning_rate", self.learning_rate, 0, 1, open_low=True),
            number("theta", self.theta, 0, 1, open_high=True),
        )

    def _learn_rows(self, X: Floats, done: int, labels: Labels) -> tuple[int, int]:
        return learn(X, done, labels, self._centers, self._counts, self._n, *self._settings)

    def _recall_rows(self, X: Floats, labels: Labels) -> None:
        recall(X, labels, self._centers, self._n, self._settings[2])

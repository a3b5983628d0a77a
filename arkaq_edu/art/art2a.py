"""ART 2-A: categories by angle (section 4.2.1), the network that the original ARKAQ used."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from arkaq_edu._checks import number
from arkaq_edu._compiled import kernel
from arkaq_edu.art._estimator import Categories, Floats, Labels
from arkaq_edu.art.vectors import dot, unit


class Parameters(NamedTuple):
    """The parameters of the network; beta is the learning rate."""

    vigilance: float
    beta: float
    theta: float


@kernel
def enter(x, theta):
    """Return `x` with norm 1 and without noise (the stage F0), or zeros if nothing remains."""
    x = unit(x)
    return unit(np.where(np.abs(x) < theta, 0.0, x))


@kernel
def choose(pattern, templates, n):
    """Return the template of largest cosine (of equals the first), and the cosine."""
    J, largest = -1, -np.inf
    for j in range(n):
        cosine = dot(pattern, templates[j])  # eq 4.1 to 4.3: both have norm 1
        if cosine > largest:
            J, largest = j, cosine
    return J, largest


@kernel
def learn(X, templates, counts, n, parameters):
    """Present the patterns in order; return their categories and the number of templates."""
    vigilance, beta, theta = parameters
    labels = np.full(len(X), -1)
    for t in range(len(X)):
        x = enter(X[t], theta)
        if not x.any():
            continue
        J, cosine = choose(x, templates, n)
        if cosine > vigilance:
            z = templates[J]
            seen = unit(np.where(np.abs(z) < theta, 0.0, x))  # noise stays forgotten
            turned = beta * seen + (1.0 - beta) * z
            if turned.any():
                templates[J] = unit(turned)
            counts[J] += 1
        else:
            J, n = n, n + 1
            templates[J] = x
            counts[J] = 1
        labels[t] = J
    return labels, n


@kernel
def recall(X, templates, n, parameters):
    """Return the most aligned template of each pattern."""
    labels = np.full(len(X), -1)
    for t in range(len(X)):
        x = enter(X[t], parameters.theta)
        if x.any():
            labels[t], _ = choose(x, templates, n)
    return labels


class ART2A(Categories):
    """Categories by angle: the most aligned template turns to the pattern, or a new one is founded.

    A pattern is scaled to norm 1. Templates have norm 1 too, so their dot product is the cosine of
    the angle between them. If the cosine of the most aligned template is strictly larger than
    `vigilance`, the template turns toward the pattern, ``z = unit(beta * x + (1 - beta) * z)``.
    Otherwise a new template is founded at the pattern. (With a negative vigilance the two can
    cancel; then the template stays.) Vigilance is a similarity here: the larger, the more
    categories.

    The thesis scales each feature to [-1, 1] and takes the norm of the pattern to be 1. In fact it
    runs from 0 to 1.41, and the largest raw dot product is seldom the largest cosine. Instead,
    center the features first (scaling to [-1, 1] does so), then scale each pattern to norm 1. It
    follows that an angle says nothing about the distance from the center, and that with a single
    feature only the patterns +1 and -1 remain. A pattern of zeros has no angle: it belongs to
    category -1.

    `predict` and `category` return the most aligned template, however far (section 5.2.1).

    The network is ART 2-A in the conservative limit (an uncommitted node is chosen only if no
    template matches), with two differences. Features may be negative; the noise threshold then
    applies to their magnitude. And the comparison is strict, as in the thesis.

    Parameters
    ----------
    vigilance : float in [-1, 1), default=0.95
        Cosine above which a pattern belongs to a template. The default is that of figure 5.9.
    learning_rate : float in (0, 1], default=0.5
        Update factor beta; 1 puts a template on its latest pattern. The thesis never gives it;
        the default is that of `EuclideanART`.
    theta : float in [0, 1), default=0
        Noise threshold. Smaller components of the unit pattern are set to 0, and the rest is scaled
        to norm 1 again. A pattern of which nothing remains belongs to category -1.

    Attributes
    ----------
    cluster_centers_ : ndarray of shape (n_clusters, n_features)
        The templates, of norm 1, in the order in which they were founded (a copy).
    counts_ : ndarray of shape (n_clusters,)
        How many patterns each template has learned, the one that founded it included (a copy).
    n_clusters_ : int
        Number of templates.
    labels_ : ndarray of shape (n_samples,)
        The category of each pattern of the last `fit` or `partial_fit`, decided when the pattern
        was presented. Templates keep turning, so `predict` may differ.
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

    def _parameters(self, n_features: int) -> Parameters:
        return Parameters(
            number("vigilance", self.vigilance, -1, 1, open_high=True),
            number("learning_rate", self.learning_rate, 0, 1, open_low=True),
            number("theta", self.theta, 0, 1, open_high=True),
        )

    def _learn_rows(self, X: Floats, parameters: Parameters) -> tuple[Labels, int]:
        return learn(X, self._centers, self._counts, self._n, parameters)

    def _recall_rows(self, X: Floats, parameters: Parameters) -> Labels:
        return recall(X, self._centers, self._n, parameters)

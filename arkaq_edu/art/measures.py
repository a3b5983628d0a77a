"""How good a partition is: what it covers, and how precisely it says where a pattern lies."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from arkaq_edu._checks import array, shown
from arkaq_edu.art.art2a import ART2A
from arkaq_edu.art.euclidean import EuclideanART


def coverage(network: ART2A | EuclideanART, patterns: ArrayLike) -> float:
    """Return the share of patterns that a fitted network recognizes.

    A pattern is recognized if it would found no new category. A network may no longer recognize a
    pattern that it has learned, because centers move on.

    Parameters
    ----------
    network : ART2A or EuclideanART
        Fitted. It learns nothing here.
    patterns : array_like, shape (n, m)
        Any patterns, learned or not, n >= 1.

    Returns
    -------
    float in [0, 1]

    Raises
    ------
    ValueError
        For another network, or patterns that `predict` refuses.

    Notes
    -----
    The tests of the thesis's sections 4.2.1 and 4.2.2: cosine > vigilance; distance < vigilance.

    Examples
    --------
    >>> network = EuclideanART(0.5).fit([[0.0, 0.0], [1.0, 0.0]])
    >>> coverage(network, [[0.1, 0.0], [0.5, 0.5], [1.0, 0.2], [1.0, 0.0]])
    0.75
    """
    if not isinstance(network, (ART2A, EuclideanART)):
        raise ValueError(f"network must be an ART2A or EuclideanART, got {shown(network)}")
    patterns = array("patterns", patterns, (None, None))
    own = network.cluster_centers_[network.predict(patterns)]
    if isinstance(network, ART2A):
        norms = np.linalg.norm(patterns, axis=1)
        recognized = (own * patterns).sum(axis=1) > network.vigilance * norms
    else:
        recognized = np.linalg.norm(patterns - own, axis=1) < network.vigilance
    return float(recognized.mean())


def quantization_error(places: ArrayLike, labels: ArrayLike) -> float:
    """Return the root-mean-square distance of places from the mean place of their category.

    This is the error of the best guess of a place from its category alone.

    Parameters
    ----------
    places : array_like, shape (n, m)
        In any unit, n >= 1.
    labels : array_like, shape (n,)
        The category of each place.

    Returns
    -------
    float
        In the unit of `places`.

    Raises
    ------
    ValueError
        For arguments of the wrong shape, not finite, or empty.

    Examples
    --------
    >>> quantization_error([[100.0], [300.0], [1000.0], [1200.0]], [0, 0, 1, 1])
    100.0
    """
    places = array("places", places, (None, None))
    labels = array("labels", labels, (len(places),))
    if places.size == 0:
        raise ValueError(f"places must hold at least one number, got shape {places.shape}")
    _, category, sizes = np.unique(labels, return_inverse=True, return_counts=True)
    sums = [np.bincount(category, weights=column) for column in places.T]
    means = np.column_stack(sums) / sizes[:, None]
    return float(np.sqrt(((places - means[category]) ** 2).sum(axis=1).mean()))

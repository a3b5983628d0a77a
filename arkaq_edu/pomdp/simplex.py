"""The simplex of beliefs over three states, drawn as a triangle."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike, NDArray

from arkaq_edu._checks import distribution, n_axes

#: Where the beliefs lie that are certain of one of three states: left, top, right.
CORNERS = np.array([[0.0, 0.0], [0.5, math.sqrt(3) / 2], [1.0, 0.0]])

#: The corners of a tetrahedron, the simplex of four states, as seen from outside.
TETRAHEDRON = np.array([[0.0, 0.12], [0.42, 0.95], [1.0, 0.4], [0.6, -0.05]])


def to_triangle(b: ArrayLike) -> NDArray[np.float64]:
    """Return where beliefs over three states lie in a triangle with sides of 1.

    Parameters
    ----------
    b : array_like, shape (3,) or (N, 3)
        A belief, or many.

    Returns
    -------
    ndarray, shape (2,) or (N, 2)
        The first state is the left corner (0, 0), the second the top, the third the right corner
        (1, 0). The more likely a state, the nearer is its corner.

    Raises
    ------
    ValueError
        If `b` has another shape or is not a distribution.

    Examples
    --------
    >>> to_triangle([[1, 0, 0], [0, 0.5, 0.5]]).round(3)
    array([[0.   , 0.   ],
           [0.75 , 0.433]])
    """
    return distribution("b", b, (None, 3) if n_axes("b", b) == 2 else (3,)) @ CORNERS

"""Motion models for the filter."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from arkaq_edu._checks import affordable, integer, number


def constant_velocity(dt: float, n_axes: int) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return A and H of an object that moves at constant velocity and whose position is measured.

    The state holds all positions first, then all velocities: for two axes x, y, vx, vy. The ball
    of the thesis (section 5.2) has the axes distance and orientation.

    Parameters
    ----------
    dt : float
        Seconds from one step to the next, above 0. Velocities are per second; with ``dt=1`` they
        are per step.
    n_axes : int
        Number of positions, at least 1.

    Returns
    -------
    A : ndarray, shape (2 n_axes, 2 n_axes)
        State transition model: position += dt velocity.
    H : ndarray, shape (n_axes, 2 n_axes)
        Observation model: the positions. It is not square, so K cannot go to H^-1 as R goes to
        0, as the thesis prints after eq 2.54; instead H K goes to I.

    Raises
    ------
    ValueError
        If `dt` is not above 0, or `n_axes` is below 1 or too large for memory.

    References
    ----------
    Thesis section 2.5, eq 2.49 and 2.50.

    Examples
    --------
    >>> A, H = constant_velocity(0.5, 2)
    >>> A
    array([[1. , 0. , 0.5, 0. ],
           [0. , 1. , 0. , 0.5],
           [0. , 0. , 1. , 0. ],
           [0. , 0. , 0. , 1. ]])
    >>> H
    array([[1., 0., 0., 0.],
           [0., 1., 0., 0.]])
    """
    dt = number("dt", dt, 0, open_low=True, open_high=True)
    n = integer("n_axes", n_axes, 1)
    affordable("n_axes", (2 * n, 2 * n))
    A = np.eye(2 * n) + dt * np.eye(2 * n, k=n)
    return A, np.eye(n, 2 * n)

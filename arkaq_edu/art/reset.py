"""When the orienting subsystem of ART2 resets a node, in closed form (equations 2.45 to 2.47)."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from arkaq_edu._checks import array, number

ROUNDING = 1e-9  # a computed cosine may exceed 1 by less than this

#: Cosines between `u` and the expectation for which figure 2.21 draws a curve.
COSINES = (1.0, 0.8, 0.6, 0.4, 0.2, 0.0)


def match_norm(cosine: ArrayLike, cdz: ArrayLike, c: float) -> NDArray[np.float64]:
    """Return the norm of r, which ART2 compares with the vigilance: the surface of figure 2.21.

    Parameters
    ----------
    cosine : array_like
        Cosine of the angle between `u` and the expectation `z_J`, in [-1, 1].
    cdz : array_like
        Norm of ``c d z_J``, not negative: 0 for an uncommitted node, `learned_norm` at the end of
        learning.
    c : float in (0, 1)
        As in `ART2`.

    Returns
    -------
    array of the common shape of `cosine` and `cdz`

    Raises
    ------
    ValueError
        For an argument out of range, or shapes that do not fit together.

    References
    ----------
    Thesis equations 2.45 to 2.47. The thesis prints 2.46 without the norm: the product
    ``norm(p) cos(u, p)`` is ``1 + norm(d z_J) cos(u, z_J)``.

    Examples
    --------
    >>> match_norm([1.0, 0.5, 0.0], 0.9, c=0.1).round(3)
    array([1.   , 0.888, 0.746])
    """
    cosine, cdz, c = array("cosine", cosine, None), _norm(cdz), _inside("c", c)
    if (np.abs(cosine) > 1 + ROUNDING).any():
        raise ValueError(f"cosine must be in [-1, 1], got {np.abs(cosine).max():g} in magnitude")
    try:
        np.broadcast_shapes(cosine.shape, cdz.shape)
    except ValueError:
        raise ValueError(
            f"cdz must have a shape that fits cosine's {cosine.shape}, got {cdz.shape}"
        ) from None
    cosine = np.clip(cosine, -1, 1)
    above = np.sqrt((1 + c) ** 2 + 2 * (1 + c) * cdz * cosine + cdz**2)
    return above / (1 + np.sqrt(c**2 + 2 * c * cdz * cosine + cdz**2))


def reset_cosine(vigilance: float, cdz: ArrayLike, c: float) -> NDArray[np.float64]:
    """Return the cosine below which a node is reset, or 0 if no cosine of [0, 1] is.

    Parameters
    ----------
    vigilance : float in (0, 1)
        The norm of r that a match must reach.
    cdz : array_like
        Norm of ``c d z_J``, not negative.
    c : float in (0, 1)
        As in `ART2`.

    Returns
    -------
    array of the shape of `cdz`
        Cosines of the angle between `u` and `z_J`, from 0 to 1.

    Raises
    ------
    ValueError
        For an argument out of range.

    Notes
    -----
    With ``s = norm(c p)``, equation 2.47 is quadratic in s:
    ``((1 + c) / c - r**2) s**2 - 2 r**2 s + 1 + c - r**2 - cdz**2 / c = 0``.

    Examples
    --------
    >>> cosine = reset_cosine(0.95, 0.9, c=0.1)
    >>> cosine.round(3), match_norm(cosine, 0.9, c=0.1).round(3)
    (np.float64(0.764), np.float64(0.95))
    """
    r2, c, cdz = _inside("vigilance", vigilance) ** 2, _inside("c", c), _norm(cdz)
    square, rest = (1 + c) / c - r2, 1 + c - r2 - cdz**2 / c
    inner = r2**2 - square * rest
    s = (r2 + np.sqrt(np.maximum(inner, 0))) / square
    with np.errstate(divide="ignore", invalid="ignore"):
        cosine = (s**2 - c**2 - cdz**2) / (2 * c * cdz)
    return np.where((inner >= 0) & (cdz > 0), np.clip(cosine, 0, 1), 0.0)


def learned_norm(c: float, d: float) -> float:
    """Return the norm of ``c d z_J`` at the end of learning, where ``norm(z_J) = 1 / (1 - d)``.

    Both parameters are in (0, 1), as in `ART2`; others raise ``ValueError``.

    Examples
    --------
    >>> round(learned_norm(0.1, 0.9), 3)
    0.9
    """
    c, d = _inside("c", c), _inside("d", d)
    return c * d / (1 - d)


def reset_fact(c: float, d: float, vigilance: float) -> str:
    """Say which cosines reset a node that has learned all it can.

    All three parameters are in (0, 1), as in `ART2`; others raise ``ValueError``.

    Examples
    --------
    >>> reset_fact(0.1, 0.9, 0.95)
    'once learned, vigilance 0.95 resets a cosine below 0.76 (c = 0.1, d = 0.9)'
    >>> reset_fact(0.1, 0.9, 0.7)
    'once learned, vigilance 0.7 never resets (c = 0.1, d = 0.9)'
    >>> reset_fact(0.3, 0.9, 0.95)
    'c d / (1 - d) is 2.7 and must not exceed 1 (c = 0.3, d = 0.9)'
    """
    c, d, vigilance = _inside("c", c), _inside("d", d), _inside("vigilance", vigilance)
    end, given = learned_norm(c, d), f"(c = {c:g}, d = {d:g})"
    if end > 1 + 1e-12:
        return f"c d / (1 - d) is {end:.3g} and must not exceed 1 {given}"
    cosine = float(reset_cosine(vigilance, end, c))
    resets = f"resets a cosine below {cosine:.2f}" if cosine > 0 else "never resets"
    return f"once learned, vigilance {vigilance:g} {resets} {given}"


def _inside(name: str, value: float) -> float:
    """Return a parameter in (0, 1)."""
    return number(name, value, 0, 1, open_low=True, open_high=True)


def _norm(cdz: ArrayLike) -> NDArray[np.float64]:
    """Return norms, which are not negative."""
    norms = array("cdz", cdz, None)
    if (norms < 0).any():
        raise ValueError(f"cdz must be norms >= 0, got {norms.min():g}")
    return norms

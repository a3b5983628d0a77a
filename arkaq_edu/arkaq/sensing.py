"""From a sighting to a pattern: the Kalman filter's settings, and how its estimate is scaled."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from arkaq_edu import _checks
from arkaq_edu._compiled import kernel
from arkaq_edu.kalman import KalmanFilter, constant_velocity

_FARTHEST = 1e20  # mm


@dataclass(frozen=True, eq=False)
class Sensing:
    """What the agent assumes about its senses.

    Parameters
    ----------
    low, high : sequence of float, length m
        The interval of each measurement. It is clipped to it and scaled to [-1, 1].
    A, H, Q, R, P0 : array_like
        The Kalman filter, with n >= m states and m measurements. The first m states are what is
        measured. Covariances are in squared units of the state (Q, P0) and of the measurements
        (R). All arrays are copied and read-only.
    B : array_like, shape (n, n_actions), optional
        What each action does to the state, one column per action. The filter's control input is
        then the action taken. Without `B` the filter does not know the actions.
    range_noise : float
        The variance of the first measurement is larger by ``(range_noise * z[0]**2)**2``
        (`range_noise` in 1/mm, in [0, 1]): the error of a distance that is read from the size of
        a blob.

    Raises
    ------
    ValueError
        If a parameter has the wrong shape or is out of range.

    Notes
    -----
    The noise of a sighting is `R` and `range_noise`, and no other: there are no subclasses.
    `thesis` returns the numbers of section 5.2. `consistent` (for the ball) and `goal` return
    numbers measured on the field. With these, the filter's innovations are as large as it expects.
    """

    low: tuple[float, ...]
    high: tuple[float, ...]
    A: Any
    H: Any
    Q: Any
    R: Any
    P0: Any
    B: Any = None
    range_noise: float = 0.0

    def __post_init__(self) -> None:
        low = _checks.array("low", self.low, (None,))
        high = _checks.array("high", self.high, low.shape)
        if not len(low) or not (low < high).all():
            given = f"{_checks.shown(self.low)} and {_checks.shown(self.high)}"
            raise ValueError(f"high must be above low, got {given}")
        n = len(_checks.array("A", self.A, (None, None)))
        if n < len(low):
            raise ValueError(f"A must have a state for each of {len(low)} measurements, got {n}")
        _checks.array("H", self.H, (len(low), n))
        kalman = self.filter()  # it refuses what is not a filter
        keep = partial(object.__setattr__, self)
        keep("low", tuple(low.tolist()))
        keep("high", tuple(high.tolist()))
        for name in ("A", "H", "Q", "R", "P0"):
            keep(name, getattr(kalman, name))
        keep("B", None if self.B is None else kalman.B)
        keep("range_noise", _checks.number("range_noise", self.range_noise, 0, 1))

    def __init_subclass__(cls) -> None:
        raise TypeError("Sensing has no subclasses: its noise is R and range_noise, and no other")

    def __eq__(self, other: object) -> bool:
        """Compare by value: arrays and lists of the same numbers are equal."""
        return isinstance(other, Sensing) and self.to_json() == other.to_json()

    def __hash__(self) -> int:
        """Hash by value."""
        return hash(str(self.to_json()))

    @classmethod
    def thesis(cls) -> Sensing:
        """Return the settings of section 5.2: constant velocity, no control input.

        The thesis gives the diagonals of `R` and `Q`, but no `P0`, `B` or time step. Here the
        step is one cycle, and `P0` knows nothing: the ball may be anywhere in the interval, and
        move by up to a footstep per cycle.
        """
        A, H = constant_velocity(1.0, 2)
        return cls(
            (200.0, -0.5),
            (4100.0, 0.5),
            A,
            H,
            Q=np.diag([0.001, 0.0001, 0.0001, 0.000001]),
            R=np.diag([100.0, 0.05]),
            P0=np.diag([1950.0**2, 0.5**2, 100.0**2, 0.1**2]),
        )

    @classmethod
    def consistent(cls) -> Sensing:
        """Return settings measured on the field: the robot knows its own footsteps.

        The ball stands still and the robot walks, so there is no velocity to estimate. `B` is
        the mean effect of each action, `Q` the spread around it, and `range_noise` the camera's
        error. `arkaq_edu.experiments.approach.calibrate` measures them, and a test compares.
        """
        return cls(
            (200.0, -0.5),
            (4100.0, 0.5),
            A=np.eye(2),
            H=np.eye(2),
            Q=np.diag([4.4**2, 0.025**2]),
            R=np.diag([3.0**2, 0.001**2]),
            P0=np.diag([1950.0**2, 0.5**2]),
            B=[[-96.0, -96.0, -96.0], [0.0, -0.1, 0.1]],
            range_noise=7.4e-6,
        )

    @classmethod
    def goal(cls) -> Sensing:
        """Return settings measured on the field for the goal: its orientation alone.

        A turn to the left moves the goal to the right. `arkaq_edu.experiments.goal` measures `B`,
        `Q` and `R` (`calibrate`), and a test compares.
        """
        return cls(
            (-0.5,),
            (0.5,),
            A=[[1.0]],
            H=[[1.0]],
            Q=[[0.0026**2]],
            R=[[0.00095**2]],
            P0=[[0.5**2]],
            B=[[-0.148, 0.148, 0.0]],
        )

    def filter(self) -> KalmanFilter:
        """Return the Kalman filter with these settings, starting in the middle of the interval."""
        x0 = np.zeros(len(np.asarray(self.A)))
        x0[: len(self.low)] = (np.asarray(self.low) + np.asarray(self.high)) / 2
        return KalmanFilter(self.A, self.H, self.Q, self.R, self.B, x0, self.P0)

    def noise(self, z: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return R for one sighting, shape (m, m).

        Raises
        ------
        ValueError
            If the distance is beyond 1e20 in magnitude: its fourth power would overflow.
        """
        z = _checks.array("z", z, (len(self.low),))
        _checks.number("z[0]", z.item(0), -_FARTHEST, _FARTHEST)
        R = np.array(self.R, dtype=np.float64)
        R[0, 0] += (self.range_noise * z[0] ** 2) ** 2
        return R

    def scale(self, z: ArrayLike) -> NDArray[np.float64]:
        """Return measurements as patterns in [-1, 1].

        Parameters
        ----------
        z : array_like, shape (..., m)

        Returns
        -------
        ndarray, shape (..., m)

        References
        ----------
        Thesis 5.2.1: (distance - 2150) / 1950 and 2 * orientation.

        Examples
        --------
        >>> Sensing.thesis().scale([4100.0, -0.25])
        array([ 1. , -0.5])
        """
        z = _checks.array("z", z, (*(None,) * (_checks.n_axes("z", z) - 1), len(self.low)))
        return _scaled(z, *self.interval())

    def unscale(self, patterns: ArrayLike) -> NDArray[np.float64]:
        """Return patterns as measurements: the inverse of `scale` inside the interval."""
        shape = (*(None,) * (_checks.n_axes("patterns", patterns) - 1), len(self.low))
        low, high = np.asarray(self.low), np.asarray(self.high)
        return _checks.array("patterns", patterns, shape) * (high - low) / 2 + (low + high) / 2

    def interval(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Return the middle and half the width of the interval of each measurement."""
        low, high = np.asarray(self.low), np.asarray(self.high)
        return (low + high) / 2, (high - low) / 2

    def to_json(self) -> dict[str, Any]:
        """Return the settings as plain lists and numbers."""
        return {
            name: value if value is None else np.asarray(value, dtype=float).tolist()
            for name, value in vars(self).items()
        }

    @classmethod
    def from_json(cls, settings: Mapping[str, Any]) -> Sensing:
        """Return the settings that `to_json` wrote."""
        return cls(**_checks.instance("settings", settings, dict))


def _scaled(
    z: NDArray[np.float64], middle: NDArray[np.float64], half: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Return measurements as patterns in [-1, 1], clipped to the interval `middle` +- `half`."""
    return np.minimum(np.maximum((z - middle) / half, -1.0), 1.0)


#: The same for one measurement, compiled: numpy's overhead is larger than the work.
_scaled_one = kernel(_scaled)

#: The settings that `Arkaq` knows by name.
PRESETS: dict[str, Callable[[], Sensing]] = {
    "consistent": Sensing.consistent,
    "thesis": Sensing.thesis,
    "goal": Sensing.goal,
}


@dataclass
class Estimator:
    """A running estimate of where the ball, or the goal, is.

    Parameters
    ----------
    sensing : Sensing
        The settings.

    Examples
    --------
    >>> senses = Estimator(Sensing.consistent())
    >>> senses.observe(np.array([2000.0, 0.1, 1.0]), None).round(3)
    array([-0.077,  0.2  ])
    >>> senses.observe(np.array([0.0, 0.0, 0.0]), 0).round(3)  # not seen: the estimate moves on
    array([-0.126,  0.2  ])
    """

    sensing: Sensing
    kalman: KalmanFilter = field(init=False)

    def __post_init__(self) -> None:
        self.kalman = _checks.instance("sensing", self.sensing, Sensing).filter()
        B = self.sensing.B
        self._inputs = None if B is None else np.eye(B.shape[1])
        self._interval = self.sensing.interval()

    def reset(self) -> None:
        """Forget everything: the supervisor has reset the world."""
        self.kalman.reset()

    def observe(self, observation: ArrayLike, action: int | None) -> NDArray[np.float64]:
        """Take in an observation and return the pattern.

        Parameters
        ----------
        observation : array_like, shape (m + 1,)
            The measurements, then 1 with a sighting and 0 without.
        action : int or None
            The action that led here; None at the start of an episode.

        Returns
        -------
        ndarray, shape (m,)
            The scaled estimate, each entry in [-1, 1].

        Raises
        ------
        ValueError
            If the observation has the wrong shape or is not finite, or the action is unknown.
            Then the estimate is as it was.
        """
        m = len(self.sensing.low)
        look = _checks.array("observation", observation, (m + 1,))
        z, seen = look[:m], look.item(m) != 0
        R = self.sensing.noise(z) if seen and self.sensing.range_noise else None
        if action is not None:
            most = None if self._inputs is None else len(self._inputs) - 1
            action = _checks.integer("action", action, 0, most)
            self.kalman.predict(None if self._inputs is None else self._inputs[action])
        if seen:
            self.kalman.update(z, R)
        return _scaled_one(self.kalman.x[:m], *self._interval)

"""The parameters of learning that the thesis never gives, each with its reason."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import Any

from arkaq_edu import _checks

#: At some thousand cycles a second this is more than two days.
MOST_CYCLES = 10**9

_GOAL: dict[str, Any] = {
    "patterns": 2000,
    "period": 50,
    "exploration": 600,
    "exploitation": 5400,
    "hold": 1,
    "gamma": 0.95,
    "alpha_least": 0.015,
    "hot": 40.0,
    "cold": 4.0,
    "cycle_reward": -10.0,
}


@dataclass(frozen=True)
class TrainingSettings:
    """How an ARKAQ agent learns.

    Parameters
    ----------
    learning_rate : float
        ART's update factor eta (eq 4.6), in (0, 1]. With .6, one stream of 6,500 patterns gives
        all five counts of centers in the thesis within 15 %.
    patterns : int
        The number of patterns in the segmentation phase, at most 10**9, as all numbers of cycles.
    period : int
        The supervisor resets the world after so many cycles of the segmentation phase, so that
        the patterns come from everywhere.
    exploration, exploitation : int
        The number of cycles in each part of Q-learning.
    hold : int
        The most cycles for which an action is held while the state stays the same. As printed,
        figure 4.3 would hold an action forever that cannot change the state.
    gamma : float
        The discount per cycle, in (0, 1).
    alpha_power, alpha_least : float
        The n-th visit of a pair learns with the rate max(alpha_least, n ** -alpha_power). So the
        rate starts at 1, as section 4.3 says.
    hot, cold : float
        The Boltzmann temperature at the start and the end of exploitation, in units of the
        reward. It falls geometrically.
    lost_reward : float
        The reward for losing the ball for good. It is zero by default: nothing more can be earned
        after that, and with a discount this is punishment enough.
    cycle_reward : float
        A reward for each cycle, added to the task's own. At the goal a miss costs as much as a
        goal earns. Where fewer than half of the best kicks score, the best kick is worth less
        than nothing, and a robot that only discounts would turn forever. A cost per cycle makes
        it kick.

    Raises
    ------
    ValueError
        If a parameter is out of range.

    Notes
    -----
    The defaults are for the ball. `goal` returns those for the goal.

    Examples
    --------
    >>> TrainingSettings(gamma=1.5)
    Traceback (most recent call last):
    ValueError: gamma must be a number in (0, 1), got 1.5
    """

    learning_rate: float = 0.6
    patterns: int = 6500
    period: int = 20
    exploration: int = 30_000
    exploitation: int = 40_000
    hold: int = 10
    gamma: float = 0.97
    alpha_power: float = 0.6
    alpha_least: float = 0.02
    hot: float = 10.0
    cold: float = 0.5
    lost_reward: float = 0.0
    cycle_reward: float = 0.0

    def __post_init__(self) -> None:
        self._number("learning_rate", 0, 1, open_low=True)
        for name in ("patterns", "period", "hold"):
            self._keep(name, _checks.integer(name, getattr(self, name), 1, MOST_CYCLES))
        for name in ("exploration", "exploitation"):
            self._keep(name, _checks.integer(name, getattr(self, name), 0, MOST_CYCLES))
        self._number("gamma", 0, 1, open_low=True, open_high=True)
        self._number("alpha_power", 0, 1)
        self._number("alpha_least", 0, 1)
        self._number("cold", 0, _checks.LARGEST, open_low=True)
        self._number("hot", self.cold, _checks.LARGEST)
        self._number("lost_reward")
        self._number("cycle_reward")

    def _number(self, name: str, *bounds: float, **ends: bool) -> None:
        self._keep(name, _checks.number(name, getattr(self, name), *bounds, **ends))

    def _keep(self, name: str, value: float) -> None:
        object.__setattr__(self, name, value)  # the settings are frozen for everybody else

    @classmethod
    def goal(cls, **changes: Any) -> TrainingSettings:
        """Return the parameters for the goal, some of them changed.

        One kick says little, since even the best misses four times in ten. So the values average
        over more visits (`alpha_least`), and the temperature is higher. No action is held, since
        every turn changes the state. The robot looks around in long periods; see
        `arkaq_edu.experiments.goal.record_sightings`.

        Examples
        --------
        >>> TrainingSettings.goal(patterns=500).patterns
        500
        """
        return cls(**_GOAL | changes)

    def alpha(self, visit: int) -> float:
        """Return the learning rate of the n-th visit, n = 1, 2, ..."""
        visit = _checks.integer("visit", visit, 1)
        return max(self.alpha_least, visit**-self.alpha_power)

    def temperature(self, progress: float) -> float:
        """Return the temperature at a fraction in [0, 1] of exploitation."""
        progress = _checks.number("progress", progress, 0, 1)
        return self.hot * (self.cold / self.hot) ** progress

    def to_json(self) -> dict[str, Any]:
        """Return the parameters by name.

        A `cycle_reward` of zero is left out, as in the files that are older than the parameter.
        """
        parameters = asdict(self)
        if not self.cycle_reward:
            del parameters["cycle_reward"]
        return parameters

"""What the thesis never gives: every parameter of learning, named, with its reason."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import Any

from arkaq_edu import _checks

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
        ART's update factor eta (eq 4.6), in (0, 1]. With .6 one stream of 6,500 patterns gives
        all five of the thesis's counts of centers within 15 %.
    patterns : int
        Patterns the segmentation phase presents.
    period : int
        Cycles after which the supervisor resets the world while the field is segmented, "so that
        the segmentation covers all possible points".
    exploration, exploitation : int
        Cycles of either phase of Q-learning.
    hold : int
        Cycles an action is held at most while the state stays the same. As printed, figure 4.3
        would hold it for ever where an action cannot change the state.
    gamma : float
        Discount a cycle, in (0, 1).
    alpha_power, alpha_least : float
        The n-th visit of a pair learns with max(alpha_least, n ** -alpha_power). It begins at 1,
        as 4.3 says.
    hot, cold : float
        Boltzmann temperature at the start and the end of exploitation, in units of the reward;
        it falls geometrically.
    lost_reward : float
        What losing the ball for good is worth. Zero: nothing more can be earned then, which is
        punishment enough under a discount.
    cycle_reward : float
        What each cycle is worth beside what the task pays. Where the best kick is worth less than
        nothing (under half of them score, and a miss costs as much as a goal earns), a discount
        alone would have the robot turn for ever; a cycle that costs something has it kick.

    Notes
    -----
    The defaults are for the ball; `goal` returns those for the goal.

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
        _checks.number("learning_rate", self.learning_rate, 0, 1, open_low=True)
        for name in ("patterns", "period", "hold"):
            _checks.integer(name, getattr(self, name), 1)
        for name in ("exploration", "exploitation"):
            _checks.integer(name, getattr(self, name), 0)
        _checks.number("gamma", self.gamma, 0, 1, open_low=True, open_high=True)
        _checks.number("alpha_power", self.alpha_power, 0, 1)
        _checks.number("alpha_least", self.alpha_least, 0, 1)
        _checks.number("cold", self.cold, 0, open_low=True)
        _checks.number("hot", self.hot, self.cold)
        _checks.number("lost_reward", self.lost_reward)
        _checks.number("cycle_reward", self.cycle_reward)

    @classmethod
    def goal(cls, **changes: Any) -> TrainingSettings:
        """Return the parameters for the goal problem, some of them changed.

        A kick says little, for the best still misses four times in ten: so the values average
        over more visits (`alpha_least`), and the temperature starts higher and stays so. No action
        is held, for every turn leaves its state. The robot looks about in long periods, see
        `arkaq_edu.experiments.goal.record_orientations`.

        Examples
        --------
        >>> TrainingSettings.goal(patterns=500).patterns
        500
        """
        return cls(**_GOAL | changes)

    def alpha(self, visit: int) -> float:
        """Return the learning rate of the n-th visit, n = 1, 2, ..."""
        return max(self.alpha_least, visit**-self.alpha_power)

    def temperature(self, progress: float) -> float:
        """Return the temperature at a fraction in [0, 1] of exploitation."""
        return self.hot * (self.cold / self.hot) ** progress

    def to_json(self) -> dict[str, Any]:
        """Return the parameters by name.

        A `cycle_reward` of zero is left out: files written before there was one stay as they are.
        """
        kept = asdict(self)
        if not self.cycle_reward:
            del kept["cycle_reward"]
        return kept

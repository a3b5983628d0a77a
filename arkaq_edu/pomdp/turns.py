"""A history of actions and observations by name, as buttons record it."""

from __future__ import annotations

from collections.abc import Iterable

from arkaq_edu.pomdp.belief import Trajectory, successors, trajectory
from arkaq_edu.pomdp.model import POMDP

#: The name of an observation that is left to chance.
WORLD = "let the world answer"


def follow(pomdp: POMDP, presses: Iterable[str], seed: int) -> Trajectory:
    """Return the beliefs that the pressed buttons lead to.

    Examples
    --------
    >>> from arkaq_edu.pomdp import problem
    >>> follow(problem("floors"), ["down", WORLD], 0).steps
    [(0, 0)]
    """
    return trajectory(pomdp, [None if name == WORLD else name for name in presses], seed)


def possible(pomdp: POMDP, track: Trajectory) -> dict[str, float]:
    """Return the observations that can follow the action that waits for one, by probability.

    Examples
    --------
    >>> from arkaq_edu.pomdp import problem
    >>> corridor = problem("corridor")
    >>> possible(corridor, follow(corridor, ["right", "goal", "left"], 0))
    {'nothing': 1.0}
    """
    if track.pending is None:
        return {}
    chances = successors(pomdp, track.beliefs[-2], track.pending).chances.tolist()
    return {name: p for name, p in zip(pomdp.observations, chances, strict=True) if p}

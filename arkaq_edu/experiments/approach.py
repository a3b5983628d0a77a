"""The first experiment of the thesis: learn to walk to the ball, then walk to it."""

from __future__ import annotations

import math
import os
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import gymnasium
import numpy as np
import pandas as pd
from numpy.typing import NDArray

from arkaq_edu import _checks
from arkaq_edu._paths import data_file
from arkaq_edu.arkaq import Arkaq, Estimator, TrainingSettings
from arkaq_edu.envs.ball_approach import FOOTSTEPS
from arkaq_edu.field import pitch
from arkaq_edu.field.supervisor import MAX_BALL_DISTANCE, random_place

# A policy begins an episode and then chooses from the observation and the true state.
Choice = Callable[[NDArray[np.floating], dict[str, Any]], int]
Policy = Callable[[int], Choice]

# Where the ball lies in figures 5.17 to 5.30, trajectories 1 to 11: distance (mm) and
# orientation (rad). The thesis gives pictures only; these cover the field from edge to edge.
STARTS = (
    (1200.0, 0.0),
    (1500.0, 0.35),
    (1500.0, -0.35),
    (2200.0, 0.15),
    (2200.0, -0.45),
    (2600.0, 0.45),
    (3000.0, -0.2),
    (3200.0, 0.3),
    (3600.0, -0.4),
    (3900.0, 0.4),
    (4050.0, 0.05),
)


def make_task(**options: Any) -> gymnasium.Env:
    """Return the task as the agent is trained on it: the ball placed by eq 5.1.

    Examples
    --------
    >>> make_task().unwrapped.supervisor.placement
    'thesis'
    """
    return gymnasium.make("arkaq_edu:BallApproach-v0", **{"placement": "thesis", **options})


def train(
    seed: int = 0,
    vigilance: float = 0.1,
    *,
    sensing: str = "consistent",
    learning: TrainingSettings | None = None,
    checkpoint: str | os.PathLike[str] | None = None,
    progress: bool = True,
) -> Arkaq:
    """Train one agent on the ball-approach task.

    Parameters
    ----------
    seed : int
        The agent's seed.
    vigilance : float
        See `Arkaq`.
    sensing : {"consistent", "thesis"}
        The Kalman filter's settings.
    learning : TrainingSettings, optional
        Schedules and lengths.
    checkpoint : path, optional
        File the run is kept in and taken up from; see `Arkaq.learn`.
    progress : bool
        Whether to show progress bars.

    Returns
    -------
    Arkaq

    Examples
    --------
    >>> brief = TrainingSettings(patterns=200, exploration=500, exploitation=0)
    >>> train(seed=1, learning=brief, progress=False).cycles >= 500
    True
    """
    agent = Arkaq(vigilance, sensing=sensing, learning=learning, rng=seed)  # type: ignore[arg-type]
    return agent.learn(make_task(), checkpoint=checkpoint, progress=progress)


def load_agent() -> Arkaq:
    """Return the agent trained for the course: ``train(seed=0)``, kept in ``data``.

    Examples
    --------
    >>> load_agent().vigilance
    0.1
    """
    return Arkaq.load(data_file("ball_approach.npz"))


def greedy(agent: Arkaq) -> Policy:
    """Return the agent's greedy policy."""

    def begin(episode: int) -> Choice:
        agent.reset()
        return lambda observation, info: agent.act(observation)

    return begin


def at_random(seed: int = 0) -> Policy:
    """Return the policy of random actions."""

    def begin(episode: int) -> Choice:
        rng = np.random.default_rng([seed, episode])
        return lambda observation, info: int(rng.integers(len(FOOTSTEPS)))

    return begin


def planner() -> Policy:
    """Return a planner that sees the true state: the action after which the ball is straightest.

    It knows the gait as it is meant to be, without drift or variation.
    """

    def choose(observation: NDArray[np.floating], info: dict[str, Any]) -> int:
        x = info["distance"] * math.cos(info["orientation"])
        y = info["distance"] * math.sin(info["orientation"])

        def off_line(action: int) -> float:
            left, right = FOOTSTEPS[action]
            turn, ahead = (right - left) / pitch.ROBOT_WIDTH, (left + right) / 2
            after = (ahead * math.cos(turn / 2), ahead * math.sin(turn / 2), turn)
            return abs(pitch.bearing(*after, x, y)[1])

        return min(range(len(FOOTSTEPS)), key=off_line)

    return lambda episode: choose


def evaluate(policy: Policy, n: int = 500, seed: int = 0, near: float = 600.0) -> pd.DataFrame:
    """Walk to the ball from fresh starts, uniform over the visible field.

    Parameters
    ----------
    policy : Policy
        See `greedy`, `at_random`, `planner`.
    n : int
        Number of approaches.
    seed : int
        The seed of the starts and footsteps: the same for every policy it is given to.
    near : float
        The nearest start (mm); the farthest is 4100.

    Returns
    -------
    DataFrame
        A row an approach: distance and orientation at the start, is_success, reward, bonus
        (whether the +50 was earned), cycles, and detour: the way walked over the straight way.

    Examples
    --------
    >>> bool(evaluate(planner(), n=20).is_success.all())
    True
    """
    env = gymnasium.make("arkaq_edu:BallApproach-v0")
    rows = []
    for episode in range(_checks.integer("n", n, 1)):
        rng = np.random.default_rng([_checks.integer("seed", seed), episode])
        distance, orientation = random_place(rng, near, MAX_BALL_DISTANCE)
        rows.append(_approach(env, policy(episode), distance, orientation, rng))
    return pd.DataFrame(rows)


def _approach(
    env: gymnasium.Env, choose: Choice, distance: float, orientation: float, rng
) -> dict[str, Any]:
    place = {"distance": distance, "orientation": orientation}
    observation, info = env.reset(seed=int(rng.integers(2**31)), options=place)
    over = False
    while not over:
        observation, reward, terminated, truncated, info = env.step(choose(observation, info))
        over = terminated or truncated
    trail = np.array(env.unwrapped.trail)  # type: ignore[attr-defined]
    walked = float(np.hypot(*np.diff(trail, axis=0).T).sum())
    return {
        "distance": distance,
        "orientation": orientation,
        "is_success": info["is_success"],
        "reward": float(reward),
        "bonus": float(reward) > 100,
        "cycles": len(trail) - 1,
        "detour": walked / (distance - info["distance"]) if info["is_success"] else math.nan,
    }


@dataclass(frozen=True)
class Walk:
    """One walk to the ball, look by look.

    Attributes
    ----------
    table : DataFrame
        A row a look: x, y (mm) and heading (rad) of the robot, ball_x, ball_y, the true distance
        and orientation, seen_distance and seen_orientation (NaN without a sighting),
        estimated_distance and estimated_orientation, the category, and the action taken (-1 at
        the end).
    is_success : bool
        Whether the ball was reached.
    reward : float
        The reward earned.
    """

    table: pd.DataFrame
    is_success: bool
    reward: float


def walk(agent: Arkaq, distance: float, orientation: float, seed: int = 0) -> Walk:
    """Let the agent walk to a ball at a given place, and write down every look.

    Parameters
    ----------
    agent : Arkaq
        A trained agent.
    distance, orientation : float
        Where the ball lies at the start (mm, rad).
    seed : int
        The seed of the footsteps.

    Returns
    -------
    Walk

    Raises
    ------
    ValueError
        If the agent has not finished segmenting, or the place is out of range.

    References
    ----------
    Thesis figures 5.17-5.30.

    Examples
    --------
    >>> way = walk(load_agent(), 1500.0, 0.2)
    >>> way.is_success, bool(way.table.distance.iloc[-1] < 500)
    (True, True)
    """
    if agent.q is None:
        raise ValueError("agent must have learned: train it in the same file to go on")
    env = gymnasium.make("arkaq_edu:BallApproach-v0")
    observation, info = env.reset(
        seed=seed, options={"distance": distance, "orientation": orientation}
    )
    senses = Estimator(agent.sensing)
    agent.reset()
    rows, action, reward, over = [], None, 0.0, False
    while True:
        pattern = senses.observe(observation, action)
        row = _look(env.unwrapped.world, observation, info)  # type: ignore[attr-defined]
        estimate = agent.sensing.unscale(pattern)
        row |= {"estimated_distance": estimate[0], "estimated_orientation": estimate[1]}
        row["category"] = agent.art.category(pattern)
        action = -1 if over else agent.act(observation)
        rows.append(row | {"action": action})
        if over:
            return Walk(pd.DataFrame(rows), info["is_success"], reward)
        observation, gained, terminated, truncated, info = env.step(action)
        reward, over = reward + float(gained), terminated or truncated


def _look(world, observation: NDArray[np.floating], info: dict[str, Any]) -> dict[str, float]:
    (x, y, heading), (ball_x, ball_y) = world.pose, world.ball
    seen = observation[:2].tolist() if observation[2] else (math.nan, math.nan)
    return {
        "x": x,
        "y": y,
        "heading": heading,
        "ball_x": ball_x,
        "ball_y": ball_y,
        "distance": info["distance"],
        "orientation": info["orientation"],
        "seen_distance": seen[0],
        "seen_orientation": seen[1],
    }

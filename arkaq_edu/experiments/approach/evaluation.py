"""How well a policy walks to the ball, and single trajectories look by look."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import gymnasium
import numpy as np
import pandas as pd
from numpy.typing import NDArray

from arkaq_edu import _checks
from arkaq_edu.arkaq import Arkaq, Estimator
from arkaq_edu.experiments import runs
from arkaq_edu.experiments.approach.task import load_agent
from arkaq_edu.experiments.policies import Choice, Policy
from arkaq_edu.field.supervisor import CLOSE_REWARD, MAX_BALL_DISTANCE, random_place

#: Where the ball is at the start of trajectories 1 to 11 (figures 5.17 to 5.30): distance (mm) and
#: orientation (rad). The thesis only has pictures; these starts cover the field from edge to edge.
TRAJECTORY_STARTS = (
    (1200.0, 0.0), (1500.0, 0.35), (1500.0, -0.35), (2200.0, 0.15), (2200.0, -0.45), (2600.0, 0.45),
    (3000.0, -0.2), (3200.0, 0.3), (3600.0, -0.4), (3900.0, 0.4), (4050.0, 0.05),
)  # fmt: skip


def evaluate(
    policy: Policy,
    n: int = 500,
    seed: int = 0,
    *,
    near: float = 600.0,
    far: float = MAX_BALL_DISTANCE,
    **options: Any,
) -> pd.DataFrame:
    """Walk to the ball from fresh starts, uniform over the visible field.

    Parameters
    ----------
    policy : Policy
        See `greedy`, `at_random`, `planner`.
    n : int
        Number of episodes.
    seed : int
        The seed of the starts and footsteps: the same for every policy.
    near, far : float
        The nearest and the farthest start (mm).
    **options
        Other options of the task, for example ``patience``.

    Returns
    -------
    DataFrame
        One row an episode: distance (mm) and orientation (rad) at the start, is_success, reward,
        bonus (whether the +50 was earned), cycles, and detour: the length of the path over that
        of the straight line.

    Examples
    --------
    >>> from arkaq_edu.experiments.approach import planner
    >>> bool(evaluate(planner(), n=20).is_success.all())
    True
    """
    env = gymnasium.make("arkaq_edu:BallApproach-v0", **options)

    def run_episode(choose: Choice, rng: np.random.Generator) -> dict[str, Any]:
        distance, orientation = random_place(rng, near, far)
        place = {"distance": distance, "orientation": orientation}
        observation, info = env.reset(seed=int(rng.integers(2**31)), options=place)
        over = False
        while not over:
            observation, reward, terminated, truncated, info = env.step(choose(observation, info))
            over = terminated or truncated
        trail = np.array(env.unwrapped.trail)  # type: ignore[attr-defined]
        walked = float(np.hypot(*np.diff(trail, axis=0).T).sum())
        success = info["is_success"]
        return place | {
            "is_success": success,
            "reward": float(reward),
            "bonus": float(reward) > CLOSE_REWARD,
            "cycles": len(trail) - 1,
            "detour": walked / (distance - info["distance"]) if success else math.nan,
        }

    return runs.evaluate(run_episode, policy, n, seed)


def describe(table: pd.DataFrame) -> str:
    """Return what `evaluate` found in one sentence.

    Examples
    --------
    >>> describe(pd.DataFrame({"is_success": [True, True], "bonus": [True, False]}))
    'ball reached in 100.0% of 2 fresh approaches, +50 in 50.0%'
    """
    return (
        f"ball reached in {table.is_success.mean():.1%} of {len(table)} fresh approaches, "
        f"+50 in {table.bonus.mean():.1%}"
    )


def score(table: pd.DataFrame) -> dict[str, float]:
    """Return what `evaluate` found, as numbers by name; see `arkaq_edu.experiments.study`.

    Examples
    --------
    >>> from arkaq_edu.experiments.approach import planner
    >>> found = score(evaluate(planner(), n=20))
    >>> [*found], found["success"]
    (['success', 'bonus', 'path', 'cycles', 'reward'], 100.0)
    """
    return {
        "success": 100 * float(table.is_success.mean()),
        "bonus": 100 * float(table.bonus.mean()),
        "path": float(table.detour.median()),
        "cycles": float(table.cycles.mean()),
        "reward": float(table.reward.mean()),
    }


@dataclass(frozen=True)
class Trajectory:
    """One walk to the ball, look by look.

    Attributes
    ----------
    table : DataFrame
        One row a look: x, y (mm) and heading (rad) of the robot, ball_x, ball_y (mm), the true
        distance and orientation, seen_distance and seen_orientation (NaN without a sighting),
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

    @property
    def outcome(self) -> str:
        """How the walk ended.

        Examples
        --------
        >>> trajectory(1).outcome
        'reached the ball in 8 footstep cycles, reward 150'
        """
        end = "reached the ball" if self.is_success else "did not reach the ball"
        return f"{end} in {len(self.table) - 1} footstep cycles, reward {self.reward:g}"

    @property
    def summary(self) -> str:
        """Where the ball was at the start, how long the path was, and what it earned.

        Examples
        --------
        >>> trajectory(1).summary.split(":")[0]
        'from 1,200 mm, straight ahead'
        """
        first, last = self.table.iloc[0], self.table.iloc[-1]
        aside = f"{abs(first.orientation):.2f} rad {'left' if first.orientation > 0 else 'right'}"
        where = "straight ahead" if round(first.orientation, 2) == 0 else aside
        end = "the ball is not reached"
        if self.is_success:
            walked = np.hypot(self.table.x.diff(), self.table.y.diff()).sum()
            detour = walked / (first.distance - last.distance)
            end = f"{detour:.2f} × the straight line, +{self.reward:g}"
        return f"from {first.distance:,.0f} mm, {where}: {end}"


def record_episode(
    agent: Arkaq, distance: float = 3500.0, orientation: float = 0.35, *, seed: int = 0
) -> Trajectory:
    """Let the agent walk to the ball, and record every look.

    Parameters
    ----------
    agent : Arkaq
        A trained agent.
    distance, orientation : float
        Where the ball is at the start (mm, rad).
    seed : int
        The seed of the footsteps.

    Returns
    -------
    Trajectory

    Raises
    ------
    ValueError
        If the agent has not learned, or the place is out of range.

    References
    ----------
    Thesis figures 5.17-5.30.

    Examples
    --------
    >>> walked = record_episode(load_agent(), 1500.0, 0.2)
    >>> walked.is_success, bool(walked.table.distance.iloc[-1] < 500)
    (True, True)
    """
    if agent.q is None:
        raise ValueError("agent must have learned: train it in the same file to continue")
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
            return Trajectory(pd.DataFrame(rows), info["is_success"], reward)
        observation, gained, terminated, truncated, info = env.step(action)
        reward, over = reward + float(gained), terminated or truncated


def _look(world, observation: NDArray[np.floating], info: dict[str, Any]) -> dict[str, float]:
    names = (
        "x", "y", "heading", "ball_x", "ball_y", "distance", "orientation", "seen_distance",
        "seen_orientation",
    )  # fmt: skip
    seen = observation[:2].tolist() if observation[2] else (math.nan, math.nan)
    values = *world.pose, *world.ball, info["distance"], info["orientation"], *seen
    return dict(zip(names, values, strict=True))


def trajectory(number: int, agent: Arkaq | None = None) -> Trajectory:
    """Walk one of the eleven trajectories of figures 5.17 to 5.30.

    Parameters
    ----------
    number : int
        From 1 to 11.
    agent : Arkaq, optional
        A trained agent; by default the one that comes with the course.

    Returns
    -------
    Trajectory

    Examples
    --------
    >>> trajectory(1).is_success
    True
    """
    number = _checks.integer("number", number, 1, len(TRAJECTORY_STARTS))
    return record_episode(agent or load_agent(), *TRAJECTORY_STARTS[number - 1])

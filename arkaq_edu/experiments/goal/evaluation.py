"""How often a policy scores, and single shots look by look."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from arkaq_edu.arkaq import Arkaq, Estimator
from arkaq_edu.envs.score_goal import KICK
from arkaq_edu.experiments import runs
from arkaq_edu.experiments.goal.task import Distance, make_task
from arkaq_edu.experiments.policies import Choice, Policy


def evaluate(
    policy: Policy,
    n: int = 500,
    seed: int = 0,
    *,
    goal_distance: Distance | float = "near",
    **options: Any,
) -> pd.DataFrame:
    """Let a policy aim and kick from fresh starts.

    Parameters
    ----------
    policy : Policy
        See `greedy`, `at_random`, `planner`.
    n : int
        Number of episodes.
    seed : int
        The seed of starts, turns and kicks: the same for every policy.
    goal_distance : {"near", "far"} or float
        Where the robot stands.
    **options
        Other options of the task, for example ``patience``.

    Returns
    -------
    DataFrame
        One row an episode: start (the orientation there, rad), aim (the orientation at the last
        action, rad), turns, kicked (whether the episode ended with a kick), reward, is_success.

    Examples
    --------
    >>> from arkaq_edu.experiments.goal import planner
    >>> shots = evaluate(planner(), n=20)
    >>> bool(shots.kicked.all()), bool(shots.aim.abs().max() < 0.08)
    (True, True)
    """
    env = make_task(goal_distance, **options)

    def run_episode(choose: Choice, rng: np.random.Generator) -> dict[str, Any]:
        observation, info = env.reset(seed=int(rng.integers(2**31)))
        start, turns, over = info["orientation"], 0, False
        while not over:
            aim, action = info["orientation"], choose(observation, info)
            turns += action != KICK
            observation, reward, over, _, info = env.step(action)
        return {
            "start": start,
            "aim": aim,
            "turns": turns,
            "kicked": action == KICK,
            "reward": float(reward),
            "is_success": info["is_success"],
        }

    return runs.evaluate(run_episode, policy, n, seed)


def describe(table: pd.DataFrame) -> str:
    """Return what `evaluate` found in one sentence.

    Examples
    --------
    >>> describe(pd.DataFrame({"is_success": [True, False]}))
    'goals in 50.0% of 2 fresh kicks'
    """
    return f"goals in {table.is_success.mean():.1%} of {len(table)} fresh kicks"


def score(table: pd.DataFrame) -> dict[str, float]:
    """Return what `evaluate` found, as numbers by name; see `arkaq_edu.experiments.study`.

    Examples
    --------
    >>> score(pd.DataFrame({"is_success": [True, False], "turns": [1, 2], "reward": [100, -100]}))
    {'success': 50.0, 'turns': 1.5, 'reward': 0.0}
    """
    return {
        "success": 100 * float(table.is_success.mean()),
        "turns": float(table.turns.mean()),
        "reward": float(table.reward.mean()),
    }


@dataclass(frozen=True)
class Shot:
    """One episode, look by look, with pictures.

    Attributes
    ----------
    table : DataFrame
        One row a look: the true orientation (rad), seen_orientation (NaN without a sighting),
        estimated_orientation, the category, and the action taken (-1 at the end).
    frames : list of ndarray of uint8
        Pictures of the field from above.
    looks : list of int
        For each frame, the last look before it.
    is_success : bool
        Whether a goal was scored.
    """

    table: pd.DataFrame
    frames: list[NDArray[np.uint8]]
    looks: list[int]
    is_success: bool

    @property
    def turns(self) -> str:
        """How many turns the robot made, in words."""
        n = int(self.table.action.isin(range(KICK)).sum())
        return f"{n} turn{'s' * (n != 1)}"

    @property
    def outcome(self) -> str:
        """How the shot ended.

        Examples
        --------
        >>> from arkaq_edu.experiments.goal import load_agent
        >>> record_episode(load_agent(), 0.1).outcome
        'a goal after 1 turn'
        """
        return f"{'a goal' if self.is_success else 'a miss'} after {self.turns}"

    @property
    def summary(self) -> str:
        """Where the goal was at the start, and how the shot ended.

        Examples
        --------
        >>> from arkaq_edu.experiments.goal import load_agent
        >>> record_episode(load_agent(), 0.1).summary
        'the goal 0.10 rad left, 1 turn: a goal'
        """
        start = self.table.orientation.iloc[0]
        aside = f"{abs(start):.2f} rad {'left' if start > 0 else 'right'}"
        where = "straight ahead" if round(start, 2) == 0 else aside
        return f"the goal {where}, {self.turns}: {'a goal' if self.is_success else 'a miss'}"


def record_episode(
    agent: Arkaq,
    orientation: float = 0.35,
    *,
    goal_distance: Distance | float = "near",
    seed: int = 0,
) -> Shot:
    """Let the agent aim and kick, and record every look.

    Parameters
    ----------
    agent : Arkaq
        A trained agent.
    orientation : float
        Where the goal is at the start (rad).
    goal_distance : {"near", "far"} or float
        Where the robot stands; see `arkaq_edu.envs.ScoreGoalEnv`.
    seed : int
        The seed of the turns and of the kick.

    Returns
    -------
    Shot

    Raises
    ------
    ValueError
        If the agent has not learned to score.

    References
    ----------
    Thesis figures 5.31-5.33.

    Examples
    --------
    >>> from arkaq_edu.experiments.goal import load_agent
    >>> shot = record_episode(load_agent(), orientation=0.3)
    >>> shot.table.action.iloc[-2:].tolist()  # the kick, and the end
    [2, -1]
    """
    if agent.task != "goal" or agent.q is None:
        raise ValueError("agent must have learned to score a goal: see arkaq train goal")
    env = make_task(goal_distance, render_mode="rgb_array_list")
    observation, info = env.reset(seed=seed, options={"orientation": orientation})
    senses, action, over = Estimator(agent.sensing), None, False
    agent.reset()
    rows: list[dict[str, Any]] = []
    frames: list[NDArray[np.uint8]] = []
    looks: list[int] = []
    while True:
        new: Any = env.render()
        frames += new
        # A turn has one picture, of its end. A kick has many, all of which belong to the kick.
        looks += [max(0, len(rows) - 1 + (not rows or action != KICK))] * len(new)
        pattern = senses.observe(observation, action)
        row = {
            "orientation": info["orientation"],
            "seen_orientation": observation[0] if observation[1] else np.nan,
            "estimated_orientation": float(agent.sensing.unscale(pattern)[0]),
            "category": agent.art.category(pattern),
        }
        action = -1 if over else agent.act(observation)
        rows.append(row | {"action": action})
        if over:
            looks[-1] = len(rows) - 1
            return Shot(pd.DataFrame(rows), frames, looks, info["is_success"])
        observation, _, over, _, info = env.step(action)

"""The second experiment of the thesis: learn to score a goal, against chance and the best there is.

The robot turns toward the goal and kicks; what it sees is one number, the goal's orientation.
"""

from __future__ import annotations

import os
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any, Literal

import gymnasium
import numpy as np
import pandas as pd
from gymnasium import spaces
from joblib import Parallel, delayed
from numpy.typing import ArrayLike, NDArray
from tqdm.auto import tqdm

from arkaq_edu import _checks
from arkaq_edu._paths import data_file
from arkaq_edu.arkaq import Arkaq, Estimator, Sensing, TrainingSettings
from arkaq_edu.envs.score_goal import ACTIONS, KICK, STARTS, TURN_LEFT, TURN_RIGHT
from arkaq_edu.experiments.approach import Choice, Policy, greedy
from arkaq_edu.experiments.streams import count_centers
from arkaq_edu.field import GoalSupervisor, World

Distance = Literal["near", "far"]

#: With which vigilance the thesis learns where: .06 in figures 5.39 and 5.40, .05 in figure 5.41.
VIGILANCE = {"near": 0.06, "far": 0.05}
#: The vigilances of figures 5.35 to 5.37.
VIGILANCES = (0.075, 0.06, 0.05)
#: Kicks that a curve shows: no fewer than every seed of the study has while it learns.
KICKS = {"near": 1400, "far": 1500}
#: Kicks of one entry of a curve, and fresh kicks by which a policy that no longer learns is judged.
BLOCK, FRESH = 50, 300

_LEARNING_FAR = TrainingSettings.goal(exploration=1000, exploitation=11_000)
_COLUMNS = ["episode", "cycle", "action", "orientation", "visible", "true_orientation"]


def _known(goal_distance: str) -> str:
    if goal_distance not in STARTS:
        raise ValueError(f"goal_distance must be 'near' or 'far', got {goal_distance!r}")
    return goal_distance


class LookAround(gymnasium.Wrapper):
    """The goal task without the kick: every episode begins straight before the goal.

    References
    ----------
    Thesis 5.3 ("from a specified location") and 5.3.1.

    Examples
    --------
    >>> task = LookAround(make_task())
    >>> observation, info = task.reset(seed=3)
    >>> info["orientation"], task.action_space
    (0.0, Discrete(2))
    """

    def __init__(self, env: gymnasium.Env) -> None:
        super().__init__(env)
        self.action_space = spaces.Discrete(KICK)  # both turns

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Any, dict[str, Any]]:
        """Begin with the goal straight ahead."""
        return self.env.reset(seed=seed, options={"orientation": 0.0})


def make_task(goal_distance: Distance | float = "near", **options: Any) -> gymnasium.Env:
    """Return the task in which the agent learns.

    Examples
    --------
    >>> make_task("far").unwrapped.start == STARTS["far"]
    True
    """
    return gymnasium.make("arkaq_edu:ScoreGoal-v0", goal_distance=goal_distance, **options)


def make_look_around(
    goal_distance: Distance | float = "near", period: int | None = None
) -> gymnasium.Env:
    """Return the task in which the agent segments its view of the goal; see `LookAround`.

    Examples
    --------
    >>> make_look_around().unwrapped.patience
    51
    """
    period = (
        TrainingSettings.goal().period if period is None else _checks.integer("period", period, 1)
    )
    return LookAround(make_task(goal_distance, patience=period + 1))


def train(
    seed: int = 0,
    vigilance: float | None = None,
    goal_distance: Distance = "near",
    *,
    learning: TrainingSettings | None = None,
    checkpoint: str | os.PathLike[str] | None = None,
    progress: bool = True,
) -> Arkaq:
    """Train one agent to score: it looks about, then it learns kick by kick.

    Parameters
    ----------
    seed : int
        The agent's seed.
    vigilance : float, optional
        See `Arkaq`; by default the thesis's, .06 near and .05 far.
    goal_distance : {"near", "far"}
        Where the robot stands; see `arkaq_edu.envs.ScoreGoalEnv`.
    learning : TrainingSettings, optional
        By default ``TrainingSettings.goal()``, far with twice the cycles:
        where two kicks in three miss at best, it takes that long to tell the best action.
    checkpoint : path, optional
        File the run is kept in and taken up from; see `Arkaq.learn`.
    progress : bool
        Whether to show progress bars.

    Returns
    -------
    Arkaq

    Notes
    -----
    Luck is left at the end. After 700 kicks in a state the last one still weighs 700 ** -.6 = .02,
    so the value of a kick wavers with a standard deviation of sqrt(.02 / 2) * 96 = 10, where 96 is
    that of one reward. Far, a turn and the best kick are hardly farther apart, and a few runs in
    thirty end with a policy that turns to and fro before it kicks, or never does; `rates` counts
    them. Weights that fall faster would be calmer, but never lose the optimizm of the first values.

    References
    ----------
    Thesis 5.3.1 and 5.3.2, figures 5.34 and 5.38.

    Examples
    --------
    >>> brief = TrainingSettings.goal(patterns=100, exploration=50, exploitation=0)
    >>> train(seed=1, learning=brief, progress=False).q.Q.shape[1]
    3
    """
    _known(goal_distance)
    vigilance = VIGILANCE[goal_distance] if vigilance is None else vigilance
    if learning is None:
        learning = TrainingSettings.goal() if goal_distance == "near" else _LEARNING_FAR
    agent = Arkaq(vigilance, task="goal", learning=learning, rng=seed)
    look_around = make_look_around(goal_distance, agent.learning.period)
    agent.segment(look_around, checkpoint=checkpoint, progress=progress)
    return agent.learn(make_task(goal_distance), checkpoint=checkpoint, progress=progress)


def load_agent(goal_distance: Distance = "near") -> Arkaq:
    """Return an agent trained for the course: ``train(seed=0, goal_distance=...)``.

    Examples
    --------
    >>> load_agent("far").vigilance
    0.05
    """
    _known(goal_distance)
    return Arkaq.load(data_file(f"goal_{goal_distance}.npz"))


# Policies -----------------------------------------------------------------------------------------


def at_random(seed: int = 0) -> Policy:
    """Return the policy of random actions."""

    def begin(episode: int) -> Choice:
        rng = np.random.default_rng([seed, episode])
        return lambda observation, info: int(rng.integers(len(ACTIONS)))

    return begin


def oracle() -> Policy:
    """Return the policy that sees the true orientation: it turns while that makes it straighter.

    It knows how far a turn turns, and nothing of kicks.
    """
    turn = Sensing.goal().B[0][TURN_RIGHT]

    def choose(observation: NDArray[np.floating], info: dict[str, Any]) -> int:
        orientation = info["orientation"]
        if abs(orientation) <= turn / 2:
            return KICK
        return TURN_LEFT if orientation > 0 else TURN_RIGHT

    return lambda episode: choose


def shots(policy: Policy, n: int, goal_distance: Distance = "near", seed: int = 0) -> pd.DataFrame:
    """Let a policy play episodes, each of which ends with a kick, or without one in vain.

    Parameters
    ----------
    policy : Policy
        See `arkaq_edu.experiments.greedy`, `at_random`, `oracle`.
    n : int
        Number of episodes.
    goal_distance : {"near", "far"}
    seed : int
        The seed of starts, turns and kicks: the same for every policy it is given to.

    Returns
    -------
    DataFrame
        A row an episode: start (the orientation there), aim (the orientation in which the robot
        kicked), turns, kicked, is_success.

    Examples
    --------
    >>> played = shots(oracle(), n=20)
    >>> bool(played.kicked.all()), bool(played.aim.abs().max() < 0.08)
    (True, True)
    """
    env, rows = make_task(goal_distance), []
    for episode in range(_checks.integer("n", n, 1)):
        rng = np.random.default_rng([_checks.integer("seed", seed), episode])
        observation, info = env.reset(seed=int(rng.integers(2**31)))
        choose, start, turns, over = policy(episode), info["orientation"], 0, False
        while not over:
            aim, action = info["orientation"], choose(observation, info)
            turns += action != KICK
            observation, _, over, _, info = env.step(action)
        success, kicked = info["is_success"], action == KICK
        row = {"start": start, "aim": aim, "turns": turns, "kicked": kicked, "is_success": success}
        rows.append(row)
    return pd.DataFrame(rows)


@dataclass(frozen=True)
class Shot:
    """One episode, look by look, as a film.

    Attributes
    ----------
    table : DataFrame
        A row a look: the true orientation (rad), seen_orientation (NaN without a sighting),
        estimated_orientation, the category, and the action taken (-1 at the end).
    frames : list of ndarray of uint8
        The field from above.
    looks : list of int
        For each frame, the last look before it.
    is_success : bool
        Whether a goal was scored.
    """

    table: pd.DataFrame
    frames: list[NDArray[np.uint8]]
    looks: list[int]
    is_success: bool


def shoot(
    agent: Arkaq,
    orientation: float = 0.35,
    goal_distance: Distance | float = "near",
    seed: int = 0,
) -> Shot:
    """Let the agent aim and kick, and film it.

    Parameters
    ----------
    agent : Arkaq
        An agent that has learned to score.
    orientation : float
        Where the goal lies at the start (rad).
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
    >>> shot = shoot(load_agent(), orientation=0.3)
    >>> shot.table.action.iloc[-2:].tolist()  # the kick, and the end
    [2, -1]
    """
    if agent.task != "goal" or agent.q is None:
        raise ValueError("agent must have learned to score a goal: see arkaq train score-goal")
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


# The best there is --------------------------------------------------------------------------------


def kick_trials(
    goal_distance: Distance | float,
    orientations: ArrayLike,
    n: int = 1000,
    seed: int = 0,
) -> pd.DataFrame:
    """Kick many times in each of a number of orientations, and count the goals.

    Parameters
    ----------
    goal_distance : {"near", "far"} or float
        Where the robot stands (mm).
    orientations : array_like
        Orientations of the goal (rad).
    n : int
        Kicks in each.
    seed : int
        The seed of the kicks. They are the same in every orientation, so that differences
        between orientations do not come from luck.

    Returns
    -------
    DataFrame
        Columns orientation, kicks, goals.

    Examples
    --------
    >>> trials = kick_trials("near", [0.0, 0.8], n=30)
    >>> trials.goals.iloc[0] > trials.goals.iloc[1]
    np.True_
    """
    if isinstance(goal_distance, str):
        goal_distance = STARTS[_known(goal_distance)].distance
    supervisor = GoalSupervisor(goal_distance)
    world, rows = World(), []
    for orientation in np.atleast_1d(np.asarray(orientations, dtype=float)).tolist():
        goals = 0
        for number in range(_checks.integer("n", n, 1)):
            world.rng = np.random.default_rng([_checks.integer("seed", seed), number])
            supervisor.place(world, orientation)
            supervisor.set_ball(world)
            world.swing_paw()
            goals += supervisor.judge(world).is_success
        rows.append({"orientation": orientation, "kicks": n, "goals": goals})
    return pd.DataFrame(rows)


def load_kick_trials(goal_distance: Distance) -> pd.DataFrame:
    """Return the trials kept with the course: 1,000 kicks in each of 25 orientations.

    Examples
    --------
    >>> int(load_kick_trials("near").kicks.sum())
    25000
    """
    trials = pd.read_csv(data_file("goal_kicks.csv"))
    chosen = trials[trials.goal_distance == _known(goal_distance)]
    return chosen.drop(columns="goal_distance").reset_index(drop=True)


@dataclass(frozen=True)
class Best:
    """The best that any policy can do that sees the goal's orientation.

    Attributes
    ----------
    orientation : ndarray
        A grid (rad).
    chance : ndarray
        The probability that a kick scores, in each orientation.
    value : ndarray
        The probability of a goal under the best policy, in each orientation, with all turns left.
    action : ndarray of int, shape (patience, n)
        What the best policy does there; row k with k + 1 turns left. With many left it is choosy:
        no turn is like the other, and the next may end straighter.
    goals : float
        Its mean over the starts of the task.
    random : float
        The same of random actions.
    """

    orientation: NDArray[np.float64]
    chance: NDArray[np.float64]
    value: NDArray[np.float64]
    action: NDArray[np.intp]
    goals: float
    random: float


def best_policy(
    goal_distance: Distance, trials: pd.DataFrame | None = None, patience: int = 30
) -> Best:
    """Work out, by dynamic programming, the best that can be done: no learning, no agent.

    The orientation is the whole state, but for how many turns are left. A kick scores with a
    probability that many kicks have measured; a turn moves the orientation by a known amount,
    give or take the footsteps' variation. Backwards from the last turn,

        V_0(o) = 0,    V_k(o) = max(p(o), E[V_{k-1}(o -+ turn)]).

    Parameters
    ----------
    goal_distance : {"near", "far"}
    trials : DataFrame, optional
        As `kick_trials` returns it; by default the course's own.
    patience : int
        Turns after which the episode ends without a kick.

    Returns
    -------
    Best

    Notes
    -----
    The chances of the course's trials are counted over 1,000 kicks, the same in every
    orientation: so they, and what follows from them, are known to about 1.5 per cent.

    References
    ----------
    Thesis eq 2.6 (value iteration over a finite horizon), 5.3.

    Examples
    --------
    >>> best = best_policy("near")
    >>> bool(best.random < best.goals <= best.chance.max())
    True
    """
    start = STARTS[_known(goal_distance)]
    trials = load_kick_trials(goal_distance) if trials is None else trials
    sensing = Sensing.goal()
    turn, spread = sensing.B[0][TURN_RIGHT], float(np.sqrt(sensing.Q[0][0]))
    grid = np.linspace(-5.0, 5.0, 2001)
    share = (trials.goals / trials.kicks).to_numpy()
    chance = np.interp(grid, trials.orientation, share, 0.0, 0.0)
    # A turn's outcome is normal; three points with weights 1/6, 2/3, 1/6 have its moments.
    nodes, weights = np.sqrt(3) * spread * np.array([-1, 0, 1]), np.array([1, 4, 1]) / 6

    def after(values: NDArray[np.float64], by: float) -> NDArray[np.float64]:
        return weights @ [np.interp(grid + by + node, grid, values) for node in nodes]

    value, by_chance = np.zeros_like(grid), np.zeros_like(grid)
    actions = []
    for _ in range(_checks.integer("patience", patience, 1)):
        choices = np.array([after(value, -turn), after(value, turn), chance])
        by_chance = (after(by_chance, -turn) + after(by_chance, turn) + chance) / 3
        # Where two do the same, kick rather than turn.
        value = choices.max(axis=0)
        actions.append(np.where(choices[KICK] >= value - 1e-12, KICK, choices.argmax(axis=0)))
    off = np.linspace(start.least, start.most, 2001)
    starts = np.concatenate([-off, off])

    def mean(values: NDArray[np.float64]) -> float:
        return float(np.interp(starts, grid, values).mean())

    return Best(grid, chance, value, np.array(actions), mean(value), mean(by_chance))


# Segmentation -------------------------------------------------------------------------------------


def record_orientations(n: int = 2000, seed: int = 0, period: int | None = None) -> pd.DataFrame:
    """Let the robot turn about at random until it has seen the goal `n` times.

    The recipe is the segmentation phase of the agent (figure 5.34): it begins straight before the
    goal, turns to the left or to the right at random, and the supervisor resets it after `period`
    turns. Turns are nearly equal, so the goal is seen in islands of orientations a turn apart.

    Parameters
    ----------
    n : int
        Number of sightings.
    seed : int
        The seed of everything drawn.
    period : int, optional
        Turns between resets; by default that of ``TrainingSettings.goal()``.

    Returns
    -------
    DataFrame
        A row a look: episode, cycle, the action that led to it (-1 at the start), orientation
        (rad) as seen, visible (0 or 1), true_orientation; angles are rounded to .000001 rad.

    References
    ----------
    Thesis 5.3.1.

    Examples
    --------
    >>> record_orientations(n=60, seed=1).visible.sum()
    np.int64(60)
    """
    _checks.integer("n", n, 1)
    env = make_look_around(period=period)
    rng = np.random.default_rng(_checks.integer("seed", seed))
    rows: list[tuple[float, ...]] = []
    seen, episode = 0, 0
    while seen < n:
        action, cycle, over = -1, 0, False
        observation, info = env.reset(seed=int(rng.integers(2**31)))
        while True:
            rows.append((episode, cycle, action, *observation.tolist(), info["orientation"]))
            seen += int(observation[1])
            cycle += 1
            if seen == n or over or not observation[1] or cycle > env.unwrapped.patience - 1:  # type: ignore[attr-defined]
                break
            action = int(rng.integers(KICK))
            observation, _, over, _, info = env.step(action)
        episode += 1
    stream = pd.DataFrame(rows, columns=_COLUMNS).round(6)
    return stream.astype({name: int for name in ("episode", "cycle", "action", "visible")})


def load_orientations() -> pd.DataFrame:
    """Return the stream recorded for the course: ``record_orientations()``, kept in ``data``.

    Examples
    --------
    >>> int(load_orientations().visible.sum())
    2000
    """
    return pd.read_csv(data_file("goal_orientations.csv"))


def patterns(stream: pd.DataFrame) -> NDArray[np.float64]:
    """Return the sightings of a stream as patterns for the network, shape (n, 1), in [-1, 1].

    Examples
    --------
    >>> patterns(load_orientations()).shape
    (2000, 1)
    """
    seen = stream[stream.visible == 1]
    return Sensing.goal().scale(seen[["orientation"]].to_numpy())


def coverage(X: ArrayLike, width: float = 0.01) -> float:
    """Return which share of the interval [-1, 1] a stream of patterns covers.

    Parameters
    ----------
    X : array_like, shape (n, 1)
        Scaled orientations.
    width : float
        A place is covered if a pattern is within half this distance.

    Returns
    -------
    float in [0, 1]

    Examples
    --------
    >>> round(coverage([[-0.5], [0.0], [0.004], [0.5]]), 3)
    0.017
    """
    X = np.sort(_checks.array("X", X, (None, 1)).ravel())
    ends = np.clip(np.column_stack([X - width / 2, X + width / 2]), -1.0, 1.0)
    new = np.maximum(ends[1:, 0], ends[:-1, 1])
    covered = (ends[0, 1] - ends[0, 0]) + (ends[1:, 1] - new).clip(0).sum()
    return float(covered / 2)


def calibrate(stream: pd.DataFrame) -> Sensing:
    """Measure, from a stream that knows the truth, what the Kalman filter should believe.

    Parameters
    ----------
    stream : DataFrame
        As `record_orientations` returns it.

    Returns
    -------
    Sensing
        `B` holds the mean effect of each turn, `Q` the variance about it, `R` that of what is
        seen inside the interval. A kick ends the episode, so its effect is never needed.

    Examples
    --------
    >>> measured, used = calibrate(load_orientations()), Sensing.goal()
    >>> bool(abs(measured.B[0][0] - used.B[0][0]) < 0.001)
    True
    """
    default, turned = Sensing.goal(), stream.cycle > 0
    moved = stream.true_orientation.diff()[turned]
    by_action = moved.groupby(stream.action[turned])
    mean = by_action.mean()
    spread = (moved - by_action.transform("mean")).var()
    seen = stream[(stream.visible == 1) & (stream.true_orientation.abs() <= default.high[0])]
    error = (seen.orientation - seen.true_orientation).var()
    return Sensing(
        default.low,
        default.high,
        A=default.A,
        H=default.H,
        Q=[[float(spread)]],
        R=[[float(error)]],
        P0=default.P0,
        B=[[float(mean[TURN_LEFT]), float(mean[TURN_RIGHT]), 0.0]],
    )


# Goals against kicks ------------------------------------------------------------------------------


def curve(scored: ArrayLike, block: int = BLOCK) -> pd.DataFrame:
    """Return goals against kicks, a row every `block` kicks; what is left over is left out.

    Parameters
    ----------
    scored : array_like of bool, shape (n,)
        Whether each kick scored, in order.
    block : int
        Kicks of a row.

    Returns
    -------
    DataFrame
        kicks so far, and goals among the last `block` of them.

    Examples
    --------
    >>> curve([True, False, True, True, False], block=2).values.tolist()
    [[2, 1], [4, 2]]
    """
    scored = np.asarray(scored, dtype=int)
    rows = len(scored) // _checks.integer("block", block, 1)
    goals = scored[: rows * block].reshape(rows, block).sum(axis=1)
    return pd.DataFrame({"kicks": block * np.arange(1, rows + 1), "goals": goals})


def scored_while_learning(agent: Arkaq) -> NDArray[np.bool_]:
    """Return, for each kick of the agent's Q-learning, whether it scored.

    Examples
    --------
    >>> scored = scored_while_learning(load_agent())
    >>> bool(scored[:100].mean() < scored[-100:].mean())
    True
    """
    return np.array([row[3] for row in agent.history if row[0] == "Q-learning"], dtype=bool)


def play(
    seed: int,
    goal_distance: Distance,
    kicks: int | None = None,
    fresh: int = FRESH,
    learning: TrainingSettings | None = None,
) -> pd.DataFrame:
    """Let everybody kick: an agent that learns, random actions, and the oracle.

    Parameters
    ----------
    seed : int
        The seed of all of it.
    goal_distance : {"near", "far"}
    kicks : int, optional
        How many kicks the agent while it learns, and random actions have; by default `KICKS`.
    fresh : int
        How many the others have.
    learning : TrainingSettings, optional
        See `train`.

    Returns
    -------
    DataFrame
        Columns goal_distance, seed, who, kicks, goals; see `curve`. "ARKAQ" is the agent while it
        learns, "ARKAQ, learned" the greedy policy it ends with, on fresh starts.

    References
    ----------
    Thesis figures 5.40 and 5.41.

    Examples
    --------
    >>> brief = TrainingSettings.goal(patterns=100, exploration=200, exploitation=0)
    >>> play(0, "near", kicks=50, fresh=50, learning=brief).who.tolist()
    ['ARKAQ', 'ARKAQ, learned', 'random actions', 'oracle']
    """
    agent = train(seed, goal_distance=goal_distance, learning=learning, progress=False)
    kicks = KICKS[goal_distance] if kicks is None else kicks
    # Starts that no training has seen: their seeds begin far above the agents'.
    new = 10_000 + seed
    scored = {
        "ARKAQ": scored_while_learning(agent)[:kicks],
        "ARKAQ, learned": shots(greedy(agent), fresh, goal_distance, new).is_success,
        "random actions": shots(at_random(seed), kicks, goal_distance, new).is_success,
        "oracle": shots(oracle(), fresh, goal_distance, new).is_success,
    }
    curves = [curve(goals).assign(who=who) for who, goals in scored.items()]
    table = pd.concat(curves, ignore_index=True)
    table.insert(0, "goal_distance", goal_distance)
    table.insert(1, "seed", seed)
    return table[["goal_distance", "seed", "who", "kicks", "goals"]]


def study(seeds: int = 30, jobs: int = -1, progress: bool = True) -> pd.DataFrame:
    """Play near and far over many seeds; see `play`.

    Parameters
    ----------
    seeds : int
        How many seeds.
    jobs : int
        Processes at once; -1 for one a core.
    progress : bool
        Whether to show a progress bar.

    Returns
    -------
    DataFrame
    """
    distances: tuple[Distance, ...] = ("near", "far")
    tasks = [
        delayed(play)(seed, distance)
        for distance in distances
        for seed in range(_checks.integer("seeds", seeds, 1))
    ]
    done = Parallel(n_jobs=jobs, return_as="generator")(tasks)
    bar = tqdm(done, total=len(tasks), desc="score a goal", unit=" runs", disable=not progress)
    return pd.concat(bar, ignore_index=True)


def load_study() -> pd.DataFrame:
    """Return the study kept with the course: ``study()`` over thirty seeds.

    Examples
    --------
    >>> sorted(load_study().who.unique())
    ['ARKAQ', 'ARKAQ, learned', 'oracle', 'random actions']
    """
    return pd.read_csv(data_file("goal_study.csv"))


def rates(table: pd.DataFrame, last: int = 200) -> pd.DataFrame:
    """Return what share of the kicks scored, in per cent, seed by seed.

    Parameters
    ----------
    table : DataFrame
        As `play` or `study` returns it.
    last : int
        How many of the last kicks count of the agent that learns, at least a row's 50; of the
        others all count.

    Returns
    -------
    DataFrame
        A row a seed; columns (goal_distance, who).

    Examples
    --------
    >>> mean = rates(load_study()).mean()
    >>> bool(mean["near", "ARKAQ"] > mean["near", "random actions"] + 20)
    True

    Far, not every run ends well.

    >>> int((rates(load_study())["far", "ARKAQ, learned"] < 28).sum())
    5
    """
    end = table.groupby(["goal_distance", "who", "seed"]).kicks.transform("max")
    last = _checks.integer("last", last, BLOCK)
    counted = table[(table.who != "ARKAQ") | (table.kicks > end - last)]
    share = 100 * counted.groupby(["seed", "goal_distance", "who"]).goals.mean() / BLOCK
    return share.unstack(["goal_distance", "who"])


def center_counts(
    seeds: Iterable[int] = range(20), vigilances: Sequence[float] = VIGILANCES, n: int = 2000
) -> pd.DataFrame:
    """Return how many centers the streams of many seeds found.

    Parameters
    ----------
    seeds : iterable of int
        Of the streams; see `record_orientations`.
    vigilances : sequence of float
    n : int
        Sightings in each stream.

    Returns
    -------
    DataFrame of int
        A row a seed, a column a vigilance.

    References
    ----------
    Thesis figures 5.35-5.37.

    Examples
    --------
    >>> center_counts([0, 1], n=100).shape
    (2, 3)
    """
    found = {
        seed: count_centers(patterns(record_orientations(n, seed)), vigilances) for seed in seeds
    }
    return pd.DataFrame(found).T.rename_axis("seed")


def load_center_counts() -> pd.DataFrame:
    """Return the counts kept with the course: ``center_counts(range(30))``.

    Examples
    --------
    >>> load_center_counts().columns.tolist()
    [0.075, 0.06, 0.05]
    """
    return pd.read_csv(data_file("goal_centers.csv"), index_col="seed").rename(columns=float)

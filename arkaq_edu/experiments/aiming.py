"""Where kicks go, and what can be made of them: the goal problem without its physics.

A kick takes the physics three milliseconds. A slider that asks for thousands of kicks at every
stop cannot wait for that, and need not: the ball's way hardly depends on where the robot stands.
So a few hundred kicks up an open field are kept, and laid before a goal at any distance and in any
orientation. What gets lost is what only the goal does to a ball: its posts, panels and back wall
throw it about, and a hard shot from near by can bounce out again.
"""

from __future__ import annotations

from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from arkaq_edu import _checks
from arkaq_edu.arkaq import Sensing, TrainingSettings
from arkaq_edu.envs.score_goal import KICK, STARTS, TURN_LEFT, TURN_RIGHT
from arkaq_edu.field import GoalSupervisor, World, pitch
from arkaq_edu.field.goal import GOAL_REWARD, MAX_GOAL_DISTANCE, MIN_GOAL_DISTANCE, MISS_REWARD
from arkaq_edu.field.supervisor import ROBOT_START
from arkaq_edu.mdp import MDP, value_iteration

Floats = NDArray[np.float64]

#: Orientations of the goal (rad) on which values are kept: so many to a turn, eight turns aside.
STEPS = 30
GRID = Sensing.goal().B[0][TURN_RIGHT] / STEPS * np.arange(-8 * STEPS, 8 * STEPS + 1)
#: Turns an episode allows.
PATIENCE = 30
_MARKS = 12  # points kept of a way
_WIDEST = 1.0  # rad; farther aside hardly a kick scores


@lru_cache(maxsize=2)
def ball_paths(n: int = 500, seed: int = 0) -> Floats:
    """Kick `n` times up an open field.

    Parameters
    ----------
    n : int
        Number of kicks.
    seed : int
        The seed of the kicks.

    Returns
    -------
    ndarray, shape (n, 12, 2)
        Points evenly spaced along each ball's way, ahead and to the left of the robot (mm).

    References
    ----------
    Thesis 5.1.3.3; `arkaq_edu.field.Kick`.

    Examples
    --------
    >>> ways = ball_paths(n=50)
    >>> bool(1800 < ways[:, -1, 0].mean() < 2800)
    True
    """
    world, ways = World(rng=_checks.integer("seed", seed)), []
    for _ in range(_checks.integer("n", n, 1)):
        world.reset(ROBOT_START, (0.0, -pitch.WIDTH / 2))
        GoalSupervisor.set_ball(world)
        way = np.array(world.swing_paw()) - ROBOT_START[:2]
        run = np.append(0.0, np.hypot(*np.diff(way, axis=0).T).cumsum())
        marks = np.linspace(0.0, run[-1], _MARKS)
        ways.append(np.column_stack([np.interp(marks, run, along) for along in way.T]))
    kicked = np.array(ways)
    kicked.flags.writeable = False  # it is kept for the next who asks
    return kicked


def spread_out(ways: Floats, factor: float) -> Floats:
    """Draw ways together about their mean (a factor below 1), or apart (above 1).

    Parameters
    ----------
    ways : ndarray, shape (n, points, 2)
    factor : float
        At least 0. With 0 every kick is the mean kick, with 1 they are as they were.

    Returns
    -------
    ndarray, shape (n, points, 2)

    Examples
    --------
    >>> bool(np.ptp(spread_out(ball_paths(50), 0.0), axis=0).max() < 1e-6)
    True
    """
    mean = ways.mean(axis=0)
    return mean + _checks.number("factor", factor, 0) * (ways - mean)


def on_the_field(ways: Floats, distance: float, orientation: ArrayLike) -> Floats:
    """Lay ways before the goal.

    Parameters
    ----------
    ways : ndarray, shape (n, points, 2)
        As `ball_paths` returns them.
    distance : float
        How far straight before the goal the robot stands (mm).
    orientation : array_like, shape (n,) or (m, 1)
        Of the goal's middle, seen from the robot (rad, left positive): of each way its own, or m
        for all of them.

    Returns
    -------
    ndarray, shape (n, points, 2) or (m, n, points, 2)
        Depth behind the goal line, and place across, to the left of the goal's middle (mm).

    Examples
    --------
    >>> ahead = np.array([[[0.0, 0.0], [2000.0, 0.0]]])
    >>> on_the_field(ahead, 1500.0, [0.5]).round(1).tolist()
    [[[-1500.0, 0.0], [255.2, -958.9]]]
    """
    heading = -np.asarray(orientation, dtype=float)[..., None]
    c, s = np.cos(heading), np.sin(heading)
    ahead, left = ways[..., 0], ways[..., 1]
    return np.stack([ahead * c - left * s - distance, ahead * s + left * c], axis=-1)


def is_goal(laid: Floats) -> NDArray[np.bool_]:
    """Return which ways cross the goal line between the posts and end behind it.

    Parameters
    ----------
    laid : ndarray, shape (..., points, 2)
        As `on_the_field` returns them.

    Returns
    -------
    ndarray of bool, shape (...)

    Examples
    --------
    >>> in_off_short = [[[-500, 0], [500, 0]], [[-500, 0], [500, 900]], [[-500, 0], [20, 0]]]
    >>> is_goal(np.array(in_off_short, dtype=float))
    array([ True, False, False])
    """
    depth, across = laid[..., 0], laid[..., 1]
    over = depth >= pitch.BALL_RADIUS
    then = over.argmax(axis=-1)[..., None]  # the first mark over the line
    before = np.maximum(then - 1, 0)
    d0, d1, y0, y1 = (
        np.take_along_axis(values, at, axis=-1)[..., 0]
        for values in (depth, across)
        for at in (before, then)
    )
    share = (pitch.BALL_RADIUS - d0) / np.where(d1 > d0, d1 - d0, 1.0)
    crossed = y0 + share * (y1 - y0)
    return over.any(axis=-1) & (np.abs(crossed) < pitch.GOAL_WIDTH / 2)


def chance(ways: Floats, distance: float, orientations: ArrayLike) -> Floats:
    """Return the share of ways that score, in each orientation of the goal.

    Parameters
    ----------
    ways : ndarray, shape (n, points, 2)
    distance : float
        Of the robot from the goal line (mm), in [800, 5000].
    orientations : array_like, shape (m,)
        Of the goal's middle (rad).

    Returns
    -------
    ndarray, shape (m,)

    See Also
    --------
    arkaq_edu.experiments.goal.kick_trials : the same, counted in the physics.

    Examples
    --------
    >>> straight, aside = chance(ball_paths(50), 1850.0, [0.0, 0.4])
    >>> bool(straight > 0.4 > 0.2 > aside)
    True
    """
    _checks.number("distance", distance, MIN_GOAL_DISTANCE, MAX_GOAL_DISTANCE)
    column = np.asarray(orientations, dtype=float)[:, None]
    return is_goal(on_the_field(ways, distance, column)).mean(axis=-1)


def chances(ways: Floats, distance: float) -> Floats:
    """Return `chance` on `GRID`, worked out at eighty places of it that are not too far aside.

    Examples
    --------
    >>> chances(ball_paths(50), 1850.0).shape
    (481,)
    """
    looked = np.linspace(-_WIDEST, _WIDEST, 81)
    return np.interp(GRID, looked, chance(ways, distance, looked), 0.0, 0.0)


def category(centers: ArrayLike, orientations: ArrayLike) -> NDArray[np.intp]:
    """Return which center is nearest to each orientation: the agent's state.

    Parameters
    ----------
    centers : array_like, shape (k, 1)
        Scaled, as the network holds them.
    orientations : array_like, shape (m,)
        In rad; outside the view the state is that of the view's edge.

    Examples
    --------
    >>> category([[-0.5], [0.5]], [-1.0, -0.1, 0.1])
    array([0, 0, 1])
    """
    seen = Sensing.goal().scale(np.asarray(orientations, dtype=float)[:, None])
    return np.abs(seen - np.ravel(centers)).argmin(axis=1)


def after_turns(values: Floats) -> Floats:
    """Return the mean of `values` after a turn to the left and after one to the right.

    A turn moves by `STEPS` places of the grid, give or take a normal error. Three points at -1, 0
    and 1 times the square root of 3 sigmas, with weights 1/6, 2/3, 1/6, have its moments; the
    outer two lie between neighbors on the grid. Beyond the grid, eight turns aside, all is lost.

    Parameters
    ----------
    values : ndarray, shape (..., 481)
        On `GRID`.

    Returns
    -------
    ndarray, shape (2, ..., 481)

    Examples
    --------
    >>> left, right = after_turns(GRID)
    >>> left[240].round(3), right[240].round(3)  # from straight ahead
    (np.float64(-0.148), np.float64(0.148))
    """
    n = len(GRID)
    aside = np.sqrt(3 * Sensing.goal().Q[0][0]) / (GRID[1] - GRID[0]) / 6
    room = np.pad(values, [(0, 0)] * (values.ndim - 1) + [(STEPS + 1, STEPS + 1)])
    mean = (1 - 2 * aside) * room[..., 1:-1] + aside * (room[..., :-2] + room[..., 2:])
    return np.array([mean[..., :n], mean[..., -n:]])


def plan(
    scores: Floats, centers: ArrayLike, learning: TrainingSettings | None = None
) -> NDArray[np.intp]:
    """Return the best action of every state: what Q-learning would come to, given all the time.

    All orientations of a state count alike. The state "kicked" earns nothing and is never left.

    Parameters
    ----------
    scores : ndarray
        The chance that a kick scores, on `GRID`.
    centers : array_like, shape (k, 1)
        The states.
    learning : TrainingSettings, optional
        Discount and cost of a cycle; by default ``TrainingSettings.goal()``.

    Returns
    -------
    ndarray of int, shape (k,)

    References
    ----------
    Thesis eq 2.8 (value iteration), 5.3.2.

    Examples
    --------
    >>> scores = chances(ball_paths(50), 1850.0)
    >>> plan(scores, [[-0.8], [-0.4], [0.0], [0.4], [0.8]]).tolist()
    [1, 1, 2, 0, 0]
    """
    learning = learning or TrainingSettings.goal()
    k = len(np.ravel(centers))
    sensing = Sensing.goal()
    view = GRID[np.abs(GRID) <= sensing.high[0] + sensing.B[0][TURN_RIGHT]]
    # The centers too: between two places of the grid may lie a whole state.
    seen = np.append(view, sensing.unscale(centers))
    inside = np.eye(k)[:, category(centers, seen)]
    inside /= inside.sum(axis=1, keepdims=True)
    T = np.zeros((3, k + 1, k + 1))
    T[:, k, k] = T[KICK, :, k] = 1.0
    for action in (TURN_LEFT, TURN_RIGHT):
        then = category(centers, seen + sensing.B[0][action])
        T[action, :k, :k] = inside @ np.eye(k)[then]
    R = np.full((k + 1, 3), learning.cycle_reward)
    earned = MISS_REWARD + scores * (GOAL_REWARD - MISS_REWARD)
    R[:k, KICK] += inside @ np.interp(seen, GRID, earned)
    R[k] = 0.0
    return value_iteration(MDP(T, R, learning.gamma), tol=1e-3)[1][:k]


class Prospects(NamedTuple):
    """The share of episodes that end with a goal, from every orientation of `GRID`.

    Attributes
    ----------
    learned : ndarray
        Of the policy that does the same in all of a state.
    best : ndarray
        Of the best policy that sees the orientation itself.
    random : ndarray
        Of actions at random.
    """

    learned: Floats
    best: Floats
    random: Floats

    def over_starts(self) -> tuple[float, float, float]:
        """Return the three means over the task's starts, uniform in [-.4, .4]."""
        starts = np.linspace(-STARTS["near"].most, STARTS["near"].most, 801)
        return tuple(float(np.interp(starts, GRID, values).mean()) for values in self)  # type: ignore[return-value]


def prospects(scores: Floats, actions: NDArray[np.intp]) -> Prospects:
    """Follow three policies to the end of an episode, all its turns backwards.

    Parameters
    ----------
    scores : ndarray
        The chance that a kick scores, on `GRID`.
    actions : ndarray of int
        What the learned policy does, on `GRID`.

    Returns
    -------
    Prospects

    Examples
    --------
    >>> scores = chances(ball_paths(50), 1850.0)
    >>> at_once = np.full(len(GRID), KICK)
    >>> learned, best, random = prospects(scores, at_once).over_starts()
    >>> bool(random < learned < best)
    True
    """
    learned, best, random = values = np.zeros((3, len(GRID)))
    for _ in range(PATIENCE):
        kick = np.broadcast_to(scores, (1, *values.shape))
        choices = np.concatenate([after_turns(values), kick])
        learned = np.take_along_axis(choices[:, 0], actions[None], axis=0)[0]
        best, random = choices[:, 1].max(axis=0), choices[:, 2].mean(axis=0)
        values = np.array([learned, best, random])
    return Prospects(learned, best, random)


def last_aims(centers: ArrayLike, actions: NDArray[np.intp], n: int, seed: int = 0) -> Floats:
    """Follow the policy from `n` starts, spread evenly, to where it kicks.

    Parameters
    ----------
    centers : array_like, shape (k, 1)
        The states.
    actions : ndarray of int, shape (k,)
        What is done in each.
    n : int
    seed : int
        Of the turns' variation.

    Returns
    -------
    ndarray, shape (at most n,)
        Orientations of the goal (rad) at the kick; who never kicks is left out.

    Examples
    --------
    >>> aims = last_aims([[-0.6], [0.0], [0.6]], np.array([TURN_RIGHT, KICK, TURN_LEFT]), n=50)
    >>> len(aims), bool(np.abs(aims).max() < 0.16)
    (50, True)
    """
    sensing, rng = Sensing.goal(), np.random.default_rng(seed)
    moved = np.array(sensing.B[0])
    aims = np.linspace(-1, 1, n) * STARTS["near"].most
    for _ in range(PATIENCE):
        action = actions[category(centers, aims)]
        varied = moved[action] + np.sqrt(sensing.Q[0][0]) * rng.standard_normal(n)
        aims = np.where(action == KICK, aims, aims + varied)
    return aims[actions[category(centers, aims)] == KICK]

"""The live robot without its page: a world that runs cycle by cycle, and tells of each as a frame.

A frame is plain JSON; live.js draws it and says what it holds. A robot is at the wheel of whoever
is chosen: an agent, a planner, chance, or an agent that is still learning.
"""

from __future__ import annotations

import base64
import copy
import math
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from functools import lru_cache, partial
from itertools import count
from threading import RLock
from typing import Any, Literal

import gymnasium
import numpy as np
from numpy.typing import NDArray

from arkaq_edu import _checks
from arkaq_edu.arkaq import (
    GOAL_Q_LEARNING,
    GOAL_SEGMENTATION,
    Q_LEARNING,
    SEGMENTATION,
    Arkaq,
    Automaton,
    Estimator,
)
from arkaq_edu.arkaq.training import FINISHED
from arkaq_edu.art.geometry import voronoi_cells
from arkaq_edu.envs import ball_approach, score_goal
from arkaq_edu.experiments import approach, goal, segmentation
from arkaq_edu.experiments.policies import Choice, Policy
from arkaq_edu.field import Kick, Legs, bird_view, pitch
from arkaq_edu.field.camera import FIELD_OF_VIEW, FOCAL_LENGTH, HEIGHT, WIDTH
from arkaq_edu.field.supervisor import MAX_BALL_DISTANCE
from arkaq_edu.field.view import EXTENT
from arkaq_edu.figures.drawing import style
from arkaq_edu.widgets.scene import Cells, Layer, Line, Panel, Picture, Points, Scene
from arkaq_edu.widgets.senses import Senses, short

#: Who can be at the wheel, before one's own agents.
TRAINED, LEARNING, PLANNER, CHANCE = DRIVERS = (
    "the trained agent", "an agent that learns", "a planner", "chance",
)  # fmt: skip

_CIRCLE = np.linspace(0, 2 * np.pi, 33)
_MOST_BLOCKS = 100  # of the curve


@dataclass(frozen=True)
class Task:
    """What differs between the two problems of the thesis."""

    title: str
    won: str
    actions: tuple[str, ...]
    automaton: Automaton
    make: Callable[[], gymnasium.Env]
    make_lessons: Callable[[], list[gymnasium.Env]]
    load_agent: Callable[[], Arkaq]
    patterns: Callable[[], NDArray[np.float64]]
    vigilance: float
    planner: Callable[[], Policy]
    at_random: Callable[[int], Policy]


TASKS = {
    "approach": Task(
        "to the ball", "reached", ball_approach.ACTIONS, Q_LEARNING,
        partial(gymnasium.make, "arkaq_edu:BallApproach-v0"), lambda: [approach.make_task()],
        approach.load_agent, segmentation.recorded_patterns, approach.VIGILANCE,
        approach.planner, approach.at_random,
    ),
    "goal": Task(
        "to score", "scored", score_goal.ACTIONS, GOAL_Q_LEARNING,
        goal.make_task, lambda: [goal.make_look_around(), goal.make_task()],
        goal.load_agent, lambda: goal.patterns(goal.load_sightings()), goal.VIGILANCE["near"],
        goal.planner, goal.at_random,
    ),
}  # fmt: skip


class Curve:
    """The mean of many numbers block by block; however many there are, it stays short.

    Examples
    --------
    >>> curve = Curve()
    >>> for value in range(1000):
    ...     curve.add(value)
    >>> len(curve.points) <= 100, curve.points[0]
    (True, [16, 7.5])
    """

    def __init__(self) -> None:
        self.points: list[list[float]] = []
        self._size, self._sum, self._n, self.total = 1, 0.0, 0, 0

    def add(self, value: float) -> None:
        """Take in the next number."""
        self._sum, self._n, self.total = self._sum + value, self._n + 1, self.total + 1
        if self._n < self._size:
            return
        self.points.append([self.total, round(self._sum / self._n, 2)])
        self._sum, self._n = 0.0, 0
        if len(self.points) == _MOST_BLOCKS:
            pairs = zip(self.points[::2], self.points[1::2], strict=True)
            self.points = [[end, (a + b) / 2] for (_, a), (end, b) in pairs]
            self._size *= 2


class Robot:
    """One robot on its field, with somebody at the wheel.

    Parameters
    ----------
    task : {"approach", "goal"}
        What it does.
    agents : mapping of str to Arkaq or Policy, optional
        One's own, by the name under which they can be chosen. A copy of an agent that has not
        finished learning goes on to learn.

    Attributes
    ----------
    drivers : tuple of str
        Who can be chosen.
    over : bool
        Whether the episode is.
    wins, episodes : int
        How many episodes were won, of those that have ended.
    agent : Arkaq
        The one whose map is shown; it is at the wheel unless a planner or chance is.

    Examples
    --------
    >>> robot = Robot()
    >>> frame = robot.step()
    >>> frame["words"]
    'cycle 1: seen at 2,387 mm, +0.20 rad, believed at 2,443 mm, +0.20 rad; state 51: left'
    >>> robot.set(driver="chance", seed=3)
    True
    >>> robot.step()["title"]
    'chance'
    """

    def __init__(
        self,
        task: Literal["approach", "goal"] = "approach",
        agents: Mapping[str, Arkaq | Policy] | None = None,
    ) -> None:
        self.task = TASKS[_checks.choice("task", task, TASKS)]
        self.name: Any = task
        self.own = dict(agents or {})
        self.drivers = (*self.own, *DRIVERS)
        self.edits = 0
        self.action: int | None = None
        self.cell: int | None = None
        self._choose: Choice | None = None
        self._filming = True
        self._lattice: tuple[Any, Any] = (None, None)
        self._shown: dict[str, Any] = {}
        self._lock = RLock()  # a notebook may answer the page while a cell runs
        self.noise, self.dropout, self.drift = 0.0, 0.0, 1.0
        self.driver, self.seed, self.vigilance = self.drivers[0], 0, self.task.vigilance
        self.restart()

    def set(
        self,
        driver: str | None = None,
        seed: int = 0,
        vigilance: float | None = None,
        noise: float = 0.0,
        dropout: float = 0.0,
        drift: float = 1.0,
    ) -> bool:
        """Choose who drives and how hard it is; with another seed, or to learn, it starts again.

        Returns whether it did.

        Parameters
        ----------
        driver : str, optional
            One of `drivers`; the first by default.
        seed : int
            Seed of the starts, of the footsteps, and of an agent that learns.
        vigilance : float, optional
            That of the map. The trained agent's values are averaged over the cells of a new map.
        noise, dropout : float
            See `Senses`.
        drift : float
            How much the legs drift, or how much kicks vary; 1 is the robot's own.
        """
        driver = self.drivers[0] if driver is None else driver
        vigilance = self.task.vigilance if vigilance is None else vigilance
        with self._lock:
            before = self.driver, self.seed, self.vigilance
            self.driver = _checks.choice("driver", driver, self.drivers)
            self.seed, self.vigilance = _checks.integer("seed", seed), vigilance
            self.noise, self.dropout, self.drift = noise, dropout, drift
            changed = before != (driver, seed, vigilance)
            learns = self._learns(before[0]) or self._learns(driver)
            again = changed and (learns or seed != before[1])
            if again:
                self.restart()
            elif changed:
                self._forget()
                self._sit()
                if not self.over:
                    self._judge()
            self._worsen()
            return again

    def restart(self) -> None:
        """Begin with the first episode."""
        self._forget()
        self._run = self._begin()
        self.advance()

    def _begin(self) -> Iterator[None]:
        return self._learn() if self._learns(self.driver) else self._play()

    def _learns(self, driver: str) -> bool:
        own = self.own.get(driver)
        return driver == LEARNING or (isinstance(own, Arkaq) and own.phase != FINISHED)

    def _forget(self) -> None:
        self.wins = self.episodes = 0
        self.curve = Curve()

    def step(self) -> dict[str, Any]:
        """Go on by one cycle, and return the frame."""
        self.advance()
        return self.frame()

    def advance(self, filming: bool = True) -> None:
        """Go on by one cycle; the motion has more than its two ends only while `filming`."""
        with self._lock:
            self._filming = filming
            try:
                next(self._run)
            except Exception:  # one's own agent failed; what it did not end begins again
                self._run = self._begin()
                raise

    def move_ball(self, x: float, y: float) -> None:
        """Put the ball somewhere else on the carpet (mm)."""
        with self._lock:
            self.senses.world.put_ball(*_on_carpet(x, y, pitch.BALL_RADIUS))
            self.edits += 1

    def move_robot(self, x: float, y: float, heading: float) -> None:
        """Push the robot to another pose (mm, mm, rad), without telling it."""
        with self._lock:
            place = _on_carpet(x, y, pitch.ROBOT_LENGTH / 2)
            self.senses.world.put_robot(*place, heading)
            self.edits += 1

    def push(self, ahead: float, turn: float) -> None:
        """Push the robot ahead (mm) and turn it to the left (rad), without telling it."""
        x, y, heading = self.pose
        c, s = math.cos(heading), math.sin(heading)
        self.move_robot(x + ahead * c, y + ahead * s, heading + turn)

    @property
    def pose(self) -> tuple[float, float, float]:
        """x, y (mm) and heading (rad) of the robot."""
        return self.senses.world.pose

    @property
    def ball(self) -> tuple[float, float]:
        """x, y (mm) of the ball."""
        return self.senses.world.ball

    # What drives it: two generators that stop after each cycle.

    def _play(self) -> Iterator[None]:
        self._sit()
        self._enter(self.task.make(), Estimator(self.agent.sensing))
        for episode in count():
            rng = np.random.default_rng([self.seed, episode])
            if self._estimator.sensing != self.agent.sensing:
                self._follow(Estimator(self.agent.sensing))
            self._estimator.reset()
            self._sit(episode)
            self.cycles, self.reward, self.over, self.phase = 0, 0.0, False, ""
            self.passed, action = ["supervisor"], None
            self._observation, self._info = self.senses.reset(seed=int(rng.integers(2**31)))
            while True:
                self.pattern = self._estimator.observe(self._observation, action)
                if self.over:
                    break
                self.passed += ["identify", "exploit"]
                self.state = "act"
                self._judge()
                yield
                self.senses.film(self._filming)
                action = self.action
                self._observation, reward, *ends, self._info = self.senses.step(action)  # type: ignore[arg-type]
                self.cycles, self.reward = self.cycles + 1, self.reward + reward
                self.over, self.passed = any(ends), ["act"]
            self._finish(bool(self._info["is_success"]))
            yield

    def _learn(self) -> Iterator[None]:
        own: Any = copy.deepcopy(self.own.get(self.driver))
        agent: Arkaq = own or Arkaq(self.vigilance, task=self.name, rng=self.seed)
        self.agent = agent
        *before, last = self.task.make_lessons()
        for env in (*before, last):
            self._enter(env, agent.estimator)
            self.passed = []
            for phase, state, _, then in agent.events(self.senses, learns=env is last):
                self.passed.append(state)
                self.over = then == "supervisor" and state != "unknown"
                if then not in ("act", "turn") and not self.over:
                    continue
                self.phase, self.state, self.pattern = phase.name, then, phase.pattern
                self._observation = phase.observation
                self.cycles, self.reward = phase.cycles, phase.reward
                self._said = f"{agent.done_in_phase:,} of {phase.total:,}{phase.unit}"
                self._choose = None
                learning = agent.q is not None
                self.cell = agent.art.category(self.pattern) if agent.art.n_clusters_ else None
                self.action = None if self.over else getattr(phase, "action", None)
                self.outcome = ""
                if self.over and learning:
                    self._finish(phase.success)
                yield
                self.senses.film(self._filming)
                self.passed = []
        self.wins = self.episodes = 0  # from here on it shows what it has learned
        yield from self._play()

    def _sit(self, episode: int = 0) -> None:
        """Put who was chosen at the wheel."""
        chosen = self.own.get(self.driver)
        if self._learns(self.driver):
            pass  # it is there already
        elif isinstance(chosen, Arkaq):
            self.agent = chosen
        else:
            self.agent = _agent(self.name, self.vigilance)
        policy: Any = None if isinstance(chosen, Arkaq) else chosen
        if self.driver == PLANNER:
            policy = self.task.planner()
        elif self.driver == CHANCE:
            policy = self.task.at_random(self.seed)
        self._choose = policy and policy(episode)

    def _follow(self, estimator: Estimator) -> None:
        self._estimator = estimator
        self.senses.follow(estimator)

    def _enter(self, env: gymnasium.Env, estimator: Estimator) -> None:
        self.senses = Senses(env)
        self._follow(estimator)
        self.senses.film(self._filming)
        self._worsen()

    def _worsen(self) -> None:
        senses, legs, kick = self.senses, Legs(), Kick()
        senses.noise, senses.dropout = self.noise, self.dropout
        senses.world.legs = Legs(legs.slide * self.drift, legs.pull * self.drift)
        senses.world.kick = Kick(
            min(12.0, kick.spread * self.drift), min(200.0, kick.swerve * self.drift)
        )

    def _judge(self) -> None:
        """Find the state, and choose."""
        self.cell = self.agent.art.category(self.pattern)
        self.outcome = ""
        if self._choose is None:
            self.action = self.agent.q.greedy(self.cell)  # type: ignore[union-attr]
        else:
            chosen = self._choose(self._observation, self._info)
            self.action = _checks.integer("action", chosen, 0, len(self.task.actions) - 1)

    def _finish(self, won: bool) -> None:
        self.cell, self.action, self.state = (
            self.agent.art.category(self.pattern),
            None,
            "supervisor",
        )
        self.episodes, self.wins = self.episodes + 1, self.wins + won
        self.curve.add(self.reward)
        if self.name == "goal":
            end = "a goal" if won else "no goal"
        elif won:
            end = "the ball is reached"
        else:
            end = "too late" if self._observation[-1] else "the ball is lost"
        times = f"{self.cycles} cycle{'s' * (self.cycles != 1)}"
        self.outcome = f"{end} after {times}: {self.reward:+.0f}".replace("-", "−")

    # What it tells.

    @property
    def title(self) -> str:
        """Who drives, and with what success."""
        if not self.episodes:
            return self.driver
        return f"{self.driver}: {self.task.won} {self.wins:,} of {self.episodes:,}"

    @property
    def words(self) -> str:
        """What happens, in one sentence."""
        part = f"{self.phase}, {self._said}; " if self.phase else ""
        if self.outcome:
            return part + self.outcome
        n, x = len(self._observation) - 1, self._estimator.kalman.x
        seen = f"seen at {_place(self._observation[:n])}" if self._observation[n] else "not seen"
        looked = "" if part else f"{seen}, "  # on a line there is no room for all
        words = f"{part}cycle {self.cycles}: {looked}believed at {_place(x[:n])}"
        if self.cell is not None:
            words += f"; state {self.cell}"
        return words if self.action is None else f"{words}: {self.task.actions[self.action]}"

    @property
    def brief(self) -> str:
        """The same in a few words."""
        chosen = "" if self.action is None else f": {self.task.actions[self.action]}"
        return self.outcome or f"cycle {self.cycles}{chosen}"

    def frame(self, whole: bool = False) -> dict[str, Any]:
        """Return the present as plain JSON, as live.js draws it.

        What seldom changes is left out where the last frame had the same, unless it is `whole`.
        """
        with self._lock:
            x, P = (
                part[: self._m] for part in (self._estimator.kalman.x, self._estimator.kalman.P)
            )
            world, seen = self.senses.world, self._observation
            frame = {
                "edits": self.edits,
                "title": self.title, "words": self.words, "brief": self.brief,
                "outcome": self.outcome,
                "over": self.over, "motion": self.senses.motion,
                "eye": _runs(self.senses.camera.colors(world)),
                "mark": self._mark(seen[:-1]) if seen[-1] else None,
                "seen": _on_map(seen[:-1]) if seen[-1] else None,
                "estimate": _on_map(x), "belief": _belief(x, P[:, : self._m]),
                "ghost": _ghost(world.pose, x, P[:, : self._m]),
                "cell": self._cell(), "values": self._values(), "action": self.action,
                "automaton": self._states(), "state": self.state, "passed": self.passed,
            }  # fmt: skip
            rare = {
                "map": (self.agent, self._n_cells(), self._moving()),
                "best": self._best(),
                "curve": (self.curve, self.curve.total),
            }
            make = {"map": self._map, "best": self._best, "curve": lambda: [*self.curve.points]}
            for name, key in rare.items():
                if whole or self._shown.get(name) != key:
                    self._shown[name], frame[name] = key, make[name]()
            return frame

    def glance(self) -> dict[str, Any]:
        """Return what the camera sees right now, and where everything is: after a push by hand."""
        camera, world = self.senses.camera, self.senses.world
        look = camera.goal(world) if self.name == "goal" else camera.sighting(world)
        z = look and np.array([look.orientation] if self.name == "goal" else look[:2])
        return {
            "eye": _runs(camera.colors(world)),
            "mark": None if z is None else self._mark(z),
            "row": self.senses.row(0.0),
            "edits": self.edits,
        }

    @property
    def _m(self) -> int:
        return len(self._observation) - 1

    def _n_cells(self) -> int:
        return int(getattr(self.agent.art, "n_clusters_", 0))

    def _moving(self) -> int:
        """Return a number that changes whenever the centers move."""
        return self.agent.done_in_phase if self.agent.q is None else -1

    def _mark(self, z: NDArray[np.floating]) -> list[float]:
        """Return where a sighting shows in the picture: a ball's ring, or a goal's middle."""
        camera, world = self.senses.camera, self.senses.world
        if self.name == "goal":
            return short(camera.pixel(world, 3000.0, float(z[0]), camera.height))
        col, row = camera.pixel(world, float(z[0]), float(z[1]), pitch.BALL_RADIUS)
        return short((col, row, abs(FOCAL_LENGTH * pitch.BALL_RADIUS / z[0]) + 3))

    def _centers(self) -> tuple[NDArray[np.float64], list[int]]:
        """Return the centers of the map's cells, and their categories."""
        art = self.agent.art
        if hasattr(art, "cluster_centers_"):
            return art.cluster_centers_, list(range(art.n_clusters_))
        if self._lattice[0] is not art:
            self._lattice = art, _sampled(art, self._m)
        return self._lattice[1]

    def _cell(self) -> int | None:
        categories = self._centers()[1]
        return categories.index(self.cell) if self.cell in categories else None

    def _values(self) -> list[float] | None:
        if self.agent.q is None or self.cell is None:
            return None
        return short(self.agent.q.Q[self.cell], 2)

    def _best(self) -> list[int]:
        """Return the best action in each cell of the map."""
        if self.agent.q is None:
            return []
        return self.agent.q.Q[self._centers()[1]].argmax(axis=1).tolist()

    def _map(self) -> list[list[float]]:
        """Return the cells: the corners of each, x and y in turn."""
        centers = self._centers()[0]
        if self.name == "goal":
            place = self.agent.sensing.unscale(centers).ravel()
            order = np.argsort(-place)
            between = (place[order][1:] + place[order][:-1]) / 2
            borders = [0.5, *between.tolist(), -0.5]
            strips: list[list[float]] = [[]] * len(centers)
            for k, i in enumerate(order):
                left, right = borders[k : k + 2]
                strips[i] = [left, 0, right, 0, right, 1, left, 1]
            return [short(strip, 4) for strip in strips]
        polygons = voronoi_cells(centers)[0]
        corners = _in_view(self.agent.sensing.unscale(np.concatenate(polygons)))
        ends = np.cumsum([len(polygon) for polygon in polygons])[:-1]
        return [part.ravel().tolist() for part in np.split(corners, ends)]

    def _states(self) -> tuple[str, ...]:
        """Return the states of the automaton that runs."""
        if self.phase == "segmentation":
            return GOAL_SEGMENTATION.states if self.name == "goal" else SEGMENTATION.states
        return self.task.automaton.states

    def stage(self) -> dict[str, Any]:
        """Return what stays the same for all frames, as plain JSON; see live.js."""
        near = self.name == "approach"
        names = ("forward", "left", "right") if near else ("left", "right", "kick")
        return {
            "actions": list(self.task.actions),
            "colors": [style.ACTIONS[name] for name in names],
            "pale": [style.paler(style.ACTIONS[name], 0.62) for name in names],
            "ours": style.OURS, "unknown": style.CELLS[1],
            "palette": [f"rgb({r}, {g}, {b})" for r, g, b in pitch.PALETTE.tolist()],
            "picture": [WIDTH, HEIGHT], "sight": FIELD_OF_VIEW, "reach": MAX_BALL_DISTANCE,
            "extent": EXTENT, "ball": pitch.BALL_RADIUS,
            "robot": [pitch.ROBOT_LENGTH, pitch.ROBOT_WIDTH],
            "lines": pitch.lines(), "circle": pitch.CIRCLE_RADIUS, "line": pitch.LINE_WIDTH,
            "walls": [row for row in pitch.panels().tolist() if row[4] == pitch.GOAL_HEIGHT],
            "posts": pitch.posts().tolist(), "moves": ["ball", "robot"] if near else ["robot"],
            "axes": {
                "xlabel": f"{'ball' if near else 'goal'} to the left  |  to the right (rad)",
                "ylabel": "distance (mm)" if near else "",
                "xlim": style.VIEW_ORIENTATION, "ylim": style.VIEW_DISTANCE if near else (0, 1.05),
                "xticks": [[x, style.tick_label(x)] for x in (0.4, 0.2, 0, -0.2, -0.4)],
                "yticks": [[y, style.tick_label(y)] for y in range(0, 4001, 1000)] if near else [],
                "log": "",
            },
        }  # fmt: skip

    def still(self) -> Scene:
        """Return the present as a picture: the field, the camera's picture, and the map."""
        world, camera, map_ = self.senses.world, self.senses.camera, self._map()
        x, P = self._estimator.kalman.x[: self._m], self._estimator.kalman.P
        ghost = np.array(_ghost(world.pose, x, P[: self._m, : self._m]))
        belief = np.array(_belief(x, P[: self._m, : self._m]))
        above: list[Layer] = [
            Picture(bird_view(world, 640), EXTENT),
            Line(ghost[:, 0], ghost[:, 1], "white", 1.5),
        ]
        eye: list[Layer] = [Picture(camera.picture(world), (0, WIDTH, 0, HEIGHT), smooth=False)]
        axes, palette = self.stage()["axes"], self.stage()["pale"]
        cells = [np.reshape(corners, (-1, 2)) for corners in map_]
        low, high = (0.0, 1.0) if self.name == "goal" else segmentation.DISTANCE
        across, up = _on_map(x)
        view: list[Layer] = [
            Cells(cells, self._best() or [0] * len(cells), (0.5, -0.5, low, high), palette),
            Line(belief[:, 0], belief[:, 1], style.OURS, 1.5),
            Points([across], [up], 4.5, style.OURS),
        ]
        if (cell := self._cell()) is not None:
            view.insert(1, Line.around(cells[cell], style.INK, 2.0))
        return Scene(
            self.words,
            [
                Panel("", "", EXTENT[:2], EXTENT[2:], above, width=1.6, bare=True),
                Panel("", "", (0.0, WIDTH), (0.0, HEIGHT), eye, width=0.8, bare=True),
                Panel(
                    axes["xlabel"], axes["ylabel"], axes["xlim"], axes["ylim"], view, width=1.5,
                    yticks=None if axes["yticks"] else [],
                ),
            ],
        )  # fmt: skip


@lru_cache(2)
def _trained(task: str) -> Arkaq:
    return TASKS[task].load_agent()


@lru_cache(32)
def _agent(task: str, vigilance: float) -> Arkaq:
    """Return the trained agent, with a map of another vigilance if it is another one."""
    trained = _trained(task)
    if vigilance == trained.vigilance:
        return trained
    return regrouped(trained, TASKS[task].patterns(), vigilance)


def regrouped(agent: Arkaq, patterns: NDArray[np.float64], vigilance: float) -> Arkaq:
    """Return an agent with another map: each state is worth what the agent thinks of its patterns.

    Parameters
    ----------
    agent : Arkaq
        An agent that has learned.
    patterns : ndarray, shape (n, m)
        Scaled patterns, in the order in which the new map learns them.
    vigilance : float
        That of the new map.

    Examples
    --------
    >>> from arkaq_edu.experiments import approach, segmentation
    >>> coarse = regrouped(approach.load_agent(), segmentation.recorded_patterns(), 0.5)
    >>> coarse.q.Q.shape
    (62, 3)
    """
    task: Any = agent.task
    coarse = Arkaq(vigilance, task=task, sensing=agent.sensing, learning=agent.learning, rng=0)
    coarse.art.fit(patterns)
    # The centers too: so no state is without a pattern.
    known = np.vstack([patterns, coarse.art.cluster_centers_])
    states, values = coarse.art.predict(known), agent.q.Q[agent.art.predict(known)]  # type: ignore[union-attr]
    table: Any = coarse.new_learner(values.shape[1])
    np.add.at(table.Q, states, values)
    table.Q[:] /= np.bincount(states)[:, None]
    return coarse


def _sampled(segmenter: Any, m: int) -> tuple[NDArray[np.float64], list[int]]:
    """Return a center of each category of a segmenter that has none: the middle of its patterns."""
    ticks = np.linspace(-1, 1, 62)[1:-1]
    lattice = np.stack(np.meshgrid(*[ticks] * m), axis=-1).reshape(-1, m)
    found = np.array([segmenter.category(pattern) for pattern in lattice])
    categories = np.unique(found).tolist()
    return np.array([lattice[found == each].mean(axis=0) for each in categories]), categories


def _belief(x: NDArray[np.float64], P: NDArray[np.float64]) -> list[list[float]]:
    """Return what the filter believes, as a line on the map: two sigma around, or a bell."""
    if len(x) == 1:
        at = x[0] + math.sqrt(P[0, 0]) * np.linspace(-4, 4, 41)
        bell = np.exp(-((at - x[0]) ** 2) / (2 * P[0, 0]))
        return np.column_stack([at, bell]).round(4).tolist()
    return _in_view(_around(x, P)).tolist()


def _in_view(z: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return distance and orientation as points of the map: orientation and distance."""
    return np.column_stack([z[:, 1].round(4), z[:, 0].round()])


def _around(x: NDArray[np.float64], P: NDArray[np.float64]) -> NDArray[np.float64]:
    circle = np.stack([np.cos(_CIRCLE), np.sin(_CIRCLE)])
    return x + 2 * (np.linalg.cholesky(P) @ circle).T


def _ghost(
    pose: tuple[float, float, float], x: NDArray[np.float64], P: NDArray[np.float64]
) -> list[list[float]]:
    """Return the same on the field (mm): an ellipse, or a ray that is two sigma wide."""
    if len(x) == 1:
        angle = x[0] + 2 * math.sqrt(P[0, 0]) * np.array([0, -1, 1, 0])
        distance = np.array([0.0, MAX_BALL_DISTANCE, MAX_BALL_DISTANCE, 0.0])
    else:
        distance, angle = _around(x, P).T
    angle = angle + pose[2]
    place = np.array(pose[:2]) + np.column_stack(
        [distance * np.cos(angle), distance * np.sin(angle)]
    )
    return place.round().tolist()


def _on_map(z: NDArray[np.floating]) -> list[float]:
    """Return where a measurement lies on the map."""
    return short((z[0], 0.5) if len(z) == 1 else (z[1], z[0]), 4)


def _on_carpet(x: float, y: float, margin: float) -> tuple[float, float]:
    across, up = EXTENT[1] - margin, EXTENT[3] - margin
    return min(across, max(-across, float(x))), min(up, max(-up, float(y)))


def _place(z: NDArray[np.floating]) -> str:
    words = f"{z[-1]:+.2f} rad".replace("-", "−")
    return words if len(z) == 1 else f"{z[0]:,.0f} mm, {words}"


def _runs(colors: NDArray[np.uint8]) -> str:
    """Return a picture as runs of one color: color and length, uint16 each, as base64."""
    flat = colors.ravel()
    starts = np.concatenate([[0], np.flatnonzero(np.diff(flat)) + 1])
    lengths = np.diff(np.append(starts, flat.size))
    return base64.b64encode(
        np.column_stack([flat[starts], lengths]).astype("<u2").tobytes()
    ).decode()

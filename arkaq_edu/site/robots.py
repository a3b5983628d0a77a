"""The live robot without a kernel: recorded walks and kicks, which the page plays.

A take is what a driver does from a seed on, frame by frame; live.js draws its frames as it draws
those that a kernel sends.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from arkaq_edu.site.packing import to_bytes
from arkaq_edu.widgets.robot import CHANCE, LEARNING, PLANNER, TRAINED, Robot

SEEDS, EPISODES = range(8), 2
VIGILANCES = (0.05, 0.1, 0.15, 0.2, 0.4)
#: Cycles between two frames of a robot that learns, and the most frames of it.
_STRIDE, _MOST = 250, 400
_HELP = (
    "These episodes were recorded. On the picture, Space plays, and the period goes one step. In "
    "the notebook you also drag the ball, push the robot, and make its senses and legs worse."
)

Frame = dict[str, Any]


@dataclass(frozen=True)
class Recording:
    """What is recorded of a robot: a take for each combination of driver, seed and vigilance."""

    task: Any
    drivers: tuple[str, ...] = (TRAINED, PLANNER, CHANCE)
    seeds: range = SEEDS
    vigilances: tuple[float, ...] = ()


#: The recordings by the name of their file.
RECORDINGS = {
    "robot-approach": Recording("approach"),
    "robot-goal": Recording("goal"),
    "robot-learns": Recording("approach", (LEARNING,), range(1)),
    "robot-vigilance": Recording("approach", (TRAINED,), range(4), VIGILANCES),
}

#: Which cells show which recording: the beginning of the last line of the cell.
_CALLS = {
    r"live_robot\(.*learns": "robot-learns",
    r"(live_robot|race)\(\"goal\"": "robot-goal",
    r"(live_robot|race)\(": "robot-approach",
    r"vigilance_robot\(": "robot-vigilance",
}


def recording_of(call: str) -> str:
    """Return the name of the recording that a cell shows, or an empty text.

    Examples
    --------
    >>> recording_of('race("goal")'), recording_of("belief_explorer()")
    ('robot-goal', '')
    """
    return next((name for begin, name in _CALLS.items() if re.match(begin, call)), "")


def take(robot: Robot, episodes: int = EPISODES) -> list[Frame]:
    """Return the frames of a robot's next episodes, from where it stands.

    Examples
    --------
    >>> frames = take(Robot("goal"), 1)
    >>> frames[0]["over"], frames[-1]["over"], len(frames[0]["motion"])
    (False, True, 1)
    """
    frames, end = [robot.frame(whole=True)], robot.episodes + episodes
    while robot.episodes < end:
        frames.append(robot.step())
    return frames


def lesson(robot: Robot) -> list[Frame]:
    """Return frames of a robot that learns, far from each other, until it has learned."""
    frames = [robot.frame(whole=True)]
    while robot.phase and len(frames) < _MOST:
        for _ in range(_STRIDE):
            robot.advance(filming=False)
        frames.append(robot.frame())
    return frames


def recorded(recording: Recording) -> bytes:
    """Return a recording as a page takes it."""
    takes: dict[str, list[Frame]] = {}
    maps: list[Any] = []
    robot = Robot(recording.task)
    stage = robot.stage() | {"moves": []}
    for i, driver in enumerate(recording.drivers):
        record: Callable[[Robot], list[Frame]] = lesson if driver == LEARNING else take
        for j, seed in enumerate(recording.seeds):
            for k, vigilance in enumerate(recording.vigilances or (robot.task.vigilance,)):
                robot.set(driver=driver, seed=seed, vigilance=vigilance)
                robot.restart()
                takes[f"{i},{j},{k}"] = [_shared(frame, maps) for frame in record(robot)]
    texts = {
        "driver": list(recording.drivers),
        "seed": [str(seed) for seed in recording.seeds],
        "vigilance": [f"{vigilance:g}" for vigilance in recording.vigilances],
    }
    return to_bytes(
        {"robot": True, "stage": stage, "help": _HELP, "texts": texts, "maps": maps, "takes": takes}
    )


def _shared(frame: Frame, maps: list[Any]) -> Frame:
    """Return a frame that names its map, which many frames share, by number."""
    if "map" in frame:
        if frame["map"] not in maps:
            maps.append(frame["map"])
        frame["map"] = maps.index(frame["map"])
    return frame

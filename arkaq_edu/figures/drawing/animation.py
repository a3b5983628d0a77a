"""The robot at work, as a moving picture: GIF, web page, or in a notebook."""

from __future__ import annotations

import os
import re
import tempfile
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.animation import FuncAnimation, PillowWriter
from matplotlib.figure import Figure

from arkaq_edu.envs.ball_approach import ACTIONS
from arkaq_edu.envs.score_goal import ACTIONS as GOAL_ACTIONS
from arkaq_edu.experiments import Walk
from arkaq_edu.experiments.goal import Shot
from arkaq_edu.field import Camera, World, bird_view
from arkaq_edu.field.view import EXTENT
from arkaq_edu.figures.drawing import style
from arkaq_edu.figures.trajectories import how_it_went

FRAMES_PER_SECOND = 5
_DPI = 80
# Signs for the buttons that every font has.
_SIGNS = {
    "minus": "−", "fast-backward": "|◀", "step-backward": "◁", "play": "▶", "pause": "||",
    "step-forward": "▷", "fast-forward": "▶|", "plus": "+",
}  # fmt: skip


def animate_walk(walk: Walk) -> FuncAnimation:
    """Show a walk look by look: the field from above, beside what the camera sees.

    On the field a ring is where the ball was seen, a cross where it was believed to be.

    Parameters
    ----------
    walk : Walk
        As `arkaq_edu.experiments.walk` returns it.

    Returns
    -------
    matplotlib.animation.FuncAnimation
        A frame a look; ``to_jshtml()`` and ``save(path)`` render it.

    Examples
    --------
    >>> from arkaq_edu.figures.trajectories import trajectory
    >>> page = animate_walk(trajectory(1)).to_jshtml()
    >>> page.count("data:image/png") == len(trajectory(1).table)
    True
    """
    figure = Figure(figsize=(7.0, 3.4), dpi=_DPI)
    sides = {"left": 0.01, "right": 0.99, "bottom": 0.15, "top": 0.84, "wspace": 0.03}
    field, eye = figure.subplots(1, 2, width_ratios=(1.5, 1.3), gridspec_kw=sides)
    for ax, title in ((field, "from above"), (eye, "what the camera sees")):
        style.axes(ax, title=title).axis("off")
    figure.text(0.01, 0.97, how_it_went(walk), va="top", color=style.INK)
    caption = figure.text(0.01, 0.02, "", va="bottom", color=style.INK)
    world, camera = World(rng=0), Camera()
    above = field.imshow(bird_view(world), extent=EXTENT)
    seen_from = eye.imshow(camera.picture(world))
    (sighting,) = field.plot([], [], "o", color="white", markerfacecolor="none", markersize=9)
    (estimate,) = field.plot([], [], "+", color=style.OURS, markersize=6)

    def show(frame: int) -> None:
        look = walk.table.iloc[frame]
        world.reset((look.x, look.y, look.heading), (look.ball_x, look.ball_y))
        trail = walk.table[["x", "y"]].iloc[: frame + 1].to_numpy().tolist()
        above.set_data(bird_view(world, width=480, trail=trail))
        seen_from.set_data(camera.picture(world))
        sighting.set_data(*_on_field(look, look.seen_distance, look.seen_orientation))
        estimate.set_data(*_on_field(look, look.estimated_distance, look.estimated_orientation))
        caption.set_text(caption_at(walk, frame))

    pause = 1000 // FRAMES_PER_SECOND
    return FuncAnimation(figure, show, frames=len(walk.table), interval=pause, blit=False)


def caption_at(walk: Walk, look: int) -> str:
    """Say what the robot saw at a look, what it believed, and what it did then.

    Parameters
    ----------
    walk : Walk
        The walk.
    look : int
        From 0.

    Returns
    -------
    str
        Two lines.

    Examples
    --------
    >>> from arkaq_edu.figures.trajectories import trajectory
    >>> print(caption_at(trajectory(1), 0))  # doctest: +ELLIPSIS
    seen ... mm, ... rad; estimate ... mm, ... rad
    cycle 0: state ..., so ...
    """
    row = walk.table.iloc[look]
    seen = "nothing seen"
    if not np.isnan(row.seen_distance):
        seen = f"seen {row.seen_distance:5,.0f} mm, {row.seen_orientation:+.2f} rad"
    believed = f"estimate {row.estimated_distance:5,.0f} mm, {row.estimated_orientation:+.2f} rad"
    then = f"state {row.category:.0f}, so {ACTIONS[int(row.action)]}"
    if row.action < 0:
        then = f"reached, +{walk.reward:g}" if walk.is_success else "the ball is lost"
    return f"{seen}; {believed}\ncycle {look}: {then}"


def save_walk(walk: Walk, path: str | os.PathLike[str]) -> None:
    """Write the moving picture of a walk to a file, which needs no network to be seen.

    Parameters
    ----------
    walk : Walk
        The walk.
    path : path
        Ends in ".gif" (a picture) or ".html" (a page with buttons and a slider); it is replaced.

    Raises
    ------
    ValueError
        If it ends otherwise.

    Examples
    --------
    >>> from arkaq_edu.figures.trajectories import trajectory
    >>> save_walk(trajectory(1), "walk.avi")
    Traceback (most recent call last):
    ValueError: path must end in .gif or .html, got 'walk.avi'
    """
    _save(walk, path, animate_walk, how_it_went)


def animate_shot(shot: Shot) -> FuncAnimation:
    """Show how the robot aims and kicks, from above, on the goal's half of the field.

    Parameters
    ----------
    shot : Shot
        As `arkaq_edu.experiments.goal.shoot` returns it.

    Returns
    -------
    matplotlib.animation.FuncAnimation
        ``to_jshtml()`` and ``save(path)`` render it.

    Examples
    --------
    >>> from arkaq_edu.experiments import goal
    >>> shot = goal.shoot(goal.load_agent(), orientation=0.1)
    >>> page = animate_shot(shot).to_jshtml()
    >>> page.count("data:image/png") == len(shot.frames)
    True
    """
    figure = Figure(figsize=(4.4, 6.4), dpi=_DPI)
    ax = style.axes(figure.add_axes((0.01, 0.05, 0.98, 0.9)))
    ax.axis("off")
    figure.text(0.01, 0.99, how_the_shot_went(shot), va="top", color=style.INK)
    caption = figure.text(0.01, 0.01, "", va="bottom", color=style.INK)
    above = ax.imshow(shot.frames[0], extent=EXTENT)
    ax.set_xlim(0, EXTENT[1])  # the goal's half of the field: nobody plays in the other

    def show(frame: int) -> None:
        above.set_data(shot.frames[frame])
        row = shot.table.iloc[shot.looks[frame]]
        then = GOAL_ACTIONS[int(row.action)] if row.action >= 0 else "the end"
        caption.set_text(
            f"estimate {row.estimated_orientation:+.2f} rad, state {row.category:.0f}: {then}"
        )

    pause = 1000 // FRAMES_PER_SECOND
    return FuncAnimation(figure, show, frames=len(shot.frames), interval=pause, blit=False)


def how_the_shot_went(shot: Shot) -> str:
    """Say from where the robot aimed, and what came of it.

    Examples
    --------
    >>> from arkaq_edu.experiments import goal
    >>> how_the_shot_went(goal.shoot(goal.load_agent(), 0.1)).split(",")[0]
    'the goal 0.10 rad left'
    >>> how_the_shot_went(goal.shoot(goal.load_agent(), 0.0)).split(",")[0]
    'the goal straight ahead'
    """
    start, turns = shot.table.orientation.iloc[0], int((shot.table.action.isin((0, 1))).sum())
    aside = f"{abs(start):.2f} rad {'left' if start > 0 else 'right'}"
    where = "straight ahead" if round(start, 2) == 0 else aside
    end = "a goal" if shot.is_success else "a miss"
    return f"the goal {where}, {turns} turn{'s' * (turns != 1)}: {end}"


def save_shot(shot: Shot, path: str | os.PathLike[str]) -> None:
    """Write the film of a shot to a file, as `save_walk` does.

    Parameters
    ----------
    shot : Shot
        The shot.
    path : path
        Ends in ".gif" or ".html"; it is replaced.

    Raises
    ------
    ValueError
        If it ends otherwise.
    """
    _save(shot, path, animate_shot, how_the_shot_went)


def _save(
    what: Any,
    path: str | os.PathLike[str],
    animate: Callable[[Any], FuncAnimation],
    said: Callable[[Any], str],
) -> None:
    ending = Path(path).suffix.lower()
    if ending == ".gif":
        animate(what).save(Path(path), PillowWriter(FRAMES_PER_SECOND), dpi=_DPI)
    elif ending == ".html":
        Path(path).write_text(_page(animate(what), said(what)), encoding="utf-8")
    else:
        raise ValueError(f"path must end in .gif or .html, got {os.fspath(path)!r}")


@dataclass(frozen=True)
class MovingWalk:
    """A walk that moves in a notebook, and in a stored one without a kernel too.

    Parameters
    ----------
    walk : Walk
        The walk.

    Examples
    --------
    >>> from arkaq_edu.figures.trajectories import trajectory
    >>> MovingWalk(trajectory(1))  # doctest: +ELLIPSIS
    from 1,200 mm, straight ahead: ...
    """

    walk: Walk

    def __repr__(self) -> str:
        """Return how the walk went."""
        return how_it_went(self.walk)

    def _repr_png_(self) -> bytes:
        """Return a PNG of many frames, which browsers play."""
        return _png(animate_walk(self.walk))


@dataclass(frozen=True)
class MovingShot:
    """A shot that moves in a notebook, and in a stored one without a kernel too.

    Parameters
    ----------
    shot : Shot
        The shot.

    Examples
    --------
    >>> from arkaq_edu.experiments import goal
    >>> MovingShot(goal.shoot(goal.load_agent(), orientation=-0.3))
    the goal 0.30 rad right, 1 turn: a goal
    """

    shot: Shot

    def __repr__(self) -> str:
        """Return how the shot went."""
        return how_the_shot_went(self.shot)

    def _repr_png_(self) -> bytes:
        """Return a PNG of many frames, which browsers play."""
        return _png(animate_shot(self.shot))


def _png(animation: FuncAnimation) -> bytes:
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "frames.png"
        animation.save(path, PillowWriter(FRAMES_PER_SECOND), dpi=_DPI)
        return path.read_bytes()


def _on_field(look, distance: float, orientation: float) -> tuple[list[float], list[float]]:
    angle = look.heading + orientation
    return [look.x + distance * np.cos(angle)], [look.y + distance * np.sin(angle)]


def _page(animation: FuncAnimation, title: str) -> str:
    """Return matplotlib's page, but the same in every run, and with signs that need no network."""
    page = animation.to_jshtml(FRAMES_PER_SECOND, embed_frames=True)
    page = re.sub(r"<link[^>]*font-awesome[^>]*>", "", page)
    page = re.sub(r"(anim|_anim_\w*?)[0-9a-f]{32}", r"\1_walk", page)
    signs = "".join(f'.fa-{name}::before {{content: "{sign}"}}\n' for name, sign in _SIGNS.items())
    flip = ".fa-flip-horizontal {display: inline-block; transform: scaleX(-1)}\n"
    head = f'<!doctype html>\n<meta charset="utf-8">\n<title>{title}</title>\n'
    return f"{head}<style>\n.fa {{font-style: normal}}\n{signs}{flip}</style>\n{page}"

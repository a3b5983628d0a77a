"""The robot at work, as a film: a GIF, a web page, or in a notebook."""

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
from numpy.typing import NDArray
from PIL import Image, ImageSequence

from arkaq_edu._files import replacing
from arkaq_edu.envs.ball_approach import ACTIONS
from arkaq_edu.envs.score_goal import ACTIONS as GOAL_ACTIONS
from arkaq_edu.experiments.approach.evaluation import Trajectory
from arkaq_edu.experiments.goal.evaluation import Shot
from arkaq_edu.field import Camera, World, bird_view
from arkaq_edu.field.view import EXTENT
from arkaq_edu.figures.drawing import style

FRAMES_PER_SECOND = 5
_DPI = 80
# Signs for the buttons that every font has.
_SIGNS = {
    "minus": "−", "fast-backward": "|◀", "step-backward": "◁", "play": "▶", "pause": "||",
    "step-forward": "▷", "fast-forward": "▶|", "plus": "+",
}  # fmt: skip


def animate(episode: Trajectory | Shot) -> FuncAnimation:
    """Show an episode as a film.

    Parameters
    ----------
    episode : Trajectory or Shot
        See `record_episode` of `arkaq_edu.experiments.approach` and of
        `arkaq_edu.experiments.goal`. A trajectory has a frame a look: the field from above, beside
        what the camera sees. On the field a ring marks where the ball was seen, a cross where it
        was believed to be. A shot shows the goal's half of the field from above.

    Returns
    -------
    matplotlib.animation.FuncAnimation
        ``to_jshtml()`` and ``save(path)`` render it.

    Examples
    --------
    >>> from arkaq_edu.experiments import approach, goal
    >>> walked = approach.trajectory(1)
    >>> animate(walked).to_jshtml().count("data:image/png") == len(walked.table)
    True
    >>> shot = goal.record_episode(goal.load_agent(), orientation=0.1)
    >>> animate(shot).to_jshtml().count("data:image/png") == len(shot.frames)
    True
    """
    return _animate_shot(episode) if isinstance(episode, Shot) else _animate_walk(episode)


def _film(
    figure: Figure, summary: str, ends: tuple[float, float], n: int, draw: Callable[[int], str]
) -> FuncAnimation:
    """Return a film of n frames; `draw` changes the picture and returns what is written below."""
    figure.text(0.01, ends[1], summary, va="top", color=style.INK)
    caption = figure.text(0.01, ends[0], "", va="bottom", color=style.INK)
    pause = 1000 // FRAMES_PER_SECOND

    def show(frame: int) -> None:
        caption.set_text(draw(frame))

    return FuncAnimation(figure, show, frames=n, interval=pause, blit=False)


def _animate_walk(walked: Trajectory) -> FuncAnimation:
    figure = Figure(figsize=(7.0, 3.4), dpi=_DPI)
    sides = {"left": 0.01, "right": 0.99, "bottom": 0.15, "top": 0.84, "wspace": 0.03}
    field, eye = figure.subplots(1, 2, width_ratios=(1.5, 1.3), gridspec_kw=sides)
    for ax, title in ((field, "from above"), (eye, "what the camera sees")):
        style.axes(ax, title=title).axis("off")
    world, camera = World(rng=0), Camera()
    above = field.imshow(bird_view(world), extent=EXTENT)
    seen_from = eye.imshow(camera.picture(world))
    (sighting,) = field.plot([], [], "o", color="white", markerfacecolor="none", markersize=9)
    (estimate,) = field.plot([], [], "+", color=style.OURS, markersize=6)

    def draw(frame: int) -> str:
        look = walked.table.iloc[frame]
        world.reset((look.x, look.y, look.heading), (look.ball_x, look.ball_y))
        trail = walked.table[["x", "y"]].iloc[: frame + 1].to_numpy().tolist()
        above.set_data(bird_view(world, width=480, trail=trail))
        seen_from.set_data(camera.picture(world))
        sighting.set_data(*_on_field(look, look.seen_distance, look.seen_orientation))
        estimate.set_data(*_on_field(look, look.estimated_distance, look.estimated_orientation))
        return caption_at(walked, frame)

    return _film(figure, walked.summary, (0.02, 0.97), len(walked.table), draw)


def caption_at(walked: Trajectory, look: int) -> str:
    """Say in two lines what the robot saw at a look, what it believed, and what it did then.

    Examples
    --------
    >>> from arkaq_edu.experiments import approach
    >>> print(caption_at(approach.trajectory(1), 0))  # doctest: +ELLIPSIS
    seen ... mm, ... rad; estimate ... mm, ... rad
    cycle 0: state ..., so ...
    """
    row = walked.table.iloc[look]
    seen = "nothing seen"
    if not np.isnan(row.seen_distance):
        seen = f"seen {row.seen_distance:5,.0f} mm, {row.seen_orientation:+.2f} rad"
    believed = f"estimate {row.estimated_distance:5,.0f} mm, {row.estimated_orientation:+.2f} rad"
    then = f"state {row.category:.0f}, so {ACTIONS[int(row.action)]}"
    if row.action < 0:
        then = f"reached, +{walked.reward:g}" if walked.is_success else "the ball is lost"
    return f"{seen}; {believed}\ncycle {look}: {then}"


def _on_field(look, distance: float, orientation: float) -> tuple[list[float], list[float]]:
    angle = look.heading + orientation
    return [look.x + distance * np.cos(angle)], [look.y + distance * np.sin(angle)]


def _animate_shot(shot: Shot) -> FuncAnimation:
    figure = Figure(figsize=(4.4, 6.4), dpi=_DPI)
    ax = style.axes(figure.add_axes((0.01, 0.05, 0.98, 0.9)))
    ax.axis("off")
    above = ax.imshow(shot.frames[0], extent=EXTENT)
    ax.set_xlim(0, EXTENT[1])  # the goal's half of the field: nobody plays in the other

    def draw(frame: int) -> str:
        above.set_data(shot.frames[frame])
        row = shot.table.iloc[shot.looks[frame]]
        then = GOAL_ACTIONS[int(row.action)] if row.action >= 0 else "the end"
        return f"estimate {row.estimated_orientation:+.2f} rad, state {row.category:.0f}: {then}"

    return _film(figure, shot.summary, (0.01, 0.99), len(shot.frames), draw)


def frames(episode: Trajectory | Shot) -> list[NDArray[np.uint8]]:
    """Return the pictures of a film, each of shape (rows, columns, 3).

    Parameters
    ----------
    episode : Trajectory or Shot
        See `animate`.

    Examples
    --------
    >>> from arkaq_edu.experiments import approach
    >>> walked = approach.trajectory(1)
    >>> pictures = frames(walked)
    >>> len(pictures) == len(walked.table), pictures[0].shape
    (True, (272, 560, 3))
    """
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "frames.png"
        animate(episode).save(path, _Once(FRAMES_PER_SECOND), dpi=_DPI)
        with Image.open(path) as film:
            each = [np.asarray(picture.convert("RGB")) for picture in ImageSequence.Iterator(film)]
    return each


def save_film(episode: Trajectory | Shot, path: str | os.PathLike[str]) -> None:
    """Write the film of an episode to a file, which opens offline.

    Parameters
    ----------
    episode : Trajectory or Shot
        See `animate`.
    path : path
        Ends in ".gif" (a picture that plays once) or ".html" (a page with buttons and a slider, to
        step through it). An existing file is replaced.

    Raises
    ------
    ValueError
        If it has another ending.

    Examples
    --------
    >>> from arkaq_edu.experiments import approach
    >>> save_film(approach.trajectory(1), "walk.avi")
    Traceback (most recent call last):
    ValueError: path must end in .gif or .html, got 'walk.avi'
    """
    ending = Path(path).suffix.lower()
    if ending not in (".gif", ".html"):
        raise ValueError(f"path must end in .gif or .html, got {os.fspath(path)!r}")
    with replacing(path) as fresh:
        if ending == ".gif":
            animate(episode).save(fresh, _Once(FRAMES_PER_SECOND), dpi=_DPI)
        else:
            fresh.write_text(_page(animate(episode), episode.summary), encoding="utf-8")


class _Once(PillowWriter):
    """A writer of pictures that play once, and then show their last frame."""

    _frames: list[Image.Image]

    def finish(self) -> None:
        first, *others = self._frames
        once: dict[str, Any] = {"loop": 1} if Path(self.outfile).suffix == ".png" else {}
        pause = 1000 // self.fps
        first.save(self.outfile, save_all=True, append_images=others, duration=pause, **once)


def _page(animation: FuncAnimation, title: str) -> str:
    """Return matplotlib's page, the same in every run, with signs that need no network."""
    page = animation.to_jshtml(FRAMES_PER_SECOND, embed_frames=True, default_mode="once")
    page = re.sub(r"<link[^>]*font-awesome[^>]*>", "", page)
    page = re.sub(r"(anim|_anim_\w*?)[0-9a-f]{32}", r"\1_walk", page)
    signs = "".join(f'.fa-{name}::before {{content: "{sign}"}}\n' for name, sign in _SIGNS.items())
    flip = ".fa-flip-horizontal {display: inline-block; transform: scaleX(-1)}\n"
    head = f'<!doctype html>\n<meta charset="utf-8">\n<title>{title}</title>\n'
    return f"{head}<style>\n.fa {{font-style: normal}}\n{signs}{flip}</style>\n{page}"


@dataclass(frozen=True)
class Film:
    """A film that plays once in a notebook, and in a stored one without a kernel too.

    `arkaq_edu.widgets.film_explorer` steps through it.

    Parameters
    ----------
    episode : Trajectory or Shot
        See `animate`.

    Examples
    --------
    >>> from arkaq_edu.experiments import goal
    >>> Film(goal.record_episode(goal.load_agent(), orientation=-0.3))
    the goal 0.30 rad right, 2 turns: a goal
    """

    episode: Trajectory | Shot

    def __repr__(self) -> str:
        """Return the summary of the episode."""
        return self.episode.summary

    def _repr_png_(self) -> bytes:
        """Return a PNG of many frames, which browsers play once."""
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "frames.png"
            animate(self.episode).save(path, _Once(FRAMES_PER_SECOND), dpi=_DPI)
            return path.read_bytes()

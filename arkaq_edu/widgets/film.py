"""An episode frame by frame: a slider over the pictures of its film."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from arkaq_edu.experiments.approach.evaluation import Trajectory
from arkaq_edu.experiments.goal.evaluation import Shot
from arkaq_edu.figures.drawing.animation import frames
from arkaq_edu.widgets.explorer import Explorer, slider
from arkaq_edu.widgets.scene import Panel, Picture, Scene


def film_explorer(episode: Trajectory | Shot) -> Explorer:
    """Return a slider over the frames of an episode; the arrow keys step from frame to frame.

    Parameters
    ----------
    episode : Trajectory or Shot
        See `record_episode` of `arkaq_edu.experiments.approach` and `arkaq_edu.experiments.goal`.
        Frames that show the same count once.

    Returns
    -------
    Explorer
        Its slider is ``controls["frame"]``.

    Examples
    --------
    >>> from arkaq_edu.experiments import approach
    >>> explorer = film_explorer(approach.trajectory(1))
    >>> explorer.controls["frame"].value = 3
    >>> str(explorer).startswith("frame 3 of ")
    True
    """
    pictures = frames(episode)
    last = len(pictures) - 1

    def draw(frame: int) -> Scene:
        fact = f"frame {frame} of {last}: {episode.summary}"
        return Scene(fact, [_panel(pictures[frame])])

    told = "Which frame of the film; the arrow keys step"
    return Explorer(draw, frame=slider("frame", 0, 0, last, tooltip=told))


def _panel(pixels: NDArray[np.uint8]) -> Panel:
    rows, columns, _ = pixels.shape
    picture = Picture(pixels, (0, columns, 0, rows))
    return Panel("", "", (0, columns), (0, rows), [picture], bare=True)

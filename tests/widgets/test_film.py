"""The film that is stepped: each stop of the slider shows its own frame."""

import numpy as np

from arkaq_edu.experiments import approach
from arkaq_edu.experiments.approach.evaluation import Trajectory
from arkaq_edu.figures.drawing.animation import frames
from arkaq_edu.widgets import film_explorer


def test_each_stop_of_the_slider_shows_its_frame():
    walked = approach.trajectory(1)
    short = Trajectory(walked.table.iloc[-3:].reset_index(drop=True), True, walked.reward)
    pictures, explorer = frames(short), film_explorer(short)
    shown = []
    for number in range(3):
        explorer.controls["frame"].value = number
        shown.append(explorer.drawn.panels[0].layers[0].pixels)
        assert repr(explorer) == f"frame {number} of 2: {short.summary}"
    assert np.array_equal(shown, pictures)
    assert not np.array_equal(shown[0], shown[1])

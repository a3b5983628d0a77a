"""The figures of the field: what their pictures show, and what their titles say."""

import re

import numpy as np
import pandas as pd
import pytest
from matplotlib.figure import Figure

from arkaq_edu.field import Camera, World, motion, pitch
from arkaq_edu.figures import field, gallery
from arkaq_edu.figures.drawing import style


@pytest.fixture
def ax():
    return Figure().subplots()


def painted(image, color, tolerance=40):
    """Where a picture has a color of the palette: x and y in the units of the axes."""
    pixels = np.asarray(image.get_array())[..., :3].astype(int)
    near = np.abs(pixels - pitch.PALETTE[color].astype(int)).sum(axis=2) < tolerance
    rows, columns = np.nonzero(near)
    left, right, bottom, top = image.get_extent()
    height, width = near.shape
    x = left + (columns + 0.5) / width * (right - left)
    return np.column_stack([x, top - (rows + 0.5) / height * (top - bottom)])


def said(plot):
    return plot.ax.get_title(loc="left")


def test_all_are_in_the_gallery():
    for number in ("5.1", "5.2", "5.4", "5.31", "5.32", "5.33"):
        assert gallery.FIGURES[number] is getattr(field, f"figure_{number.replace('.', '_')}")


def test_robot_ball_and_goal_stand_where_their_names_say(ax):
    plot = field.figure_5_1(ax)
    ball, goal = painted(plot.image, pitch.ORANGE), painted(plot.image, pitch.BLUE)
    assert np.hypot(*(ball.mean(axis=0) - plot.names["ball"].xy)) < 30
    assert goal[:, 0].min() > 2600 and abs(goal[:, 1].mean()) < 50
    assert plot.names["goal"].xy[0] < goal[:, 0].min() and plot.names["goal"].xy[1] == 0
    pixels = np.asarray(plot.image.get_array()).astype(int)
    x, y = plot.names["robot"].xy
    height, width = pixels.shape[:2]
    row, column = int((2000 - y) / 4000 * height), int((x + 3000) / 6000 * width)
    patch = pixels[row - 15 : row + 15, column - 25 : column + 25]
    assert (patch.min(axis=2) > 225).mean() > 0.03, "a white shell"


def test_the_panels_handles_and_pictures_belong_together(ax):
    plot = field.figure_5_2(ax)
    left, right, head = field.SETTINGS
    assert [float(handle.get_xdata()[0]) for handle in plot.handles.values()] == [left, right, head]
    ends = [handle.axes.get_xlim() for handle in plot.handles.values()]
    assert ends == [(-194, 194), (-194, 194), (-1.6, 1.6)]
    world = World(rng=0)
    world.reset((-800.0, -500.0, 0.0), (1000.0, 300.0))
    for _ in range(5):
        world.cycle(left, right)
    motion.look(world, head)
    assert (plot.eye.get_array() == Camera().picture(world)).all()
    assert Camera().sighting(world) is not None, "the ball is in the picture"
    assert np.hypot(*(painted(plot.above, pitch.ORANGE).mean(axis=0) - world.ball)) < 40


def test_the_modules_that_are_bypassed_are_dashed_and_the_others_lead_through_arkaq(ax):
    plot = field.figure_5_4(ax)
    assert set(plot.parts) == {
        "vision", "communication", "localization", "planner", "motion", "ARKAQ",
    }  # fmt: skip
    used = {name for name, (_, is_used) in field.MODULES.items() if is_used}
    assert used == {"vision", "motion", "ARKAQ"}
    for name, text in plot.parts.items():
        assert (text.get_color() == style.QUIET) == (name not in used)
    solid = {ends for ends, arrow in plot.wires.items() if arrow.get_linestyle() in ("-", "solid")}
    assert solid == {("vision", "ARKAQ"), ("ARKAQ", "motion")}
    assert set(plot.wires) - solid == {
        ("vision", "localization"), ("localization", "planner"), ("planner", "motion"),
        ("communication", "planner"),
    }  # fmt: skip


def test_before_the_kick_the_ball_lies_before_the_paw(ax):
    plot = field.figure_5_31(ax)
    distance, to_goal = re.match(r"ready: (\d+) mm to the ball, ([\d,]+) mm", said(plot)).groups()
    assert abs(int(distance) - 245) < 40 and to_goal == "1,400"
    ball = painted(plot.image, pitch.ORANGE).mean(axis=0)
    assert ball == pytest.approx([2700 - 1400 + int(distance), 0], abs=40)


def test_during_the_kick_the_ball_rolls(ax):
    begin = painted(field.figure_5_31(ax).image, pitch.ORANGE).mean(axis=0)
    before = -1.0
    for after in (0.02, 0.25, 0.6):
        plot = field.figure_5_32(Figure().subplots(), after=after)
        rolled = re.search(r"rolled ([\d,]+) mm", said(plot))
        rolled = int(rolled[1].replace(",", "")) if rolled else 0
        ball = painted(plot.image, pitch.ORANGE, tolerance=15).mean(axis=0)
        assert np.hypot(*(ball - begin)) == pytest.approx(rolled, abs=15)
        assert rolled > before
        before = rolled
    with pytest.raises(ValueError, match="after must be a number"):
        field.figure_5_32(ax, after=60)


def test_a_missed_goal_is_one(ax):
    plot = field.figure_5_33(ax)
    ball = painted(plot.image, pitch.ORANGE, tolerance=15).mean(axis=0)
    assert not (ball[0] > 2742 and abs(ball[1]) < 400)
    distance = int(re.search(r"([\d,]+) mm", said(plot))[1].replace(",", ""))
    assert np.hypot(*(ball - [1300, 0])) == pytest.approx(distance, abs=20)


def test_measured_kicks_are_hollow_and_both_kinds_are_where_they_rest(ax):
    rng = np.random.default_rng(0)
    real, ours = (
        pd.DataFrame({"x": rng.uniform(500, 4000, n), "y": rng.uniform(-900, 900, n)})
        for n in (7, 12)
    )
    plot = field.plot_kicks(real, ours, ax)
    assert repr(plot) == "7 kicks of a real robot, 12 simulated"
    for marks, table in ((plot.measured, real), (plot.simulated, ours)):
        assert (marks.get_xydata() == table[["x", "y"]].to_numpy()).all()
    assert plot.measured.get_markerfacecolor() == "none" != plot.simulated.get_markerfacecolor()


@pytest.mark.parametrize("power", [1.0, 2.0, 2.5])
def test_the_fit_finds_the_power_that_made_the_errors(ax, power):
    d = np.array([500.0, 1000.0, 1500.0, 3000.0])
    plot = field.plot_distance_error(d, 3e-6 * d**power, ax, pixels=0.1)
    assert plot.exponent == pytest.approx(power)
    assert repr(plot) == f"the error goes as distance to the power {power:.2f}"
    x, y = plot.fit.get_data()
    assert y == pytest.approx(3e-6 * x**power)
    x, y = plot.pinhole.get_data()
    # An image whose radius is a tenth of a pixel too small looks that much farther.
    f = 104 / np.tan(np.radians(56.9) / 2)
    assert f * 42 / (f * 42 / x - 0.1) - x == pytest.approx(y, rel=0.05)


@pytest.mark.parametrize("bad", [[[1.0]], [1.0, np.nan]])
def test_bad_distances_are_refused(ax, bad):
    with pytest.raises(ValueError, match="distance must"):
        field.plot_distance_error(bad, [1.0], ax)

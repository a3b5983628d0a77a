"""The control panel without a browser: it is what its presses make it, and says what is so."""

import json
import re

import numpy as np
import pytest

from arkaq_edu.field import Camera, Legs, World, pitch
from arkaq_edu.field.drive import BALL, BUTTONS, ROBOT, Press
from arkaq_edu.field.head import Head
from arkaq_edu.widgets import control_panel
from arkaq_edu.widgets.scene import Line, Picture, Points, Text

SEEN = re.compile(
    r"ball ([\d,]+) mm, ([+−][\d.]+) rad \(true ([\d,]+), ([+−][\d.]+)\); "
    r"goal ([+−][\d.]+) \(true ([+−][\d.]+)\); next ([+−]\d+) mm, ([+−][\d.]+) rad"
)
MOVES = re.compile(
    r"the head moves, no look counts "
    r"\(true: ball ([\d,]+) mm, ([+−][\d.]+) rad; goal ([+−][\d.]+)\)"
)


@pytest.fixture
def panel():
    return control_panel()


def set_all(panel, **values):
    for name, value in values.items():
        panel.controls[name].value = value
        assert panel.error is None


def read(words):
    """The number that words of the explorer say."""
    return float(words.replace("−", "-").replace(",", ""))


def layers(panel, kind):
    return [layer for layer in panel.layers if isinstance(layer, kind)]


def test_it_says_what_is_seen_beside_what_is_true(panel):
    world = World(rng=0)
    world.reset(ROBOT, BALL)
    seen, goal = Camera().sighting(world), Camera().goal(world)
    distance = np.hypot(BALL[0] - ROBOT[0], BALL[1] - ROBOT[1])
    bearing = np.arctan2(BALL[1] - ROBOT[1], BALL[0] - ROBOT[0]) - ROBOT[2]
    wanted = (
        seen.distance, seen.orientation, distance, bearing,
        goal.orientation, world.goal_from_robot()[0], 100, 0,
    )  # fmt: skip
    found = [read(number) for number in SEEN.fullmatch(repr(panel)).groups()]
    assert found[::2] == pytest.approx(wanted[::2], abs=0.5)
    assert found[1::2] == pytest.approx(wanted[1::2], abs=0.006)


@pytest.mark.parametrize("left, right", [(-190, -190), (100, 90), (190, 190), (-190, 190)])
@pytest.mark.parametrize("head", [-1.5, 0.0, 1.5])
@pytest.mark.parametrize("press", [None, *BUTTONS])
def test_it_draws_at_every_end_of_its_controls(panel, left, right, head, press):
    set_all(panel, left=left, right=right, head=head)
    if press:
        panel.controls["presses"].press(press)
    assert panel.error is None and len(panel.drawn.panels) == 2
    ahead, turn = (left + right) / 2, (right - left) / 180
    step = f"; next {ahead:+.0f} mm, {turn:+.2f} rad".replace("-", "−")
    assert repr(panel).endswith(step) == (press != "kick")
    assert len(repr(panel)) <= 105  # more is cut off beside JupyterLab's list of files
    json.dumps(panel.view.scene)
    for drawn in panel.drawn.panels:
        for word in layers(drawn, Text):
            assert drawn.xlim[0] <= word.x <= drawn.xlim[1]
            assert drawn.ylim[0] <= word.y <= drawn.ylim[1]


def test_the_dashed_line_is_where_legs_without_a_drift_would_walk(panel):
    set_all(panel, left=80, right=120)
    (line,) = [line for line in layers(panel.drawn.panels[1], Line) if line.dashed]
    world = World(rng=0, legs=Legs(slide=0.0, pull=0.0, variation=0.0))
    world.reset(ROBOT, (-2000.0, 0.0))
    for cycle in range(1, 6):
        world.cycle(80, 120)
        assert np.hypot(line.x[8 * cycle] - world.pose[0], line.y[8 * cycle] - world.pose[1]) < 5
    (end,) = [mark for mark in layers(panel.drawn.panels[1], Points) if not mark.hollow]
    assert (end.x[0], end.y[0]) == (line.x[-1], line.y[-1])


def test_a_press_remembers_the_sliders_and_later_moves_change_nothing(panel):
    presses = panel.controls["presses"]
    set_all(panel, left=60, right=90, head=0.3)
    presses.children[0].click()
    set_all(panel, left=-190, right=190, head=0.3)
    assert presses.value == (Press("step", 60, 90, 0.3),)
    world = World(rng=0)
    world.reset(ROBOT, BALL)
    world.look(0.3)
    world.cycle(60, 90)
    words = " ".join(text.text for text in layers(panel.drawn.panels[1], Text))
    x, y, heading = world.pose
    stands = f"x {x:,.0f} mm, y {y:,.0f} mm, heading {heading:+.2f} rad, 0.6 s"
    assert stands.replace("-", "−") in words
    presses.children[-1].click()
    assert presses.value == () and "0.0 s" in layers(panel.drawn.panels[1], Text)[1].text


def test_while_the_head_moves_no_look_counts(panel):
    still = panel.drawn.panels[0]
    sharp = layers(still, Picture)[0].pixels
    set_all(panel, head=0.9)
    assert MOVES.match(repr(panel))
    eye, above = panel.drawn.panels
    blurred = layers(eye, Picture)[0].pixels
    assert not layers(eye, Points) and not layers(above, Points)[:-1]
    edges = [np.abs(np.diff(x.astype(float), axis=1)).max() for x in (sharp, blurred)]
    assert edges[1] < edges[0] / 5, "an edge is smeared over many columns"
    needed = 0.9 / Head().speed + Head().settling
    for waited in np.arange(0.1, 0.6, 0.1):
        panel.controls["presses"].press("wait 0.1 s")
        assert bool(MOVES.match(repr(panel))) == (waited < needed - 1e-9)
    set_all(panel, head=-0.5)
    assert MOVES.match(repr(panel))
    set_all(panel, head=0.9)
    assert not MOVES.match(repr(panel)), "it never went"


def test_a_mark_shows_where_in_the_picture_the_ball_was_measured(panel):
    for head in (0.0, 0.3, -0.2):
        set_all(panel, head=head)
        panel.controls["presses"].press("step")
        eye, above = panel.drawn.panels
        pixels = layers(eye, Picture)[0].pixels
        rows, columns = np.nonzero((pixels == pitch.PALETTE[pitch.ORANGE]).all(axis=2))
        (ring,) = layers(eye, Points)
        assert ring.hollow
        assert ring.x[0] == pytest.approx(columns.mean() + 0.5, abs=0.6)
        assert ring.y[0] == pytest.approx(160 - rows.mean() - 0.5, abs=1.0)
        rows, columns = np.nonzero((pixels == pitch.PALETTE[pitch.BLUE]).all(axis=2))
        (bar,) = layers(eye, Line)
        if columns.min() > 0 and columns.max() < 207:
            assert bar.x[0] == pytest.approx((columns.min() + columns.max() + 1) / 2, abs=3)
        (seen,) = [mark for mark in layers(above, Points) if mark.hollow]
        assert np.hypot(seen.x[0] - BALL[0], seen.y[0] - BALL[1]) < 40


def test_no_mark_is_drawn_beside_the_picture(panel):
    inside = set()
    for head in np.arange(-0.9, 0.91, 0.1):
        set_all(panel, head=round(head, 1), presses=())
        panel.controls["presses"].value = [Press("step", 0, 0, round(head, 1))]
        eye, _ = panel.drawn.panels
        bars = layers(eye, Line)
        for bar in bars:
            assert 0 <= min(bar.x) <= max(bar.x) <= 208
        named = any("bar" in text.text for text in layers(eye, Text))
        assert named == bool(bars)
        inside.add((bool(bars), "no goal" in repr(panel)))
    assert inside == {(True, False), (False, False), (False, True)}


def test_a_wall_stops_it(panel):
    set_all(panel, left=190, right=190, presses=[Press("5 steps", 190, 190, 0.0)] * 12)
    words = layers(panel.drawn.panels[1], Text)[1].text
    x, y = (read(number) for number in re.findall(r"[xy] (−?[\d,]+) mm", words))
    assert abs(x) < 3000 and abs(y) < 2000
    assert repr(panel).startswith("no ball (true ")


def test_an_unknown_press_is_refused(panel):
    with pytest.raises(ValueError, match="name must be one of step, 5 steps"):
        panel.controls["presses"].value = [("fly", 0, 0, 0)]
    with pytest.raises(ValueError, match="name must be one of step, 5 steps"):
        panel.controls["presses"].press("fly")
    panel.controls["presses"].value = [Press("step", 500, 0, 0)]
    assert "left must be a number in [-194, 194], got 500" in str(panel.error)

"""How the camera sees the goal: against geometry, and the quick look against the whole picture."""

import json
import math
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from arkaq_edu.field import Camera, GoalSupervisor, Kick, Verdict, World, pitch
from arkaq_edu.field.kick import MARK

PIXEL = 1 / 192  # rad, in the middle of the picture


def look_from(x, y, heading, eye=Camera(), ball=(-2500.0, -1500.0)):  # noqa: B008
    """What is seen of the goal, what there is to see, and the whole picture."""
    world = World(rng=0)
    world.reset((x, y, heading), ball)
    return eye.goal(world), world.goal_from_robot(), eye.colors(world)


def posts_seen_from(x, y):
    """The directions (rad) in which the outer edges of the two posts are seen: tangents."""
    edges = []
    for side in (1, -1):
        dx, dy = 2700 - x, side * 450 - y
        edges.append(math.atan2(dy, dx) + side * math.asin(50 / math.hypot(dx, dy)))
    return edges


# What there is to see ---------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("pose", "orientation", "width"),
    [
        ((1700.0, 0.0, 0.0), 0.0, 2 * math.atan(0.5)),
        ((1700.0, 0.0, 0.3), -0.3, 2 * math.atan(0.5)),
        ((2200.0, -500.0, 0.0), math.atan(2) / 2, math.atan(2)),
        ((1700.0, 0.0, math.pi), math.pi, 2 * math.atan(0.5)),
    ],
)
def test_the_true_goal_is_the_angle_between_its_posts(pose, orientation, width):
    world = World(rng=0)
    world.reset(pose, (0.0, 1000.0))
    seen, across = world.goal_from_robot()
    assert math.cos(seen - orientation) == pytest.approx(1.0)
    assert across == pytest.approx(width)


def test_a_whole_goal_is_seen_where_its_posts_stand():
    rng, wholes = np.random.default_rng(0), 0
    for _ in range(150):
        x, y = rng.uniform(-2000, 1700), rng.uniform(-900, 900)
        left, right = posts_seen_from(x, y)
        heading = (left + right) / 2 + rng.uniform(-0.4, 0.4)
        seen, (true, _), _ = look_from(x, y, heading)
        # The picture reaches 28.45 degrees to either side.
        inside = max(abs(left - heading), abs(right - heading)) < math.radians(28.45) - 2 * PIXEL
        if not inside:
            continue
        wholes += 1
        assert seen.whole
        assert seen.orientation == pytest.approx((left + right) / 2 - heading, abs=PIXEL)
        assert seen.width == pytest.approx(left - right, abs=2 * PIXEL)
        assert seen.orientation == pytest.approx(true, abs=PIXEL + 0.012)
    assert wholes > 80


@pytest.mark.parametrize("distance", [1400.0, 1850.0, 2300.0, 3000.0])
def test_a_goal_half_out_of_view_is_made_whole_by_the_height_of_its_post(distance):
    cut = []
    for orientation in np.linspace(-0.62, 0.62, 125):
        seen, (true, width), colors = look_from(2700 - distance, 0.0, -orientation)
        blue = np.flatnonzero((colors == pitch.BLUE).any(axis=0))
        if seen is None or seen.whole or len(blue) < 8:
            continue
        cut.append(orientation)
        # One pixel more or less of the post's height.
        tall = 300 / distance / PIXEL
        assert true == pytest.approx(orientation)
        assert seen.width == pytest.approx(width, abs=1.5 * width / tall + 0.03)
        assert seen.orientation == pytest.approx(true, abs=width / tall + 0.02)
    assert min(cut) < -0.5 and max(cut) > 0.5, "more than half of it is out of view"


def test_a_goal_that_fills_the_picture_lies_ahead():
    seen, _, colors = look_from(2300.0, 0.0, 0.0)
    assert (colors[:, [0, -1]] == pitch.BLUE).any(axis=0).all()
    assert not seen.whole
    assert seen.orientation == pytest.approx(0.0, abs=PIXEL)
    assert seen.width == pytest.approx(math.radians(56.9), abs=0.02)


def test_no_goal_is_seen_where_none_is():
    for heading in np.linspace(1.2, 2 * math.pi - 1.2, 25):
        seen, _, colors = look_from(0.0, 0.0, heading)
        assert seen is None and pitch.BLUE not in colors
    assert look_from(0.0, 0.0, math.pi)[2].tolist().count(pitch.YELLOW) == 0
    assert pitch.YELLOW in look_from(0.0, 0.0, math.pi)[2], "the yellow goal is another"


def test_a_ball_before_the_goal_hides_nothing_of_it():
    for ball in [(1300.0, 300.0), (1300.0, 0.0), (2600.0, -350.0)]:
        seen, *_ = look_from(1000.0, 0.0, 0.0, ball=ball)
        bare, *_ = look_from(1000.0, 0.0, 0.0)
        assert seen == bare


# The quick look and the whole picture -----------------------------------------------------------


@settings(max_examples=80, deadline=None)
@given(
    x=st.floats(-3000, 3000),
    y=st.floats(-2000, 2000),
    heading=st.floats(-4, 4),
    height=st.floats(60, 400),
    tilt=st.floats(0, 1),
)
def test_the_quick_look_is_that_of_the_picture_for_any_camera(x, y, heading, height, tilt):
    eye = Camera(height, tilt)
    seen, _, colors = look_from(x, y, heading, eye)
    assert seen == eye.goal_in(colors)


def test_the_quick_look_is_that_of_the_picture_about_the_goal():
    rng, kinds = (
        np.random.default_rng(3),
        dict.fromkeys(("whole", "left", "right", "both", "no"), 0),
    )
    for _ in range(250):
        x, y = rng.uniform(500, 2900), rng.uniform(-1200, 1200)
        heading = math.atan2(-y, 2700 - x) + rng.uniform(-0.8, 0.8)
        eye = Camera()
        seen, _, colors = look_from(x, y, heading, eye)
        assert seen == eye.goal_in(colors)
        left, right = (colors[40, [0, -1]] == pitch.BLUE).tolist()
        kind = {(True, True): "both", (True, False): "left", (False, True): "right"}
        kinds["no" if seen is None else kind.get((left, right), "whole")] += 1
    assert min(kinds.values()) >= 10, kinds


def goals_seen():
    """Looks at the goal, for comparing processes: exact floats as text."""
    rng, world, eye = np.random.default_rng(5), World(rng=0), Camera()
    said = []
    for _ in range(60):
        pose = (rng.uniform(0, 2500), rng.uniform(-900, 900), rng.normal(0, 0.4))
        world.reset(pose, (-2500.0, 0.0))
        said.append(repr(eye.goal(world)))
    return said


def test_the_goal_looks_the_same_without_numba():
    here = [str(Path(__file__).parents[2]), os.environ.get("PYTHONPATH", "")]
    script = "import json; from tests.field.test_goal import *; print(json.dumps(goals_seen()))"
    done = subprocess.run(
        [sys.executable, "-c", script], capture_output=True, text=True, timeout=300,
        env=os.environ | {"NUMBA_DISABLE_JIT": "1", "PYTHONPATH": os.pathsep.join(here)},
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    assert json.loads(done.stdout) == goals_seen()


def test_a_picture_of_another_shape_is_refused():
    with pytest.raises(ValueError, match="colors"):
        Camera().goal_in(np.zeros((208, 160), np.uint8))


# The supervisor ---------------------------------------------------------------------------------


@pytest.mark.parametrize("orientation", [-0.4, 0.0, 0.25])
def test_the_robot_stands_straight_before_the_goal(orientation):
    world = World(rng=0)
    GoalSupervisor(1850.0).place(world, orientation)
    assert world.pose[:2] == (850.0, 0.0)
    assert world.goal_from_robot()[0] == pytest.approx(orientation)
    assert Camera().sighting(world) is None, "the ball waits out of view"


def test_the_ball_is_set_before_the_paw_as_well_as_a_robot_would():
    world = World(rng=0, kick=Kick(spread=8.0))
    places = []
    for heading in np.linspace(-3, 3, 400):
        world.reset((500.0, 200.0, heading), (0.0, -1500.0))
        GoalSupervisor.set_ball(world)
        distance, angle = world.ball_from_robot()
        places.append((distance * math.cos(angle), distance * math.sin(angle)))
    off = np.array(places) - MARK
    assert off.mean(axis=0) == pytest.approx([0.0, 0.0], abs=4 * 8 / 20)
    assert off.std(axis=0) == pytest.approx([8.0, 8.0], rel=0.15)
    assert abs(np.corrcoef(off.T)[0, 1]) < 0.2
    world.kick = Kick(spread=0.0)
    GoalSupervisor.set_ball(world)
    distance, angle = world.ball_from_robot()
    assert (distance * math.cos(angle), distance * math.sin(angle)) == pytest.approx(MARK)


@pytest.mark.parametrize(
    ("ball", "scored"),
    [
        ((2800.0, 0.0), True),
        ((2742.5, 0.0), True),
        ((2741.5, 0.0), False),  # not wholly over the line
        ((2900.0, 355.0), True),
        ((2900.0, 600.0), False),  # beside the goal
        ((2900.0, -600.0), False),
        ((-2800.0, 0.0), False),  # the other goal
        ((0.0, 0.0), False),
    ],
)
def test_a_goal_is_a_ball_at_rest_over_the_line_between_the_posts(ball, scored):
    world = World(rng=0)
    world.reset((0.0, 1000.0, 0.0), ball)
    assert GoalSupervisor(1850.0).judge(world) == Verdict(100.0 if scored else -100.0, scored)

"""What the field takes, and what it refuses by name."""

import math

import numpy as np
import pytest

from arkaq_edu.field import (
    Camera,
    GoalSupervisor,
    Head,
    Kick,
    Legs,
    Supervisor,
    World,
    bird_view,
    motion,
    random_place,
)
from arkaq_edu.field.camera import fit_power
from arkaq_edu.field.view import body_outline


def test_the_callers_arrays_stay_as_they_are():
    world, left, right = World(rng=0), np.array(100.0), np.array(90.0)
    world.cycle(left, right)
    assert (left, right) == (100.0, 90.0)
    plain = World(rng=0)
    plain.cycle(100.0, 90.0)
    assert world.pose == plain.pose


@pytest.mark.parametrize(
    ("kind", "name", "high"),
    [
        (Legs, "slide", 1), (Legs, "pull", 0.01), (Legs, "variation", 0.5), (Kick, "spread", 12),
        (Kick, "swerve", 200), (Head, "reach", 1.6), (Head, "speed", 100), (Head, "settling", 10),
    ],
)  # fmt: skip
def test_settings_keep_the_number_that_was_checked(kind, name, high):
    for value in (high, np.array(high), np.float64(high)):
        kept = getattr(kind(**{name: value}), name)
        assert type(kept) is float and kept == high
    for value in ("1", None, [high], math.nan, 1e308, 1j, np.ma.masked, high + 1):
        with pytest.raises(ValueError, match=f"{name} must be a number in"):
            kind(**{name: value})


@pytest.mark.parametrize("value", ["no", 0, None, np.zeros(2)])
def test_blurs_is_true_or_false(value):
    with pytest.raises(ValueError, match="blurs must be"):
        Head(blurs=value)


@pytest.mark.parametrize("name", ["legs", "head", "kick"])
@pytest.mark.parametrize("value", [{}, 0, "default"])
def test_parts_of_another_class_are_refused_by_name(name, value):
    with pytest.raises(ValueError, match=f"{name} must be of the class {name.title()}"):
        World(**{name: value})


BAD_NUMBERS = ["1", None, [1.0], math.nan, math.inf, 1e308, 10**400, 1j]


@pytest.mark.parametrize("value", BAD_NUMBERS, ids=repr)
@pytest.mark.parametrize(
    ("call", "name"),
    [
        (lambda x: World(rng=0).cycle(x, 0.0), "left"),
        (lambda x: World(rng=0).cycle(0.0, x), "right"),
        (lambda x: World(rng=0).stand(x), "seconds"),
        (lambda x: World(rng=0).look(x), "pan"),
        (lambda x: World(rng=0).roll_ball((x, 0.0)), "velocity"),
        (lambda x: World(rng=0).put_ball(x, 0.0), "ball"),
        (lambda x: World(rng=0).reset((0.0, 0.0, x), (0.0, 0.0)), "robot"),
        (lambda x: motion.walk(World(rng=0), x), "distance"),
        (lambda x: motion.turn(World(rng=0), x), "angle"),
        (lambda x: motion.footsteps(x, 0.0), "ahead"),
        (lambda x: motion.footsteps(0.0, x), "turn"),
        (lambda x: motion.gait(x, 0.0), "left"),
        (lambda x: motion.gait(0.0, x), "right"),
        (lambda x: motion.arc_path((0.0, 0.0, x), 1.0, 1.0, 2), "pose"),
        (lambda x: Supervisor().place(World(rng=0), x, 0.0), "distance"),
        (lambda x: Supervisor().place(World(rng=0), 900.0, x), "orientation"),
        (lambda x: GoalSupervisor(2000.0).place(World(rng=0), x), "orientation"),
        (lambda x: Camera(height=x), "height"),
        (lambda x: Camera(tilt=x), "tilt"),
        (lambda x: Camera(min_pixels=x), "min_pixels"),
        (lambda x: Camera().pixel(World(rng=0), x, 0.0, 0.0), "distance"),
        (lambda x: Camera().pixel(World(rng=0), 900.0, x, 0.0), "orientation"),
        (lambda x: Camera().pixel(World(rng=0), 900.0, 0.0, x), "height"),
        (lambda x: Camera().distance_error(900.0, x), "pixels"),
        (lambda x: random_place(0, near=x), "near"),
        (lambda x: random_place(0, far=x), "far"),
        (lambda x: bird_view(World(rng=0), width=x), "width"),
        (lambda x: bird_view(World(rng=0), region=(x, 1.0, 0.0, 1.0)), "region"),
        (lambda x: bird_view(World(rng=0), trail=[(0.0, x)] * 2), "trail"),
        (lambda x: bird_view(World(rng=0), ball_trail=[(0.0, x)] * 2), "ball_trail"),
        (lambda x: body_outline(x, 0.0, 0.0), "x, y and heading"),
    ],
)
def test_what_is_no_number_is_refused_by_name(call, name, value):
    with pytest.raises(ValueError, match=f"^{name} "):
        call(value)


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (lambda: World(rng=-1), "rng must be"),
        (lambda: World(rng="0"), "rng must be"),
        (lambda: World().roll_ball((8000.0, 8000.0)), r"velocity .*in \[0, 10000\], got 11313"),
        (lambda: World().stand(3601), r"seconds .*in \[0, 3600\]"),
        (lambda: motion.walk(World(), 100_001), r"distance .*in \[-100000, 100000\]"),
        (lambda: motion.turn(World(), -630), r"angle .*in \[-628.319, 628.319\]"),
        (lambda: motion.straight_walk(World(), 10**9), r"cycles .*in \[1, 10000\]"),
        (lambda: motion.footstep_path(World(), 1, 1, 10**9), r"cycles .*in \[1, 10000\]"),
        (lambda: motion.arc_path((0, 0, 0), 1, 1, 10**9), r"cycles .*in \[0, 10000\]"),
        (lambda: random_place(0, placement="aera"), "placement must be 'area' or 'thesis', got 'a"),
        (lambda: random_place(0, placement=None), "placement must be 'area' or 'thesis'"),
        (lambda: random_place(0, near=3000, far=600), r"far .*in \[3000, 4100\], got 600"),
        (lambda: random_place(0, 3000, 3000, "thesis"), r"far .*in \[3001, 4100\], got 3000"),
        (lambda: random_place(-1), "rng must be"),
        (lambda: Supervisor(900, 900, "thesis"), r"far .*in \[901, 4100\]"),
        (lambda: Supervisor(placement=["area"]), "placement must be"),
        (lambda: bird_view(World(), width=10**6), r"width .*in \[1, 4000\]"),
        (lambda: bird_view(World(), region=(0, 1, 0, 1e9)), r"region .*in \[1, 4000\]"),
        (lambda: bird_view(World(), region=(1, 0, 0, 1)), "region must be left < right"),
        (lambda: bird_view(World(), trail=[(1, 2, 3)] * 2), "trail must have shape"),
        (lambda: Camera().sighting_in([[0] * 208] * 160 + [[0]]), "colors must"),
        (lambda: Camera().sighting_in(np.full((160, 208), 0.5)), "colors must hold integers"),
        (lambda: Camera().goal_in(np.full((160, 208), 99)), "colors must hold integers in"),
        (lambda: Camera(tilt=0.0).pixel(World(), 0.0, 0.0, 0.0), "distance must not be"),
        (lambda: Camera().distance_error([1.0, math.nan]), "distance must hold finite"),
        (lambda: fit_power([1.0], [1.0]), "distance must hold at least two numbers > 0"),
        (lambda: fit_power([1.0, 2.0], [1.0, 0.0]), "error must hold at least two numbers > 0"),
        (lambda: fit_power([1.0, 2.0], [1.0]), r"error must have shape \(2,\)"),
    ],
)
def test_what_nobody_means_is_refused_by_name(call, words):
    with pytest.raises(ValueError, match=words):
        call()


def test_the_longest_of_each_is_taken():
    world = World(rng=0)
    world.roll_ball((10_000.0, 0.0))
    world.cycle(194.0, -194.0)
    assert abs(world.ball[0]) <= 3000 and abs(world.ball[1]) <= 2000
    assert random_place(0, 900.0, 900.0)[0] == pytest.approx(900.0)
    near, far = 899.0, 900.0
    assert near <= random_place(0, near, far, "thesis")[0] <= far


def test_a_seed_is_a_generator():
    assert random_place(3) == random_place(np.random.default_rng(3))
    assert World(rng=np.int64(3)).rng.random() == np.random.default_rng(3).random()


def test_lists_are_pictures_and_paths_too():
    world, camera = World(rng=0), Camera()
    colors = camera.colors(world)
    assert camera.sighting_in(colors.tolist()) == camera.sighting_in(colors)
    trail = [[0.0, 0.0], [500.0, 300.0]]
    assert np.array_equal(
        bird_view(world, 120, np.array(trail)), bird_view(world, 120, [(0, 0), (500, 300)])
    )

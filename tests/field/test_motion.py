"""The motion engine's gaits, and the head: against where they ought to end."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from arkaq_edu.field import Camera, Head, Legs, World, motion

PERFECT = Legs(slide=0.0, pull=0.0, variation=0.0)
CYCLE = 0.64


def world_at(x=0.0, y=0.0, heading=0.0, ball=(-2500.0, -1500.0), **parts):
    world = World(rng=0, legs=parts.pop("legs", PERFECT), **parts)
    world.reset((x, y, heading), ball)
    return world


# Gaits ------------------------------------------------------------------------------------------


@settings(max_examples=60, deadline=None)
@given(distance=st.floats(-1500, 1500), angle=st.floats(-math.pi, math.pi))
def test_an_arc_ends_where_its_circle_says(distance, angle):
    world = world_at()
    motion.arc(world, distance, angle)
    x, y, heading = world.pose
    # Twice the radius times the sine of half the angle, in the direction of half the angle.
    chord = distance * (math.sin(angle / 2) / (angle / 2) if abs(angle) > 1e-9 else 1.0)
    # The first step from rest is lost: as much as a robot walks and turns in four of the physics'.
    cycles = round(world.time / CYCLE)
    lost = 4 / 80 / cycles
    assert heading == pytest.approx(angle, abs=abs(angle) * lost + 1e-6)
    off = math.hypot(x - chord * math.cos(angle / 2), y - chord * math.sin(angle / 2))
    assert off < abs(distance) * (lost + 0.01 + 0.06 * abs(angle) / cycles) + 0.5


def test_walking_and_turning_are_arcs_of_their_own():
    world = world_at()
    motion.walk(world, 500.0)
    x, y, heading = world.pose
    assert x == pytest.approx(500, rel=0.02) and (y, heading) == pytest.approx((0, 0), abs=1e-6)
    motion.turn(world, -0.8)
    assert world.pose[:2] == pytest.approx((x, y), abs=5)  # the last footstep runs out
    assert world.pose[2] == pytest.approx(-0.8, abs=0.02)
    motion.walk(world, -200.0)
    back = (x - 200 * math.cos(0.8), 200 * math.sin(0.8))
    assert world.pose[:2] == pytest.approx(back, abs=8)


@pytest.mark.parametrize(
    ("distance", "angle", "cycles"),
    [
        (0.0, 0.0, 1),
        (194.0, 0.0, 1),
        (195.0, 0.0, 2),
        (-582.0, 0.0, 3),
        (0.0, math.radians(84), 1),
        (0.0, math.radians(85), 2),
        (0.0, -math.pi, 3),
        (170.0, 0.3, 2),  # its outer footstep is 197 mm long
    ],
)
def test_a_gait_takes_as_many_cycles_as_the_legs_need(distance, angle, cycles):
    world = world_at()
    motion.arc(world, distance, angle)
    assert world.time == pytest.approx(cycles * CYCLE)


@given(ahead=st.floats(-100, 100), turn=st.floats(-1, 1))
def test_footsteps_add_up_to_the_way_and_differ_by_the_turn(ahead, turn):
    left, right = motion.footsteps(ahead, turn)
    assert (left + right) / 2 == pytest.approx(ahead, abs=1e-9)
    assert (right - left) / 180 == pytest.approx(turn, abs=1e-9)


def test_stopping_takes_a_cycle_and_no_way():
    world = world_at()
    motion.walk(world, 100.0)
    before = world.pose
    motion.stop(world)
    motion.stop(world)
    assert math.dist(before, world.pose) < 3.0
    assert world.time == pytest.approx(3 * CYCLE)


def test_standing_holds_the_robot_where_it_is_at_once():
    world = world_at()
    motion.turn(world, 0.5)
    before = world.pose
    world.stand(0.5)
    assert world.pose == before
    assert 0.5 <= world.time - CYCLE < 0.51


def test_what_the_legs_do_wrong_comes_through():
    drifted, straight = world_at(legs=Legs(variation=0.0)), world_at()
    for world in (drifted, straight):
        motion.walk(world, 1000.0)
    assert drifted.pose[1] == pytest.approx(70 - 20, abs=5) and not straight.pose[1]


# The head ---------------------------------------------------------------------------------------


def test_the_head_pans_at_its_speed_and_then_sways_for_a_while():
    world = world_at(head=Head(speed=2.0, settling=0.2))
    world.look(0.5)
    assert world.pan == 0.0 and world.unsettled == pytest.approx(0.25 + 0.2)
    world.stand(0.1)
    assert world.pan == pytest.approx(2.0 * world.time)
    world.stand(world.unsettled - 0.1)
    assert world.pan == 0.5 and 0.09 < world.unsettled < 0.11
    world.stand(0.12)
    assert world.pan == 0.5 and world.unsettled == 0.0


def test_the_head_turns_round_from_where_it_is():
    world = world_at(head=Head(speed=1.0))
    world.look(1.0)
    world.stand(0.4)
    reached = world.pan
    world.look(-0.2)
    assert world.pan == pytest.approx(reached)
    world.stand(0.2)
    assert world.pan == pytest.approx(reached - 0.2, abs=1e-9)
    motion.stop(world)
    assert world.pan == -0.2


@pytest.mark.parametrize("reach", [0.0, 0.4, 1.6])
def test_the_head_goes_no_farther_than_it_can(reach):
    world = world_at(head=Head(reach=reach))
    motion.look(world, 3.0)
    assert world.pan == reach
    motion.look(world, -3.0)
    assert world.pan == -reach


def test_a_reset_puts_the_head_straight_and_the_clock_to_zero():
    world = world_at()
    motion.look(world, 0.7)
    world.reset((0.0, 0.0, 0.0), (1000.0, 0.0))
    assert (world.pan, world.unsettled, world.time) == (0.0, 0.0, 0.0)


def test_nothing_is_seen_while_the_head_moves_unless_that_is_turned_off():
    for blurs in (True, False):
        world, eye = world_at(ball=(1000.0, 200.0), head=Head(blurs=blurs)), Camera()
        assert eye.sighting(world) and eye.goal(world)
        world.look(0.3)
        assert eye.blurred(world) is blurs
        assert (eye.sighting(world) is None) is blurs and (eye.goal(world) is None) is blurs
        world.stand(world.unsettled + 0.01)
        assert eye.sighting(world) and eye.goal(world)


def test_to_look_is_to_wait_until_pictures_are_good():
    waiting, hasty = world_at(), world_at(head=Head(blurs=False))
    for world in (waiting, hasty):
        motion.look(world, 0.6)
    assert 0.3 <= waiting.time < 0.32 and waiting.pan == 0.6
    assert hasty.time == 0.0 and hasty.pan == 0.0


def test_the_camera_looks_where_the_head_points_and_counts_from_the_body():
    rng = np.random.default_rng(0)
    for _ in range(40):
        pan, heading = rng.uniform(-1.5, 1.5), rng.uniform(-3, 3)
        angle, distance = rng.uniform(-0.4, 0.4), rng.uniform(500, 1500)
        turned = world_at(heading=heading)
        ahead = world_at(heading=heading + pan)
        direction = heading + pan + angle
        ball = (distance * math.cos(direction), distance * math.sin(direction))
        turned.reset(turned.pose, ball)
        ahead.reset(ahead.pose, ball)
        motion.look(turned, pan)
        eye = Camera()
        there, here = eye.sighting(turned), eye.sighting(ahead)
        assert there.distance == pytest.approx(here.distance, rel=0.03)
        assert there.orientation == pytest.approx(here.orientation + pan, abs=0.003)
        assert there.orientation == pytest.approx(pan + angle, abs=0.02)


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (lambda: Head(reach=2.0), "reach.*2"),
        (lambda: Head(speed=0.0), "speed.*0"),
        (lambda: Head(settling=-1.0), "settling.*-1"),
        (lambda: motion.walk(world_at(), math.nan), "distance.*nan"),
        (lambda: motion.turn(world_at(), math.inf), "angle.*inf"),
        (lambda: motion.look(world_at(), math.nan), "pan.*nan"),
        (lambda: world_at().stand(-1.0), "seconds.*-1"),
    ],
)
def test_bad_input_is_refused_by_name(call, words):
    with pytest.raises(ValueError, match=words):
        call()

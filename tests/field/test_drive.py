"""A robot driven by hand: it is what its presses make it."""

import numpy as np

from arkaq_edu.field import GoalSupervisor
from arkaq_edu.field.drive import BALL, Drive, Press

LONG = [
    Press("5 steps", 120, 140, 0.0), Press("step", -60, 60, 0.4),
    Press("wait 0.1 s", 0, 0, -0.4), Press("ball to the paw", 0, 0, -0.4),
    Press("kick", 0, 0, -0.4), Press("5 steps", 190, 190, 0.2),
]  # fmt: skip


def test_going_on_is_the_same_as_beginning_anew_to_the_last_bit():
    one, other = Drive(seed=3), Drive(seed=3)
    for n in range(len(LONG) + 1):
        one.follow(LONG[:n])
    other.follow(LONG)
    assert one.world.pose == other.world.pose and one.world.ball == other.world.ball
    assert one.trail == other.trail and one.ball_trail == other.ball_trail
    assert one.message == other.message and (one.picture == other.picture).all()
    one.follow(LONG[:2])
    other.follow([])
    other.follow(LONG[:2])
    fresh = Drive(seed=3)
    fresh.follow(LONG[:2])
    assert one.world.pose == other.world.pose == fresh.world.pose != Drive(seed=4).world.pose
    other_luck = Drive(seed=4)
    other_luck.follow(LONG[:2])
    assert other_luck.world.pose != fresh.world.pose


def test_a_kick_says_how_far_and_whether_it_was_a_goal():
    told = set()
    for seed in range(12):
        drive = Drive(seed)
        drive.follow([Press("ball to the paw", 0, 0, 0), Press("kick", 0, 0, 0)])
        start, end = drive.ball_trail[0], drive.world.ball
        inside = end[0] > 2700 + 42 and abs(end[1]) < 400
        assert GoalSupervisor(2000.0).judge(drive.world).is_success == inside
        rolled = np.hypot(end[0] - start[0], end[1] - start[1])
        assert drive.message == f"kicked {rolled:,.0f} mm{', a goal' if inside else ', no goal'}"
        told.add(inside)
    drive.follow([*drive.presses, Press("step", 0, 0, 0)])
    assert drive.message == "" and drive.ball_trail
    drive.follow([Press("kick", 0, 0, 0)])
    assert drive.message == "the paw met no ball" and drive.world.ball == BALL


def test_before_a_wall_there_is_no_room_for_the_ball():
    drive = Drive()
    drive.follow([Press("5 steps", 190, 190, 0.0)] * 4)
    x, y, heading = drive.world.pose
    assert abs(x + 245 * np.cos(heading)) > 3000 or abs(y + 245 * np.sin(heading)) > 2000
    drive.follow([*drive.presses, Press("ball to the paw", 0, 0, 0)])
    assert drive.message == "no room for the ball before the paw" and drive.world.ball == BALL

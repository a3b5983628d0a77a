"""The live robot without a page: what it tells, what a hand does to it, and that it ends."""

import gc
import json
import math
import weakref
from itertools import pairwise

import ipywidgets
import numpy as np
import pytest

from arkaq_edu.arkaq import Arkaq, TrainingSettings, UniformGrid
from arkaq_edu.experiments import approach, segmentation
from arkaq_edu.widgets import live_robot, race
from arkaq_edu.widgets.robot import (
    CHANCE,
    DRIVERS,
    PLANNER,
    TRAINED,
    Curve,
    Robot,
    regrouped,
)


def walked(cycles=30, **settings):
    """The frames of a robot with these settings."""
    robot = Robot()
    robot.set(**settings)
    return [robot.step() for _ in range(cycles)]


@pytest.mark.parametrize("driver", DRIVERS)
def test_the_same_seed_walks_the_same(driver):
    once, again, other = (walked(driver=driver, seed=seed) for seed in (4, 4, 5))
    assert json.dumps(once) == json.dumps(again) != json.dumps(other)


def test_each_movement_begins_where_the_last_one_ended():
    frames = walked(80)
    for before, frame in pairwise(frames):
        begins = len(frame["motion"]) == 1
        assert begins == before["over"]
        if not begins:
            assert frame["motion"][0][1:] == before["motion"][-1][1:]
    assert sum(frame["over"] for frame in frames) >= 2


def test_a_frame_agrees_with_the_world_and_the_agent():
    robot = Robot()
    for _ in range(8):
        frame = robot.step()
    agent, distance = approach.load_agent(), math.dist(robot.pose[:2], robot.ball)
    orientation, believed = frame["estimate"]
    assert believed == pytest.approx(distance, rel=0.1) == pytest.approx(frame["seen"][1], rel=0.1)
    state = agent.art.category(agent.sensing.scale([believed, orientation]))
    assert frame["cell"] == state
    np.testing.assert_allclose(frame["values"], agent.q.Q[state], atol=0.01)
    assert frame["action"] == np.argmax(frame["values"])
    whole = robot.frame(whole=True)
    corners = np.reshape(whole["map"][frame["cell"]], (-1, 2))
    low, high = corners.min(axis=0), corners.max(axis=0)
    assert low[0] <= orientation <= high[0] and low[1] <= believed <= high[1]
    assert whole["best"][frame["cell"]] == frame["action"]


def test_the_picture_comes_as_runs_of_a_color():
    import base64

    robot = Robot()
    runs = np.frombuffer(base64.b64decode(robot.frame()["eye"]), "<u2").reshape(-1, 2)
    picture = np.repeat(runs[:, 0], runs[:, 1]).reshape(160, 208)
    np.testing.assert_array_equal(picture, robot.senses.camera.colors(robot.senses.world))


def test_a_ball_that_is_dragged_is_seen_elsewhere():
    robot = Robot()
    before, glance = robot.step(), robot.glance()
    x, y, heading = robot.pose
    robot.move_ball(x + 1500 * math.cos(heading + 0.3), y + 1500 * math.sin(heading + 0.3))
    assert robot.glance()["eye"] != glance["eye"] == before["eye"]
    frame = robot.step()
    assert frame["edits"] == 1
    assert frame["seen"][0] == pytest.approx(0.3, abs=0.15)
    robot.move_ball(1e6, -1e6)  # as far as the carpet goes
    assert robot.ball == (2958.0, -1958.0)


def test_a_pushed_robot_is_not_told():
    robot = Robot()
    robot.step()
    believed, pose = robot.frame()["estimate"], robot.pose
    robot.push(100.0, 0.2)
    assert robot.frame()["estimate"] == believed
    assert robot.pose[2] == pytest.approx(pose[2] + 0.2)
    assert math.dist(robot.pose[:2], pose[:2]) == pytest.approx(100)


def spread(frame):
    return np.ptp(np.array(frame["belief"]), axis=0)


def test_noise_widens_the_belief_and_dropout_widens_it_more():
    quiet, noisy, blind = (
        walked(6, **settings)[-1] for settings in ({}, {"noise": 300}, {"dropout": 1.0})
    )
    assert (spread(noisy) > 2 * spread(quiet)).all() and (spread(blind) > spread(noisy)).all()
    assert blind["seen"] is None and "not seen" in blind["words"]


def test_noise_can_be_turned_up_and_down_again_on_the_way():
    robot, steady = Robot(), Robot()
    robot.set(noise=300)
    noisy, quiet = robot.step(), steady.step()
    robot.set()
    for _ in range(6):
        later, calm = robot.step(), steady.step()
    assert (spread(noisy) > 1.3 * spread(quiet)).all()
    np.testing.assert_allclose(spread(later), spread(calm), rtol=0.5)


def test_drift_leads_astray():
    def drifted(drift):
        robot = Robot()
        robot.set(driver=CHANCE, drift=drift)
        start = robot.pose
        robot.step()
        return robot.pose[1] - start[1]

    assert drifted(10.0) > drifted(0.0) + 20


def test_who_is_at_the_wheel_decides():
    def share(driver):
        robot = Robot()
        robot.set(driver=driver)
        while robot.episodes < 12:
            robot.advance(filming=False)
        return robot.wins / robot.episodes

    assert share(PLANNER) == share(TRAINED) == 1 and share(CHANCE) < 0.8


def brief(**options):
    """An agent that soon has learned all that it will."""
    learning = TrainingSettings(patterns=150, exploration=400, exploitation=300)
    return Arkaq(0.3, learning=learning, rng=3, **options)


def test_an_agent_learns_before_ones_eyes_as_it_does_alone():
    robot, lengths, states = Robot(agents={"mine": brief()}), [], set()
    while robot.agent.phase != "finished":
        robot.advance(filming=False)
        lengths.append(len(robot.curve.points))
        states |= {robot.state, *robot.passed}
    alone = brief().learn(approach.make_task(), progress=False)
    np.testing.assert_array_equal(robot.agent.q.Q, alone.q.Q)
    assert lengths[-1] > 5 and lengths == sorted(lengths)
    assert {"supervisor", "network", "explore", "exploit", "evaluate"} <= states
    assert robot.step()["values"]  # it goes on, with what it has learned


def test_senses_that_change_while_it_learns_do_not_end_the_run():
    robot = Robot(agents={"mine": brief()})
    for noise in (0, 200, 0):
        robot.set(noise=noise)
        assert "segmentation" in robot.step()["words"]


def test_parts_of_ones_own_have_a_map_and_a_wheel():
    agent = brief(segmenter=UniformGrid((4, 6))).learn(approach.make_task(), progress=False)
    robot = Robot(agents={"grid": agent, "ahead": lambda episode: lambda look, info: 0})
    frame = robot.frame(whole=True)
    assert len(frame["map"]) == 24
    corners = np.array([np.reshape(cell, (-1, 2)).mean(axis=0) for cell in frame["map"]])
    nearest = np.abs((corners - frame["estimate"]) / [1, 4000]).sum(axis=1).argmin()
    assert frame["cell"] == nearest
    robot.set(driver="ahead", vigilance=0.2)
    assert {robot.step()["action"] for _ in range(5)} == {0}


def test_another_vigilance_has_another_map_with_the_values_of_the_first():
    agent, patterns = approach.load_agent(), segmentation.recorded_patterns()
    coarse = regrouped(agent, patterns, 0.4)
    state = coarse.art.predict(patterns)
    values = agent.q.Q[agent.art.predict(patterns)]
    for s in range(coarse.art.n_clusters_):
        held = values[state == s]
        low, high = held.min(axis=0) - 20, held.max(axis=0) + 20  # the center counts too
        assert ((low <= coarse.q.Q[s]) & (coarse.q.Q[s] <= high)).all()
    robot = Robot()
    fine = len(robot.frame(whole=True)["map"])
    robot.set(vigilance=0.4)
    assert len(robot.step()["map"]) == coarse.art.n_clusters_ < fine


def test_the_goal_is_shot_at_and_the_ball_is_seen_to_roll():
    robot = Robot("goal")
    kicks = [frame for frame in (robot.step() for _ in range(30)) if frame["outcome"]]
    assert len(kicks) > 3
    for kick in kicks:
        rows = kick["motion"]
        times = [row[0] for row in rows]
        assert times == sorted(times) and len(rows) > 20
        steps = np.diff([row[5:7] for row in rows[1:]], axis=0)
        assert np.hypot(*steps.T).max() < 250  # no jump
        assert any(len(row) == 9 for row in rows)  # the paw
    assert all(kick["outcome"].startswith(("a goal", "no goal")) for kick in kicks)


def test_a_robot_that_must_look_around_for_the_goal_starts_all_the_same():
    robot = Robot("goal")
    for seed in (5, 6):  # at first it looks the other way
        robot.set(seed=seed)
        assert len(robot.frame()["motion"]) == 1


def test_a_curve_stays_short_and_keeps_the_mean():
    curve = Curve()
    for value in range(4096):
        curve.add(value)
        assert len(curve.points) < 100
    assert np.mean([mean for _, mean in curve.points]) == pytest.approx(np.mean(range(4096)))
    assert curve.points[-1][0] == 4096


def test_a_race_starts_every_episode_alike_and_waits():
    duel = race()
    left, right = duel.robots
    starts = []
    while len(starts) < 4:
        for robot in duel._go():
            if robot is None:
                assert left.over or right.over
        if left.cycles == 0 == right.cycles and not left.over:
            assert left.pose == right.pose and left.ball == right.ball
            starts.append(left.ball)
    assert len(set(starts)) == 4


class Page:
    """What a page does: it asks, and gets what was sent."""

    def __init__(self, explorer):
        self.explorer, self.got = explorer, []
        explorer.view.send = self.get

    def get(self, content, buffers=None):
        self.got.append(json.loads(json.dumps(content)))

    def ask(self, **message):
        self.explorer._asked(None, message, [])
        assert self.explorer.error is None
        return self.got[-1]


def test_a_page_gets_a_frame_for_each_question_and_only_one():
    page = Page(live_robot())
    whole = page.ask(kind="hello")
    assert whole["kind"] == "whole" and {"map", "best", "curve"} <= whole["frames"][0].keys()
    sent = page.ask(kind="next", after=whole["number"], seconds=0)
    assert sent["number"] == whole["number"] + 1 and "map" not in sent["frames"][0]
    page.ask(kind="next", after=whole["number"], seconds=0)  # a second view, late
    assert page.got[-1] is sent
    many = page.ask(kind="next", after=sent["number"], seconds=0.05)
    assert page.explorer.robots[0].cycles > 2 or page.explorer.robots[0].episodes
    assert many["number"] == sent["number"] + 1


def test_a_page_moves_the_ball_and_the_robot():
    explorer = live_robot()
    page, robot = Page(explorer), explorer.robots[0]
    ball, pose = robot.ball, robot.pose
    glance = page.ask(kind="push", what="ball", lane=0, way=[0, 1])["glances"][0]
    assert robot.ball == (ball[0], ball[1] + 100)
    assert glance["row"][5:7] == pytest.approx(robot.ball, abs=0.1)
    page.ask(kind="push", what="robot", lane=0, way=[1, 0])
    assert robot.pose[2] < pose[2]
    page.ask(kind="put", what="robot", lane=0, to=[0.0, 300.0])
    assert robot.pose[:2] == (0.0, 300.0)


def test_controls_reach_the_robot_and_an_error_is_shown():
    explorer = live_robot()
    page, controls = Page(explorer), explorer.controls
    controls["noise"].value, controls["drift"].value = 200, 5.0
    assert explorer.robots[0].noise == 200
    assert explorer.robots[0].senses.world.legs.slide == pytest.approx(0.35)
    controls["driver"].value = CHANCE
    assert page.got[-1]["frames"][0]["title"] == CHANCE
    controls["play"].value, controls["speed"].value = True, 0.0
    assert explorer.view.playing and explorer.view.speed == 0
    explorer._asked(None, {"kind": "put", "what": "ball", "lane": 0, "to": ["far", "away"]}, [])
    assert "ValueError" in explorer._message.value


def test_an_agent_that_fails_is_told_and_can_be_replaced():
    actions = iter([0, 7])
    explorer = live_robot(agents={"mine": lambda episode: lambda look, info: next(actions)})
    page = Page(explorer)
    explorer.controls["play"].value = True
    explorer._asked(None, {"kind": "step"}, [])
    assert "action must be" in explorer._message.value and not explorer.view.playing
    explorer.controls["driver"].value = CHANCE
    page.ask(kind="step")
    assert explorer.robots[0].cycles == 0  # it began again
    page.ask(kind="step")
    assert explorer.robots[0].cycles == 1 and explorer._message.value == ""


def test_closing_leaves_neither_widget_nor_robot():
    before = set(ipywidgets.Widget._instances if hasattr(ipywidgets.Widget, "_instances") else ())
    explorer = live_robot()
    gone = weakref.ref(explorer.robots[0])
    explorer.step()
    explorer.close()
    assert explorer.view.comm is None and explorer.controls["speed"].comm is None
    assert set(getattr(ipywidgets.Widget, "_instances", ())) == before
    del explorer
    gc.collect()
    assert gone() is None


def test_without_a_kernel_there_is_a_picture_and_a_sentence():
    explorer = race("goal")
    bundle, _ = explorer._repr_mimebundle_()
    assert bundle["image/png"].startswith(b"\x89PNG")
    assert bundle["text/plain"] == repr(explorer) == explorer.drawn.fact
    assert repr(explorer).startswith("the trained agent; cycle 0: turn") and "chance" in repr(
        explorer
    )

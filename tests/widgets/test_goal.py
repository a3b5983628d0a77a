"""The scoring explorer without a browser, and its quick kicks beside the physics."""

import re

import numpy as np
import pandas as pd
import pytest

from arkaq_edu.envs.score_goal import KICK, STARTS
from arkaq_edu.experiments import goal
from arkaq_edu.experiments.goal import aiming, kicks, planning
from arkaq_edu.experiments.goal.planning import ORIENTATIONS
from arkaq_edu.field import pitch
from arkaq_edu.figures.drawing import style
from arkaq_edu.mdp import MDP, value_iteration
from arkaq_edu.widgets import goal as widgets
from arkaq_edu.widgets import scoring_explorer
from arkaq_edu.widgets.scene import Cells, Line, Points, Text

DISTANCE = STARTS["near"].distance
CENTERS = np.linspace(-0.9, 0.9, 13)[:, None]
FACT = re.compile(
    r"([\d,]+) mm, spread ([\d.]+), (\d+) states? at vigilance ([\d.]+): "
    r"(\d+) % score; the best (\d+) %, random (\d+) %"
)


@pytest.fixture(scope="module")
def explorer():
    return scoring_explorer()


@pytest.fixture
def moved(explorer):
    """A function that sets sliders, the others at their default, and returns what is stated."""
    default = {"distance": 1850, "spread": 1.0, "vigilance": 0.06}

    def set_to(**values):
        for name, value in (default | values).items():
            explorer.controls[name].value = value
        assert explorer.error is None
        return [float(x.replace(",", "")) for x in FACT.fullmatch(repr(explorer)).groups()]

    return set_to


@pytest.fixture(scope="module")
def paths():
    return kicks.ball_paths()


@pytest.fixture(scope="module")
def trials():
    """Kicks of the physics, before the goal."""
    return goal.kick_trials("near", np.linspace(-0.48, 0.48, 9), n=250)


def of_kind(panel, kind):
    return [layer for layer in panel.layers if isinstance(layer, kind)]


def test_the_quick_kicks_score_as_often_as_those_of_the_physics(paths, trials):
    quick = kicks.chance(paths, DISTANCE, trials.orientation)
    share = trials.goals / trials.kicks
    # Two standard errors of 250 kicks and of 500, and what posts and panels throw back.
    assert np.abs(quick - share).max() < 2 * np.sqrt(0.25 / 250 + 0.25 / 500) + 0.03
    assert abs(quick.mean() - share.mean()) < 0.03


def test_best_and_random_are_those_of_the_best_policy(paths):
    chance = aiming.chance_on_grid(paths, DISTANCE)
    counted = pd.DataFrame({"orientation": ORIENTATIONS, "kicks": 1.0, "goals": chance})
    found = goal.best_policy("near", counted)
    values = aiming.probabilities(chance, CENTERS, np.full(len(CENTERS), KICK))
    assert mean(values["best"]) == pytest.approx(found.goals)
    assert mean(values["random"]) == pytest.approx(found.random)
    assert values["learned"] == pytest.approx(chance), "who kicks at once gets the kick"


def mean(values):
    return planning.mean_over_starts(values, STARTS["near"])


def test_the_program_is_value_iteration_over_a_finite_horizon(paths):
    n, chance = len(ORIENTATIONS), aiming.chance_on_grid(paths, DISTANCE)
    T, R = np.zeros((3, n + 1, n + 1)), np.zeros((n + 1, 3))
    for place, unit in enumerate(np.eye(n)):
        T[:KICK, :n, place] = planning.after_turns(unit)
    T[:, :, n] = 1 - T.sum(axis=2)  # kicked, or too far to the side
    R[:n, KICK] = chance
    values, _ = value_iteration(MDP(T, R, gamma=1 - 1e-12), horizon=planning.PATIENCE)
    best = planning.goal_probability(chance, planning.best)
    assert values[:n] == pytest.approx(best, abs=1e-9)


def test_the_value_of_a_policy_is_what_its_kicks_score(paths):
    chance = aiming.chance_on_grid(paths, DISTANCE)
    actions = aiming.plan(chance, CENTERS)
    learned = mean(aiming.probabilities(chance, CENTERS, actions)["learned"])
    aims = aiming.last_aims(CENTERS, actions, n=4000)
    assert len(aims) == 4000
    assert np.interp(aims, ORIENTATIONS, chance).mean() == pytest.approx(learned, abs=0.01)


def test_a_policy_that_turns_away_never_scores(paths):
    chance = aiming.chance_on_grid(paths, DISTANCE)
    turn_left = np.zeros(len(CENTERS), int)
    assert mean(aiming.probabilities(chance, CENTERS, turn_left)["learned"]) == 0.0
    assert len(aiming.last_aims(CENTERS, turn_left, n=10)) == 0


def test_the_map_turns_to_the_goal_and_kicks_before_it(paths):
    actions = aiming.plan(aiming.chance_on_grid(paths, DISTANCE), CENTERS)
    text = "".join("rlk"[(1, 0, 2)[action]] for action in actions)
    assert re.fullmatch("r+k+l+|l+k+r+", text), text
    assert text[0] == "r", "a goal to the right wants a turn to the right"


def test_a_spread_of_one_is_as_kicked_and_of_none_always_the_same(paths):
    assert np.allclose(kicks.spread_out(paths, 1.0), paths)
    ends = kicks.spread_out(paths, 2.0)[:, -1] - paths[:, -1].mean(axis=0)
    assert np.allclose(ends.std(axis=0), 2 * paths[:, -1].std(axis=0))
    assert set(kicks.chance(kicks.spread_out(paths, 0.0), DISTANCE, [0.0, 1.0])) == {0.0, 1.0}


def test_a_goal_to_the_left_is_hit_by_a_kick_to_the_left():
    left = np.array([[[0.0, 0.0], [1900 * np.cos(0.2), 1900 * np.sin(0.2)]]])
    straight = kicks.chance(left, 1500.0, [-0.2, 0.0, 0.2])
    assert straight.tolist() == [0.0, 1.0, 1.0]
    depth, across = kicks.on_the_field(left, 1500.0, [0.2])[0, -1]
    assert (depth, across) == pytest.approx((400.0, 0.0), abs=1e-9)


@pytest.mark.parametrize("distance", [1000, 1850, 3000])
@pytest.mark.parametrize("spread", [0.0, 1.0, 2.0])
@pytest.mark.parametrize("vigilance", [0.02, 0.06, 1.2])
def test_every_corner_is_drawn_and_in_order(moved, explorer, distance, spread, vigilance):
    d, s, n, v, learned, best, random = moved(distance=distance, spread=spread, vigilance=vigilance)
    assert (d, s, v) == (distance, spread, vigilance)
    assert random <= best and learned <= best
    field, shares = explorer.drawn.panels
    strip = of_kind(shares, Cells)[0]
    assert len(strip.polygons) == n
    assert sum(np.ptp(polygon[:, 0]) for polygon in strip.polygons) == pytest.approx(1.0)
    words = of_kind(field, Text)[0].text
    kicks, goals = map(int, re.fullmatch(r"(\d+) kicks, (\d+) goals", words).groups())
    assert goals <= kicks <= 120
    assert of_kind(field, Points)[0].y == [-distance]


def test_each_slider_does_what_the_chapter_says(moved):
    scored = [moved(distance=d)[4:] for d in (1000, 1850, 3000)]
    assert scored == sorted(scored, reverse=True), "farther away everybody scores less"
    steady = [moved(spread=s)[4] for s in (0.0, 0.5, 1.0, 2.0)]
    assert steady == sorted(steady, reverse=True) and steady[0] > 95
    maps = [moved(vigilance=v)[2:5] for v in widgets.VIGILANCES]
    states, _, learned = zip(*maps, strict=True)
    assert list(states) == sorted(states, reverse=True) and states[-1] == 1
    assert max(learned[:10]) - min(learned[:10]) <= 3, "finer gains nothing"
    assert learned[-1] < learned[0] - 15, "a single state has only one answer"
    _, _, _, _, learned, best, random = moved()
    assert best - learned < 8 and learned - random > 20


def test_the_fan_shows_goals_inside_the_goal_in_our_color(moved, explorer):
    moved()
    lines = of_kind(explorer.drawn.panels[0], Line)
    (goals,) = [line for line in lines if line.color == style.OURS]
    depth, across = np.array(goals.y), np.array(goals.x)
    behind = depth > pitch.BALL_RADIUS
    assert behind.any() and np.abs(across[behind]).max() <= pitch.GOAL_WIDTH / 2
    said = of_kind(explorer.drawn.panels[0], Text)[0].text
    assert int(re.search(r"(\d+) goals", said)[1]) == np.isnan(depth).sum()


def test_patterns_of_the_wrong_shape_are_refused():
    with pytest.raises(ValueError, match="patterns"):
        scoring_explorer([[0.0, 1.0]])
    with pytest.raises(ValueError, match="distance"):
        kicks.chance(kicks.ball_paths(), 100.0, [0.0])
    with pytest.raises(ValueError, match="factor"):
        kicks.spread_out(kicks.ball_paths(), -1.0)


def test_the_colors_of_the_strip_are_those_of_the_actions(moved, explorer):
    moved()
    strip = of_kind(explorer.drawn.panels[1], Cells)[0]
    middle = next(
        color for polygon, color in zip(strip.polygons, strip.colors, strict=True)
        if polygon[:, 0].min() <= 0 <= polygon[:, 0].max()
    )  # fmt: skip
    assert strip.palette[middle] == style.ACTIONS["kick"]
    assert strip.palette[strip.colors[0]] == style.ACTIONS["right"], "orientations begin at -.5"
    assert strip.palette[strip.colors[-1]] == style.ACTIONS["left"]
    assert widgets.draw(goal.patterns(goal.load_sightings())).fact == explorer.drawn.fact

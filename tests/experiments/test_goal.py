"""Score a goal: the recorded streams, the trained agents, and the best that can be done."""

import hashlib
import re

import numpy as np
import pandas as pd
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from arkaq_edu._paths import data_file
from arkaq_edu.arkaq import Estimator, Sensing, TrainingSettings
from arkaq_edu.art import EuclideanART
from arkaq_edu.envs.score_goal import KICK, STARTS, TURN_LEFT, TURN_RIGHT
from arkaq_edu.experiments import approach, count_centers, goal, thesis_numbers
from arkaq_edu.experiments.goal import studies

BRIEF = TrainingSettings.goal(patterns=150, exploration=200, exploitation=100)
PRINTED = {0.075: 9, 0.06: 13, 0.05: 18}


@pytest.fixture(scope="module")
def stream():
    return goal.load_sightings()


@pytest.fixture(scope="module")
def study():
    return goal.load_study()


# Segmentation


def test_the_recorded_stream_is_what_its_recipe_records(stream):
    again = goal.record_sightings()
    pd.testing.assert_frame_equal(stream, again, check_exact=False, rtol=1e-9)


def test_the_readme_states_the_hash_of_the_stream():
    readme = data_file("README.md").read_text()
    stated = re.search(r"## goal_orientations.csv.*?SHA-256: `(\w+)`", readme, re.S).group(1)
    assert hashlib.sha256(data_file("goal_orientations.csv").read_bytes()).hexdigest() == stated


def test_one_recipe_gives_all_three_counts_of_the_thesis_over_many_seeds(stream):
    counts = goal.load_center_counts()
    assert len(counts) >= 20
    for vigilance, printed in PRINTED.items():
        low, high = counts[vigilance].quantile([0.025, 0.975])
        assert low <= printed <= high
    ours = count_centers(goal.patterns(stream), goal.VIGILANCES)
    assert ours.tolist() == counts.loc[0].tolist()
    numbers = thesis_numbers()
    assert {rho: numbers[f"goal centers, vigilance {rho:g}"] for rho in PRINTED} == PRINTED


@pytest.mark.parametrize("half_width", [0.3, 0.4, 0.5, 0.6, 1.0])
def test_no_even_cover_of_any_range_gives_all_three_counts(half_width):
    """From .075 to .05 the counts double; where patterns lie evenly they grow by half."""
    eta, inside = TrainingSettings.goal().learning_rate, []
    for vigilance, printed in PRINTED.items():
        counts = [
            EuclideanART(vigilance, eta)
            .fit(np.random.default_rng(seed).uniform(-half_width, half_width, (2000, 1)))
            .n_clusters_
            for seed in range(20)
        ]
        inside.append(np.quantile(counts, 0.025) <= printed <= np.quantile(counts, 0.975))
    assert not all(inside)


def test_the_goal_is_seen_in_islands_a_turn_apart_that_cover_less_than_half(stream):
    X = goal.patterns(stream)
    turn = 2 * Sensing.goal().B[0][TURN_RIGHT]
    inside = X[np.abs(X) < 1]
    phase = 2 * np.pi * inside / turn
    assert np.abs(np.exp(1j * phase).mean()) > 0.7, "the islands"
    assert 0.3 < goal.coverage(X) < 0.5


@settings(max_examples=30)
@given(st.lists(st.floats(-1, 1), min_size=1, max_size=30), st.floats(0.01, 0.3))
def test_coverage_is_the_share_of_places_near_a_pattern(values, width):
    grid = np.linspace(-1, 1, 20_001)
    near = np.abs(grid[:, None] - np.array(values)).min(axis=1) <= width / 2
    assert goal.coverage(np.array(values)[:, None], width) == pytest.approx(near.mean(), abs=0.003)


def test_every_look_about_begins_straight_and_never_kicks(stream):
    assert set(stream.action) == {-1, TURN_LEFT, TURN_RIGHT}
    starts = stream[stream.cycle == 0]
    assert (starts.true_orientation == 0).all() and (starts.action == -1).all()
    assert stream.cycle.max() == TrainingSettings.goal().period


# Senses


def test_the_filters_settings_are_those_that_the_stream_measures(stream):
    measured, used = goal.calibrate(stream), Sensing.goal()
    np.testing.assert_allclose(measured.B, used.B, atol=0.001)
    np.testing.assert_allclose(np.sqrt(measured.Q), np.sqrt(used.Q), rtol=0.15)
    np.testing.assert_allclose(np.sqrt(measured.R), np.sqrt(used.R), rtol=0.15)


def test_innovations_are_as_large_as_the_filter_believes():
    fresh = goal.record_sightings(n=800, seed=77)
    senses, nis = Estimator(Sensing.goal()), []
    for row in fresh.itertuples():
        if row.cycle == 0:
            senses.reset()
        look = np.array([row.orientation, row.visible])
        senses.observe(look, None if row.cycle == 0 else row.action)
        if row.cycle > 0 and row.visible and abs(row.true_orientation) < 0.5:
            nis.append(senses.kalman.nis)
    # The 99.9 % band of the mean of chi-square(1), doubled: pixels are not Gaussian.
    assert np.mean(nis) == pytest.approx(1, abs=2 * 3.29 * np.sqrt(2 / len(nis)))


# The best there is


def test_the_trials_kept_with_the_course_are_what_kicking_gives():
    kept = goal.load_kick_trials("far")
    row = kept[kept.orientation == 0.1]
    again = goal.kick_trials("far", [0.1])
    assert again.values.tolist() == row.values.tolist()


@pytest.mark.parametrize("distance", ["near", "far"])
def test_the_best_policy_earns_what_dynamic_programming_says(distance):
    """Play it out on the same chances, without any grid of values."""
    best = goal.best_policy(distance)
    rng, n = np.random.default_rng(0), 40_000
    start = STARTS[distance]
    o = rng.uniform(start.least, start.most, n) * rng.choice([-1, 1], n)
    sensing = Sensing.goal()
    first, step = best.orientation[0], best.orientation[1] - best.orientation[0]
    for follow, expected in ((True, best.goals), (False, best.random)):
        place, kicked, goals = o.copy(), np.zeros(n, bool), 0.0
        for turns_left in range(30, 0, -1):
            nearest = np.rint((place - first) / step).astype(int).clip(0, len(best.value) - 1)
            action = best.action[turns_left - 1, nearest] if follow else rng.integers(3, size=n)
            now = ~kicked & (action == KICK)
            goals += np.interp(place[now], best.orientation, best.chance).sum()
            kicked |= now
            turn = sensing.B[0][TURN_RIGHT] + np.sqrt(sensing.Q[0][0]) * rng.standard_normal(n)
            place += np.where(action == TURN_LEFT, -turn, turn)
        assert goals / n == pytest.approx(expected, abs=0.01)


def test_dynamic_programming_knows_what_can_be_seen_without_it():
    sure = pd.DataFrame({"orientation": [-9.0, 9.0], "kicks": 10, "goals": 4})
    best = goal.best_policy("near", sure)
    inner = np.abs(best.orientation) < 0.5
    assert (best.action[:, inner] == KICK).all()
    assert best.value[inner] == pytest.approx(0.4)
    # One look, one choice in three of a kick.
    once = goal.best_policy("near", sure, patience=1)
    assert once.random == pytest.approx(0.4 / 3)


# Goals against kicks


def test_the_study_is_over_thirty_seeds_and_shows_what_the_thesis_says(study):
    shares = goal.rates(study)
    assert len(shares) >= 30 and shares.notna().all(axis=None)
    mean, error = shares.mean(), shares.std() / np.sqrt(len(shares))
    for distance in ("near", "far"):
        best = goal.best_policy(distance)
        learned, chance = mean[distance, "ARKAQ, learned"], mean[distance, "random actions"]
        assert learned > 100 * best.goals - 3
        assert mean[distance, "oracle"] < 100 * best.goals + 3
        # What the program says of random actions, playing them has found.
        assert chance == pytest.approx(
            100 * best.random, abs=4 * error[distance, "random actions"] + 1
        )
    for who, printed in (("ARKAQ", 60), ("ARKAQ, learned", 60), ("random actions", 35)):
        assert mean["near", who] == pytest.approx(printed, abs=5)
    assert mean["far", "ARKAQ, learned"] > 2 * mean["far", "random actions"]


def test_the_curves_are_together_at_first_and_apart_later(study):
    for distance in ("near", "far"):
        mine = study[study.goal_distance == distance].pivot_table(
            index="kicks", columns="who", values="goals", aggfunc="mean"
        )
        apart = (mine["ARKAQ"] - mine["random actions"]) / goal.BLOCK
        assert abs(apart.iloc[:2].mean()) < 0.06
        assert apart.iloc[-4:].mean() > 0.18


@pytest.mark.parametrize("distance", ["near", "far"])
def test_training_again_gives_the_courses_agent_and_its_share_of_the_study(
    study, distance, monkeypatch
):
    agent, kept = goal.train(0, goal_distance=distance, progress=False), goal.load_agent(distance)
    np.testing.assert_allclose(agent.q.Q, kept.q.Q, rtol=1e-12, atol=1e-12)
    assert agent.history == kept.history, "every step and every reward"
    monkeypatch.setattr(goal, "train", lambda *args, **options: agent)
    ours = study[(study.goal_distance == distance) & (study.seed == 0)]
    pd.testing.assert_frame_equal(goal.play(0, distance), ours.reset_index(drop=True))


@pytest.mark.parametrize("distance", ["near", "far"])
def test_the_courses_agents_aim_and_kick(distance):
    agent = goal.load_agent(distance)
    assert agent.vigilance == goal.VIGILANCE[distance]
    played = goal.evaluate(goal.greedy(agent), 60, seed=3, goal_distance=distance)
    assert played.kicked.mean() > 0.95
    assert played.aim.abs().mean() < 0.12 < played.start.abs().mean()


def test_every_policy_has_the_same_starts():
    one, other = (goal.evaluate(p, 5, seed=2) for p in (goal.planner(), goal.at_random()))
    assert (one.start == other.start).all()
    assert one.aim.abs().max() <= Sensing.goal().B[0][TURN_RIGHT] / 2


def test_a_study_is_its_plays_whatever_the_number_of_processes(monkeypatch):
    def brief(seed, distance):
        return long(seed, distance, kicks=50, fresh=50, learning=BRIEF)

    long = goal.play
    monkeypatch.setattr(studies, "play", brief)
    table = goal.study(seeds=1, jobs=1, progress=False)
    expected = pd.concat([brief(0, "near"), brief(0, "far")], ignore_index=True)
    pd.testing.assert_frame_equal(table, expected)
    assert set(table.who) == {"ARKAQ", "ARKAQ, learned", "random actions", "oracle"}


def test_rates_are_of_the_last_kicks_of_whoever_learns():
    rows = [(who, k, g) for who in ("ARKAQ", "oracle") for k, g in ((50, 10), (100, 30))]
    table = pd.DataFrame(rows, columns=["who", "kicks", "goals"]).assign(
        goal_distance="near", seed=0
    )
    assert goal.rates(table, last=50).loc[0].to_dict() == {
        ("near", "ARKAQ"): 60.0,
        ("near", "oracle"): 40.0,
    }


def test_a_shot_is_a_film_of_what_the_agent_does():
    shot = goal.record_episode(goal.load_agent(), orientation=-0.3, seed=1)
    assert shot.table.orientation.iloc[0] == pytest.approx(-0.3, abs=1e-3)
    assert shot.table.action.tolist()[-2:] == [KICK, -1]
    assert len(shot.frames) == len(shot.looks) > len(shot.table)
    assert shot.looks == sorted(shot.looks)
    assert set(shot.looks) == set(range(len(shot.table)))
    assert not np.array_equal(shot.frames[0], shot.frames[-1])


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (lambda: goal.train(goal_distance="close"), "goal_distance must be 'near' or 'far'"),
        (lambda: goal.load_agent("close"), "goal_distance must be 'near' or 'far'"),
        (lambda: goal.load_kick_trials("close"), "goal_distance must be 'near' or 'far'"),
        (lambda: goal.best_policy("close"), "goal_distance must be 'near' or 'far'"),
        (lambda: goal.kick_trials("close", [0.0]), "goal_distance must be 'near' or 'far'"),
        (lambda: goal.rates(goal.load_study(), last=0), "last must be an integer >= 50, got 0"),
        (lambda: goal.record_sightings(n=0), "n must be an integer >= 1, got 0"),
        (lambda: goal.record_sightings(period=0), "period must be"),
        (lambda: goal.evaluate(goal.planner(), 0), "n must be"),
        (lambda: goal.kick_trials(100.0, [0.0]), "distance must be"),
        (lambda: goal.best_policy("near", patience=0), "patience must be"),
        (lambda: goal.record_episode(approach.load_agent()), "agent must have learned to score"),
        (lambda: goal.curve([True], block=0), "block must be"),
        (lambda: goal.study(seeds=0), "seeds must be"),
    ],
)
def test_bad_input_is_refused_by_name(call, words):
    with pytest.raises(ValueError, match=re.escape(words)):
        call()

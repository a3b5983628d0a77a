"""The experiments: the recorded stream, the trained agent, and the numbers they give."""

import hashlib
import re

import numpy as np
import pandas as pd
import pytest

from arkaq_edu._paths import data_file
from arkaq_edu.arkaq import Arkaq, Sensing, TrainingSettings
from arkaq_edu.experiments import (
    approach,
    count_centers,
    goal,
    learning_curve,
    mean_nis,
    results,
    thesis_numbers,
)
from arkaq_edu.experiments.approach import calibrate, evaluate, planner, record_sightings, train

BRIEF = TrainingSettings(patterns=300, exploration=1500, exploitation=500)


@pytest.fixture(scope="module")
def stream():
    return approach.load_sightings()


@pytest.fixture(scope="module")
def agent():
    return approach.load_agent()


def test_the_recorded_stream_is_what_its_recipe_records(stream):
    pd.testing.assert_frame_equal(stream, record_sightings(), check_exact=False, rtol=1e-9)


def test_the_readme_states_the_hash_of_the_stream():
    stated = re.search(r"SHA-256: `(\w+)`", data_file("README.md").read_text()).group(1)
    assert hashlib.sha256(data_file("sightings.csv").read_bytes()).hexdigest() == stated


def test_one_stream_and_one_eta_give_all_five_counts_of_the_thesis(stream):
    counts = count_centers(approach.patterns(stream))
    printed = thesis_numbers()
    assert len(counts) == 5
    for vigilance, n in counts.items():
        assert n == pytest.approx(printed[f"centers, vigilance {vigilance:g}"], rel=0.15)


def test_the_stream_is_seen_with_an_error_that_grows_with_the_distance(stream):
    seen = stream[stream.visible == 1]
    error = (seen.distance - seen.true_distance).abs()
    near, far = error[seen.true_distance < 1500], error[seen.true_distance > 3500]
    assert near.median() < 10 < 50 < far.median()


def test_the_filters_settings_are_those_that_the_stream_measures(stream):
    measured, used = calibrate(stream), Sensing.consistent()
    np.testing.assert_allclose(measured.B[0], np.array(used.B)[0], atol=1.0)
    np.testing.assert_allclose(measured.B[1], np.array(used.B)[1], atol=0.005)
    np.testing.assert_allclose(np.sqrt(np.diag(measured.Q)), np.sqrt(np.diag(used.Q)), rtol=0.15)
    assert measured.range_noise == pytest.approx(used.range_noise, rel=0.1)


@pytest.mark.thesis("errata row 34")
def test_only_one_of_the_two_filters_is_as_sure_of_itself_as_it_may_be():
    fresh = record_sightings(seed=77)
    n = int((fresh.visible[fresh.cycle > 0] == 1).sum())
    # The 99.9 % band of the mean of n values of chi-square(2), doubled: the errors of a camera
    # are not quite Gaussian, nor independent from look to look.
    band = 2 * 3.29 * np.sqrt(2 * 2 / n)
    assert mean_nis(fresh, Sensing.consistent()) == pytest.approx(2, abs=band)
    assert mean_nis(fresh, Sensing.thesis()) > 2 + 10 * band


def test_the_trained_agent_walks_to_the_ball_as_straight_as_a_planner(agent):
    ours = evaluate(approach.greedy(agent), n=150, seed=5)
    plan = evaluate(planner(), n=150, seed=5)
    chance = evaluate(approach.at_random(), n=150, seed=5)
    assert ours.is_success.mean() >= 0.97
    assert ours.detour.median() <= 1.10
    assert ours.bonus.mean() >= 0.70 - 2 * np.sqrt(0.7 * 0.3 / 150)
    assert plan.is_success.all()
    assert chance.is_success.mean() < 0.6
    assert (plan.distance == ours.distance).all(), "the policies must have the same starts"


def test_the_fresh_starts_are_uniform_on_the_visible_field():
    starts = evaluate(lambda episode: lambda observation, info: 1, n=400, seed=9)
    from scipy.stats import kstest

    area = (starts.distance**2 - 600**2) / (4100**2 - 600**2)
    assert kstest(area, "uniform").pvalue > 1e-3
    assert starts.orientation.abs().max() <= np.radians(56.9) / 2


def test_a_trajectory_leads_to_the_ball(agent):
    walked = approach.record_episode(agent, 2500.0, -0.3, seed=4)
    table = walked.table
    assert walked.is_success
    assert walked.reward in (100.0, 150.0)
    assert table.distance.iloc[0] == pytest.approx(2500.0)
    assert table.orientation.iloc[0] == pytest.approx(-0.3)
    assert table.distance.iloc[-1] < 500
    assert table.action.iloc[-1] == -1
    steps = np.hypot(table.x.diff()[1:], table.y.diff()[1:])
    assert ((steps > 80) & (steps < 120)).all()
    again = approach.record_episode(agent, 2500.0, -0.3, seed=4)
    pd.testing.assert_frame_equal(table, again.table)


def test_the_study_kept_with_the_course_is_over_twenty_seeds_and_shows_what_was_aimed_at():
    study = approach.load_study().set_index("quantity")
    assert (study.seeds[study.index.str.startswith("ball reached")] >= 20).all()
    who = "ARKAQ, consistent Kalman filter"
    assert study.loc[f"ball reached (%), {who}", "mean"] >= 99
    assert study.loc[f"ball reached (%), {who}", "low"] >= 97
    assert study.loc[f"way walked over straight way (median), {who}", "mean"] <= 1.10
    assert study.loc[f"+50 earned (%), {who}", "mean"] >= 70


def test_training_again_gives_the_same_agent(tmp_path):
    first = train(seed=3, learning=BRIEF, progress=False)
    second = train(seed=3, learning=BRIEF, progress=False)
    first.save(tmp_path / "first.npz")
    second.save(tmp_path / "second.npz")
    assert (tmp_path / "first.npz").read_bytes() == (tmp_path / "second.npz").read_bytes()


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (lambda: record_sightings(n=0), "n must be an integer >= 1, got 0"),
        (lambda: record_sightings(period=-1), "period must be"),
        (lambda: evaluate(planner(), n=-3), "n must be"),
        (lambda: results(seeds=0), "seeds must be"),
        (lambda: train(vigilance=-0.1), "vigilance must be"),
        (lambda: train(sensing="guess"), "sensing must be"),
    ],
)
def test_bad_input_is_refused_by_name(call, words):
    with pytest.raises(ValueError, match=re.escape(words)):
        call()


def test_the_learning_curve_is_the_mean_of_the_last_episodes():
    agent = Arkaq(rng=0)
    rows = [(3, 0.0), (4, 100.0), (5, 150.0), (2, 50.0)]
    agent.history = [("segmentation", 9, 150.0, True)]
    agent.history += [("Q-learning", cycles, reward, reward > 0) for cycles, reward in rows]
    cycles, reward = learning_curve(agent, window=2)
    assert cycles.tolist() == [7, 12, 14]
    assert reward == pytest.approx([50, 125, 100])


def test_the_two_problems_have_the_same_names():
    shared = (
        "VIGILANCE at_random calibrate describe evaluate greedy load_agent load_sightings "
        "load_study make_task mean_nis patterns planner record_episode record_sightings seed_runs "
        "study train"
    )
    for problem in (approach, goal):
        assert set(shared.split()) <= set(dir(problem))
        assert all(getattr(problem, name) is not None for name in shared.split())

"""The parts that studies compare, and the plans that are stored with the course."""

from itertools import product

import numpy as np
import pytest

from arkaq_edu._paths import data_file
from arkaq_edu.arkaq import Estimator, Experience, TrainingSettings, UniformGrid
from arkaq_edu.art import ART2, ART2A
from arkaq_edu.experiments import approach, mean_nis, read_plan
from arkaq_edu.experiments.parts import (
    AsPrinted,
    AtRandom,
    AveragedQ,
    ComplementCoding,
    TileCoding,
    uncontrolled,
    unfiltered,
)
from arkaq_edu.experiments.trials import PROBLEMS, arrange

FOLDER = data_file("studies/vigilance_goal.toml").parent
PLANS = [path for path in sorted(FOLDER.glob("*.toml")) if read_plan(path)["task"] in PROBLEMS]


def test_tile_coding_is_linear_in_the_weights_of_its_tiles():
    cells, tilings, rng = (6, 5), 3, np.random.default_rng(0)
    learner = TileCoding(cells, tilings)
    learner.begin(30, 2, TrainingSettings(alpha_power=0.5, alpha_least=0.0))
    weights, visits = {}, {}

    def value(s, a):
        return sum(weights.get((*tile, a), 0.0) for tile in tiles(s))

    def tiles(s):
        i, j = divmod(s, 5)
        return [(k, (i + k) // tilings, (j + k) // tilings) for k in range(tilings)]

    for _ in range(200):
        s, a, target = int(rng.integers(30)), int(rng.integers(2)), float(rng.normal())
        visits[s, a] = visits.get((s, a), 0) + 1
        change = (target - value(s, a)) / visits[s, a] ** 0.5
        for tile in tiles(s):
            weights[(*tile, a)] = weights.get((*tile, a), 0.0) + change / tilings
        learner.back_up(s, a, target)
    expected = [[value(s, a) for a in range(2)] for s in range(30)]
    np.testing.assert_allclose(learner.Q, expected, atol=1e-12)
    assert learner.n_tiles == len({tile for s in range(30) for tile in tiles(s)})
    with pytest.raises(ValueError, match="cells must be 31 in all"):
        learner.begin(31, 2, TrainingSettings())


def test_tile_coding_generalizes_where_a_table_does_not():
    learner = TileCoding((8,), 4)
    learner.begin(8, 1, TrainingSettings(gamma=0.5, alpha_power=0.0))
    learner.learn([Experience(3, 0, 0.0, 4, False, 2), Experience(4, 0, 8.0, 0, True, 1)], 1.0)
    assert learner.Q[3, 0] == 0.25 * 8  # what Q-learning has there, too
    assert learner.Q[5, 0] > 0


def test_senses_without_control_are_consistent_and_without_filter_they_are_the_sightings():
    stream = approach.load_sightings()
    assert mean_nis(stream, uncontrolled()) == pytest.approx(2, abs=0.25)
    senses = Estimator(unfiltered())
    for distance, orientation in [(3000.0, 0.2), (1000.0, -0.4), (2500.0, 0.1)]:
        pattern = senses.observe([distance, orientation, 1.0], 1)
        assert pattern == pytest.approx(unfiltered().scale([distance, orientation]), abs=1e-5)


@pytest.mark.parametrize("network", [ART2A(0.99), ART2(0.99)])
def test_complement_coding_tells_patterns_of_one_direction_apart(network):
    coded = ComplementCoding(network)
    labels = [coded.learn_one(np.array([x, x])) for x in (0.1, 0.9, 0.11)]
    assert labels[0] == labels[2] != labels[1]
    assert coded.n_clusters_ == 3
    assert [coded.category(np.array([x, x])) for x in (0.1, 0.9)] == labels[:2]
    assert 0 <= coded.category(np.array([-1.0, 1.0])) <= 2


def test_actions_at_random_and_values_as_printed():
    learner = AtRandom()
    learner.begin(1, 3, TrainingSettings())
    learner.back_up(0, 0, 1.0)
    rng = np.random.default_rng(0)
    drawn = np.bincount([learner.explore(0, rng) for _ in range(3000)])
    assert drawn == pytest.approx(1000, abs=100)  # tried or not
    printed = AsPrinted()
    printed.begin(2, 1, TrainingSettings(gamma=0.5))
    printed.learn([Experience(0, 0, 4.0, 1, True, 5)], 1.0)
    assert printed.Q[0, 0] == 4


def test_the_mean_of_the_values_is_taken_over_the_last_part_only():
    learner = AveragedQ(below=2.0)
    learner.begin(2, 2, TrainingSettings(alpha_power=0.0))
    for temperature, action, reward in [(3.0, 0, 90.0), (1.9, 1, 7.0), (1.0, 0, 2.0)]:
        learner.learn([Experience(0, action, reward, 0, True, 1)], temperature)
    assert learner.mean[0].tolist() == [46.0, 7.0]  # of (90, 7) and (2, 7)
    assert learner.Q[0].argmax() == 1 and learner.greedy(0) == 0


@pytest.mark.parametrize("path", PLANS, ids=lambda path: path.stem)
def test_every_stored_plan_can_be_run(path):
    plan = read_plan(path)
    assert plan["seeds"] == 30
    axes = [v.values() if isinstance(v, dict) else v for v in plan["grid"].values()]
    for values in product(*axes):
        setting = dict(zip(plan["grid"], values, strict=True)) | plan.get("settings", {})
        setting.pop("episodes", None)  # for the judge
        found = arrange(plan["task"], setting)
        learner, segmenter = found.agent["learner"], found.agent["segmenter"]
        if isinstance(learner, TileCoding):
            assert isinstance(segmenter, UniformGrid) and segmenter.cells == learner.cells

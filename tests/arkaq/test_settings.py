"""The parameters of learning and their schedules."""

import math

import numpy as np
import pytest

from arkaq_edu.arkaq import TrainingSettings


def test_schedules():
    training = TrainingSettings(hot=8.0, cold=0.5, alpha_power=0.5, alpha_least=0.25)
    assert [training.alpha(n) for n in (1, 4, 9, 16, 1000)] == [1, 0.5, 1 / 3, 0.25, 0.25]
    assert [training.temperature(p) for p in (0.0, 0.5, 1.0)] == pytest.approx([8.0, 2.0, 0.5])


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("learning_rate", 0), ("patterns", 0), ("period", 0), ("exploration", -1),
        ("exploitation", 2.5), ("hold", 0), ("gamma", 1), ("alpha_power", 2), ("alpha_least", -1),
        ("cold", 0), ("hot", 0.1), ("lost_reward", math.nan), ("cycle_reward", math.inf),
    ],
)  # fmt: skip
def test_bad_parameters_of_learning_are_refused(name, value):
    with pytest.raises(ValueError, match=f"{name}.*{value}"):
        TrainingSettings(**{name: value})


NAMES = [*TrainingSettings().to_json(), "cycle_reward"]


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("value", ["1", None, [1], 1j, np.ma.masked, 10**400, 1e101, math.nan])
def test_what_is_no_number_is_refused_by_name(name, value):
    with pytest.raises(ValueError, match=f"^{name} must be"):
        TrainingSettings(**{name: value})


@pytest.mark.parametrize("name", ["patterns", "period", "hold", "exploration", "exploitation"])
def test_numbers_of_cycles_that_nobody_means_are_refused(name):
    with pytest.raises(
        ValueError, match=rf"{name} must be an integer in \[\d, 1000000000\], got 1"
    ):
        TrainingSettings(**{name: 10**12})


def test_what_is_kept_is_the_number_that_was_checked():
    given = TrainingSettings(patterns=np.array([7]), hot=np.array(20), gamma=np.float32(0.5))
    assert given == TrainingSettings(patterns=7, hot=20.0, gamma=0.5)
    kinds = {name: type(value) for name, value in given.to_json().items()}
    assert kinds["patterns"] is int and kinds["hot"] is float and kinds["gamma"] is float


@pytest.mark.parametrize("visit", [0, -1, 1.5, "1", None])
def test_visits_are_counted_from_one(visit):
    with pytest.raises(ValueError, match="visit must be an integer >= 1"):
        TrainingSettings().alpha(visit)


@pytest.mark.parametrize("progress", [-0.1, 1.1, math.nan, "1", None])
def test_progress_is_a_fraction(progress):
    with pytest.raises(ValueError, match=r"progress must be a number in \[0, 1\]"):
        TrainingSettings().temperature(progress)

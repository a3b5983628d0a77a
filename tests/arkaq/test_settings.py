"""The parameters of learning and their schedules."""

import math

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

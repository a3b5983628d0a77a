"""The docstring of an environment is its specification: it says what the environment does."""

import inspect
import re

import gymnasium
import pytest

import arkaq_edu
from arkaq_edu.envs import BallApproachEnv, POMDPEnv, ScoreGoalEnv

SECTIONS = [
    "Action space", "Observation space", "Rewards", "Starting state", "Episode end",
    "Information", "Version history",
]  # fmt: skip
CLASSES = (BallApproachEnv, POMDPEnv, ScoreGoalEnv)


def section(cls, name):
    return inspect.getdoc(cls).split(f"## {name}\n")[1].split("\n## ")[0]


def rows(text):
    cells = [re.findall(r"[^|]+", line) for line in text.splitlines() if line.startswith("|")]
    return [[cell.strip() for cell in row] for row in cells[2:]]


def test_all_that_is_registered_is_documented():
    registered = {str(spec.entry_point) for spec in gymnasium.registry.values()}
    mine = {place for place in registered if place.startswith(arkaq_edu.__name__)}
    assert mine == {f"{cls.__module__}:{cls.__name__}" for cls in CLASSES}


@pytest.mark.parametrize("cls", CLASSES)
def test_the_sections_and_the_arguments_are_all_there(cls):
    doc = inspect.getdoc(cls)
    assert re.findall(r"^## (.*)$", doc, re.MULTILINE) == SECTIONS
    described = re.findall(
        r"^(\w[\w, ]*) : ", doc.split("Parameters\n---")[1].split("Raises")[0], re.M
    )
    names = [name for line in described for name in line.split(", ")]
    arguments = list(inspect.signature(cls).parameters)
    assert names[: len(arguments)] == arguments


@pytest.mark.parametrize("cls", [BallApproachEnv, ScoreGoalEnv])
def test_the_tables_are_those_of_the_spaces(cls):
    env = cls()
    actions = rows(section(cls, "Action space"))
    assert [int(row[0]) for row in actions] == list(range(env.action_space.n))
    limits = [[float(x) for x in row[-2:]] for row in rows(section(cls, "Observation space"))]
    space = env.observation_space
    assert limits == [pytest.approx(pair) for pair in zip(space.low, space.high, strict=True)]
    assert f"``Box(float32, {space.shape})``" in section(cls, "Observation space")
    assert f"``Discrete({env.action_space.n})``" in section(cls, "Action space")

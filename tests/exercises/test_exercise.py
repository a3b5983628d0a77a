"""What holds for every exercise: its rules, hints and solution, and the words of a notebook."""

import dataclasses
import importlib
import tomllib
from pathlib import Path

import numpy as np
import pytest
from scipy.stats import norm

from arkaq_edu import exercises
from arkaq_edu.art import EuclideanART
from arkaq_edu.exercises import Exercise, ExerciseError
from arkaq_edu.mdp import MDP, QLearner

ALL = [exercise for chapter in exercises.CHAPTERS.values() for exercise in chapter]


def rules():
    """Every known wrong answer: its exercise, its part with cases, the expression and the words."""
    for exercise in ALL:
        cases = None
        for part in exercise.parts:
            cases = part.cases or cases
            if part.right is None:
                for expression, words in part.wrong.items():
                    yield exercise, dataclasses.replace(part, cases=cases), expression, words


@pytest.mark.parametrize(("exercise", "part", "expression", "words"), list(rules()))
def test_a_known_wrong_answer_gets_its_own_words(exercise, part, expression, words):
    wrong = exercise.function(expression)

    def answer(*case):
        if not part.of:
            return wrong(*case)
        results = list(exercise(*case))
        results[exercise.returns.index(part.of)] = wrong(*case)
        return results

    alone = Exercise(
        exercise.right, exercise.praise, exercise.hints, (part,), returns=exercise.returns
    )
    with pytest.raises(ExerciseError) as caught:
        alone.check(answer, rng=0)
    assert str(caught.value) == words


@pytest.mark.parametrize("exercise", ALL)
def test_an_exercise_says_what_is_asked_and_gives_three_hints_and_a_solution(exercise, capsys):
    assert repr(exercise).startswith(f"{exercise.name}(") and ": Return " in repr(exercise)
    fresh = dataclasses.replace(exercise)
    for _ in range(4):
        fresh.hint()
    lines = capsys.readouterr().out.splitlines()
    assert lines[:3] == [f"Hint {n} of 3: {hint}" for n, hint in enumerate(exercise.hints, 1)]
    assert lines[3:] == [f"There are no more hints. {exercise.name}.solution() shows an answer."]
    exercise.solution()
    room = {"np": np, "norm": norm}
    exec(capsys.readouterr().out, room)
    exercise.check(room[exercise.name], rng=0)
    assert capsys.readouterr().out == exercise.praise + "\n"


@pytest.mark.parametrize("chapter", exercises.CHAPTERS)
def test_the_words_of_a_chapter_are_those_of_its_exercises(chapter):
    module = importlib.import_module(f"arkaq_edu.exercises.{chapter}")
    names = [name for name, value in vars(module).items() if isinstance(value, Exercise)]
    assert sorted(names) == sorted(exercise.name for exercise in exercises.CHAPTERS[chapter])
    assert list(tomllib.loads(Path(module.__file__).with_suffix(".toml").read_text())) == names


WORDS = """
[twice]
praise = "Right."
hints = ["Add.", "x + ...", "x + x"]
returns = ["double", "square"]
points = 2

[twice.wrong.double]
"x + 2" = "you add two"

[twice.tell.square]
"found < 0" = "{found} is negative"
otherwise = "{x} times {x} is {wanted}"
"""
TWICE = """
from arkaq_edu.exercises.exercise import Part, exercise

@exercise(double=Part(lambda rng: [(3.0,)]), square=Part())
def twice(x):
    return 2 * x, x * x
"""


@pytest.mark.parametrize(
    ("right", "typo", "message"),
    [
        ("[twice]", "[twiec]", r"chapter\.toml: \[twice\] should have praise.* not nothing"),
        ("hints", "hint", r"\[twice\] should have .*hints.* not praise, hint, returns"),
        ("wrong.double", "wrong.duoble", r"\[twice\.wrong\.duoble\].* the steps double, square"),
        ("wrong.double", "wrogn.double", r"\[twice\] should have .* not .*wrogn"),
        ('"you add two"', "2", r"\[twice\.wrong\.double\] should be texts"),
        ("x + 2", "x + (2", r"chapter\.toml: \[twice\.wrong\.double\]"),
        ("found < 0", "found <", r"chapter\.toml: \[twice\.tell\.square\]"),
        ("{wanted}", "{wanted", r"f-string"),
    ],
)
def test_a_typo_in_the_words_is_found_when_they_are_read(
    right, typo, message, tmp_path, monkeypatch, capsys
):
    monkeypatch.syspath_prepend(tmp_path)
    for name, words in (("rightchapter", WORDS), ("typochapter", WORDS.replace(right, typo))):
        (tmp_path / f"{name}.py").write_text(TWICE)
        (tmp_path / f"{name}.toml").write_text(words)
    twice = importlib.import_module("rightchapter").twice
    with pytest.raises(ExerciseError, match=r"3\.0 times 3\.0 is 9\.0"):
        twice.check(lambda x: (2 * x, 7.0))
    twice.check(twice.right)
    assert capsys.readouterr().out == "Right.\n"
    with pytest.raises((ValueError, SyntaxError), match=message):
        importlib.import_module("typochapter")


@pytest.mark.parametrize("exercise", [e for e in ALL if e.name not in ("rate", "epsilon_greedy")])
def test_fresh_inputs_come_from_the_given_generator(exercise):
    asked = []

    def spy(*arguments):
        asked.append(repr(arguments))
        return exercise(*arguments)

    for seed in (1, 1, 2):
        exercise.check(spy, rng=seed)
    once = len(asked) // 3
    assert asked[:once] == asked[once : 2 * once] != asked[2 * once :]


def test_a_notebook_shows_the_message_and_no_traceback():
    with pytest.raises(ExerciseError) as caught:
        exercises.nearest.check(lambda x, m: 0)
    assert caught.value._render_traceback_() == [f"Not yet: {caught.value}"]
    assert issubclass(ExerciseError, AssertionError), "an autograder counts a failed assertion"


@pytest.mark.parametrize("seed", range(3))
def test_the_right_answers_are_those_of_the_methods(seed):
    """The solutions stand on their own, and agree with what the course runs."""
    rng = np.random.default_rng(seed)
    for T, R, gamma, V in exercises.greedy.parts[0].cases(rng):
        Q = MDP(T, R, gamma).action_values(V)
        assert exercises.greedy(T, R, gamma, V).tolist() == Q.argmax(axis=1).tolist()
        assert exercises.bellman(T, R, gamma, V, 0) == pytest.approx(Q[0].max())
    for q, temperature in exercises.boltzmann.parts[0].cases(rng):
        learner = QLearner(1, len(q), alpha=0.0, gamma=0.0)
        learner.Q[0] = q
        due = learner.probabilities(0, temperature)
        assert exercises.boltzmann(q, temperature) == pytest.approx(due)
    for part in exercises.backup.parts:
        for q, rewards, values, ended, alpha, gamma in part.cases(rng):
            learner = QLearner(2, len(values), alpha=alpha, gamma=gamma)
            learner.Q[0, 0], learner.Q[1] = q, values
            gain = rewards @ gamma ** np.arange(len(rewards))
            learner.update(0, 0, gain, 1, ended, len(rewards))
            new = exercises.backup(q, rewards, values, ended, alpha, gamma)
            assert new == pytest.approx(learner.Q[0, 0])
    stream = rng.uniform(-1, 1, (150, 2))
    centers = stream[:1]
    for pattern in stream[1:]:
        centers = exercises.present(pattern, centers, 0.3, 0.5)
    assert centers == pytest.approx(EuclideanART(0.3, 0.5).fit(stream).cluster_centers_)


@pytest.mark.parametrize(
    ("answer", "says"),
    [
        (lambda *given: [[1.0], [1.0, 2.0]], "should return numbers, not "),
        (lambda *given: 10**400, "should return numbers, not "),
        (lambda *given: "12", "should return numbers, not '12'"),
        (lambda *given: 2j, "should return numbers, not 2j"),
        (lambda *given: {"x": 1}, "should return numbers, not {'x': 1}"),
        (lambda *given: exit(), "leaves Python: return the answer instead"),
        (lambda *given: given, "."),
        (lambda *given: 10**5000, "should return numbers, not "),
    ],
)
@pytest.mark.parametrize("name", ["turn", "scale", "finite_sum", "correct"])
def test_an_odd_answer_is_met_with_plain_words(name, answer, says):
    with pytest.raises(ExerciseError, match=says):
        getattr(exercises, name).check(answer, rng=0)

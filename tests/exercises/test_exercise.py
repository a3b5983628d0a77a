"""What holds for every exercise: its rules, hints and solution, and the words of a notebook."""

import dataclasses
import importlib
import inspect
import json
import linecache
import re
import tomllib
import warnings
from pathlib import Path

import numpy as np
import pytest
from scipy.stats import norm

from arkaq_edu import exercises
from arkaq_edu.art import EuclideanART
from arkaq_edu.exercises import Exercise, solved
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
    assert alone.problem(answer, rng=0) == words


#: Known mistakes of the exercises that are judged by what they do, not by a formula.
IN_WHAT_THEY_DO = {
    "epsilon_greedy": ["means.argmin()", "means.argmax()", "int(rng.integers(len(means)))"],
    "rate": ["0.1", "1 / n", "1 / n**2", "0.5**n"],
    "present": [
        "np.vstack([centers, pattern])",
        "centers",
        "centers + eta * (pattern - centers)",
        "np.where(np.arange(len(centers))[:, None] == nearest(pattern, centers), pattern, centers)",
    ],
}


@pytest.mark.parametrize("exercise", ALL)
def test_three_wrong_answers_at_least_are_told_apart(exercise):
    """That each rule gets its own words is tested above; here what is judged otherwise, too."""
    words = {words for other, _, _, words in rules() if other is exercise}
    for expression in IN_WHAT_THEY_DO.get(exercise.name, ()):
        words.add(exercise.problem(exercise.function(expression), rng=0))
    assert len(words) >= 3
    assert not [said for said in words if "tries. In this one" in said]


@pytest.mark.parametrize("exercise", ALL)
def test_an_exercise_says_what_is_asked_and_gives_three_hints_and_a_solution(exercise, capsys):
    assert repr(exercise).startswith(f"{exercise.name}(") and ": Return " in repr(exercise)
    fresh = dataclasses.replace(exercise)
    hints = [fresh.hint() for _ in range(4)]
    lines = capsys.readouterr().out.splitlines()
    assert lines[:3] == [f"Hint {n} of 3: {hint}" for n, hint in enumerate(exercise.hints, 1)]
    assert lines[3:] == ["There are no more hints. Here is a solution:"]
    assert hints[:3] == [None] * 3 and hints[3] == exercise.solution()
    room = {"np": np, "norm": norm}
    exec(repr(exercise.solution()), room)
    assert exercise.problem(room[exercise.name], rng=0) == ""
    page = exercise.solution()._repr_html_()
    assert page.startswith("<details><summary>") and "open" not in page.split(">")[0]


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
    problem = twice.problem(lambda x: (2 * x, 7.0))
    assert problem == "the double is right; 3.0 times 3.0 is 9.0"
    twice.check(lambda x: (2 * x, x * x))
    assert capsys.readouterr().out == "Right.\n"
    with pytest.raises((ValueError, SyntaxError), match=message):
        importlib.import_module("typochapter")


HAVE_INPUTS = [e for e in ALL if inspect.signature(e).parameters]


@pytest.mark.parametrize(
    "exercise", [e for e in HAVE_INPUTS if e.name not in ("rate", "epsilon_greedy")]
)
def test_fresh_inputs_come_from_the_given_generator(exercise):
    asked = []

    def spy(*arguments):
        asked.append(repr(arguments))
        return exercise(*arguments)

    for seed in (1, 1, 2):
        exercise.problem(spy, rng=seed)
    once = len(asked) // 3
    assert asked[:once] == asked[once : 2 * once] != asked[2 * once :]


# What a student reads


@pytest.fixture
def nis():
    """The exercise as nobody has tried it yet."""
    return dataclasses.replace(exercises.nis)


def test_the_third_wrong_answer_is_offered_a_hint_and_a_blank_one_is_not(nis, capsys):
    def blank(v, S):
        raise NotImplementedError

    said = []
    for answer in [blank] * 4 + [lambda v, S: v @ v] * 3:
        assert nis.check(answer) is nis.right
        said.append(capsys.readouterr().out)
    assert ["exercises.nis.hint()" in words for words in said] == [False] * 6 + [True]
    assert all("goes on with the course's own nis" in words for words in said)

    def answer(v, S):
        return v @ np.linalg.solve(S, v)

    assert nis.check(answer) is answer
    nis.check(blank)
    nis.check(lambda v, S: v @ v)
    assert "hint" not in capsys.readouterr().out, "after a right answer the count starts again"


def test_the_courses_own_function_is_no_answer(nis, capsys, monkeypatch):
    monkeypatch.setattr(solved, "_session", set())
    nis.check(nis.check(lambda v, S: 0 * v @ v))
    assert "run the cell with your answer first" in capsys.readouterr().out
    assert solved.names() == set()


def test_a_wrong_answer_that_nobody_foresaw_is_shown_one_small_input(nis):
    problem = nis.problem(lambda v, S: 7.0, rng=0)
    lines = problem.splitlines()
    assert lines[0] == "nis is right in 0 of 8 tries. In this one it is wrong:"
    assert re.match(r" +innovation = \[-?[\d.]+, -?[\d.]+\]$", lines[1]), "a small one: 2, not 3"
    assert re.match(r" +S = \[\[.*, .*\],$", lines[2])
    assert re.match(r"    yours: 7, which is too (large|small)$", lines[4])
    assert lines[5].startswith("Work this one out by hand")


def test_a_crash_names_the_students_line(nis):
    source = "def nis(v, S):\n    weight = 1 / S\n    return v @ weight @ u\n"
    room = {}
    exec(compile(source, "their cell", "exec"), room)
    linecache.cache["their cell"] = (len(source), None, source.splitlines(True), "their cell")
    problem = nis.problem(room["nis"], rng=0)
    assert "stopped with NameError: name 'u' is not defined" in problem
    assert problem.endswith("in line 3 of your cell: return v @ weight @ u")


@pytest.mark.parametrize(
    ("shape", "says"),
    [((2,), "2 numbers"), ((1, 2), "1 row of 2 numbers")],
)
def test_what_is_asked_and_what_came_is_said_in_words(nis, shape, says):
    problem = nis.problem(lambda v, S: np.zeros(shape), rng=0)
    assert problem == f"nis should return one number, not {says}"
    both = exercises.turn.problem(lambda *case: 3.0, rng=0)
    assert both == "turn should return two numbers: estimate and variance, not one number"


def test_a_right_one_by_one_answer_and_one_that_warns_are_accepted(nis):
    def answer(v, S):
        warnings.warn("an old habit", DeprecationWarning, stacklevel=1)
        return v[None] @ np.linalg.inv(S) @ v[:, None]

    assert nis.problem(answer) == ""


def test_right_numbers_in_arrays_of_their_own_are_right_and_the_page_goes_on(capsys):
    for name in ("nis", "turn", "state_bounds", "worth"):
        exercise = dataclasses.replace(getattr(exercises, name))

        def answer(*case, exercise=exercise):
            results = exercise(*case)
            boxes = [np.array([[x]]) for x in np.atleast_1d(results)]
            return boxes[0] if np.ndim(results) == 0 else boxes

        goes_on = exercise.check(answer)
        assert capsys.readouterr().out.startswith(exercise.praise), name
        assert np.shape(goes_on(*exercise.parts[0].cases(np.random.default_rng())[0])) in ((), (2,))


def test_arrays_that_do_not_fit_are_told_their_shapes_and_the_line():
    def expected_reward(b, R):
        return R @ b

    said = exercises.expected_reward.problem(expected_reward, rng=0).splitlines()
    assert said[0] == "expected_reward puts together arrays that do not fit"
    assert said[1].endswith("of your cell: return R @ b")
    assert said[2] == "    b: 5 numbers; R: 5 rows of 6 numbers"
    assert "on the wrong side" in said[3] and "gufunc" not in "".join(said)


def test_a_rounded_answer_is_told_so(nis):
    assert "you round the answer" in nis.problem(lambda v, S: round(exercises.nis(v, S), 2))


# What nbgrader reads


@pytest.mark.parametrize("exercise", ALL)
def test_blank_and_wrong_answers_earn_nothing_and_right_ones_all(exercise):
    def blank(*case):
        raise NotImplementedError

    assert exercise.earned(blank, rng=0) == 0.0
    assert exercise.earned(lambda *case: -1.2345, rng=0) == 0.0
    assert exercise.earned(lambda *case: exercise(*case), rng=0) == exercise.points


def test_parts_count():
    turn, bounds, nis = exercises.turn, exercises.state_bounds, exercises.nis
    assert turn.points == 4 and bounds.points == 3 and nis.points == 2
    assert turn.earned(lambda *case: (turn(*case)[0], 7.0)) == 2.0, "half of each step"
    assert turn.earned(lambda x, P, u, z, Q, R: (x + u, P + Q)) == 1.0, "right if nothing is seen"
    assert bounds.earned(lambda v, w: (bounds(v, w)[0], 99)) == 1.5
    calls = iter(range(10_000))
    assert nis.earned(lambda *case: nis(*case) + next(calls) % 2) == 1.0
    known = "innovation**2 / np.diag(S)"
    assert nis.earned(lambda innovation, S: eval(known).sum()) == 0.0


def test_a_graded_page_shows_the_points_as_the_output_of_its_cell(nis, monkeypatch, capsys):
    shown = []
    monkeypatch.setattr("sys.displayhook", shown.append)
    nis.check(lambda v, S: v @ v)
    assert shown == []
    monkeypatch.setenv("NBGRADER_EXECUTION", "autograde")
    nis.check(lambda v, S: v @ v)
    nis.check(lambda *case: nis(*case))
    assert shown == [0.0, nis.points]


# What is kept


def test_what_is_solved_is_kept_in_the_students_copy_and_nowhere_else(
    tmp_path, monkeypatch, capsys
):
    monkeypatch.setattr(solved, "_session", set())
    below = tmp_path / "notebooks"
    below.mkdir()
    monkeypatch.chdir(below)
    exercises.nis.check(lambda *case: exercises.nis(*case))
    assert list(tmp_path.rglob("*.json")) == []
    (tmp_path / ".arkaq-course.json").write_text("{}")
    exercises.combine.check(lambda *case: exercises.combine(*case))
    solved._session.clear()
    exercises.turn.check(lambda *case: exercises.turn(*case))
    exercises.what_to_change.check(lambda: 3)
    capsys.readouterr()
    exercises.progress("kalman")
    assert capsys.readouterr().out == "kalman: 4 of 4 exercises solved, that is all of them\n"
    solved._session.clear()
    (tmp_path / "progress.json").write_text("scribble")
    exercises.progress()
    lines = capsys.readouterr().out.splitlines()
    assert len(lines) == len(exercises.CHAPTERS) and all(": 0 of " in line for line in lines)
    with pytest.raises(ValueError, match=r"chapter must be 'learning' or .*, got 'kallman'"):
        exercises.progress("kallman")
    exercises.match.check(lambda *case: exercises.match(*case))
    assert json.loads((tmp_path / "progress.json").read_text()) == {"solved": ["match"]}


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
    assert re.search(says, getattr(exercises, name).problem(answer, rng=0))

"""Every place of the thesis has a home in the code, and the command finds it."""

import re

import pytest
from click.testing import CliRunner

from arkaq_edu import cli
from arkaq_edu.trace import (
    PACKAGE,
    errata,
    every_place,
    in_words,
    places,
    table,
    trace,
)

ROWS = table()


def test_every_place_of_the_thesis_has_a_home():
    homeless = ROWS[ROWS.name == ""]
    assert homeless[["kind", "number"]].values.tolist() == []
    assert set(zip(ROWS.kind, ROWS.number, strict=True)) == set(every_place())


def test_every_equation_figure_and_row_has_a_test():
    tested = ROWS[ROWS.tests.map(len) > 0]
    for kind in ("eq", "figure", "errata row"):
        assert set(ROWS.number[ROWS.kind == kind]) == set(tested.number[tested.kind == kind])


def test_every_equation_and_figure_is_tested_at_its_first_home():
    first = ROWS.drop_duplicates(["kind", "number"])
    untested = first[first.kind.isin(["eq", "figure"]) & (first.tests.map(len) == 0)]
    assert untested[["number", "name"]].values.tolist() == []


def test_every_equation_and_figure_has_a_notebook():
    read = ROWS[ROWS.notebooks.map(len) > 0]
    for kind in ("eq", "figure"):
        assert set(ROWS.number[ROWS.kind == kind]) == set(read.number[read.kind == kind])


def test_every_row_of_the_errata_is_in_its_chapter():
    rows = ROWS[ROWS.kind == "errata row"]
    assert set(rows.number) == {str(row) for row in range(1, 42)}
    assert all("13_errata.ipynb" in names for names in rows.notebooks)


def test_lines_are_those_of_the_equation_or_of_the_definition():
    for row in ROWS.drop_duplicates(["file", "name", "line", "number"]).itertuples():
        lines = (PACKAGE / row.file).read_text(encoding="utf-8").splitlines()
        code, _, comment = lines[row.line - 1].partition("#")
        last = row.name.split(".")[-1]
        module = row.name == row.file.removesuffix(".py").replace("/", ".")
        if not module and not re.search(rf"(def|class) {last}\b|^{last} =", code):
            named = {row.number}
            if row.kind == "errata row":
                named = {number for _, number in places(errata().place[int(row.number)])}
            assert named & {number for _, number in places(comment)}, row


def test_tests_exist():
    named = {test for tests in ROWS.tests for test in tests}
    for file in {test.split("::")[0] for test in named}:
        text = (PACKAGE.parent / file).read_text(encoding="utf-8")
        there = set(re.findall(r"def (test_\w+)\(", text))
        assert {t.split("::")[1].split(".")[-1] for t in named if t.startswith(f"{file}:")} <= there


@pytest.mark.parametrize(
    ("text", "found"),
    [
        ("eq 2.47", [("eq", "2.47")]),
        ("Equations 2.57 to 2.59", [("eq", "2.57"), ("eq", "2.58"), ("eq", "2.59")]),
        ("figures 5.10-5.12, 5.16", [("figure", f"5.{n}") for n in (10, 11, 12, 16)]),
        ("Thesis 5.1.2.1 (the vision engine), 5.2", [("section", "5.1.2.1"), ("section", "5.2")]),
        ("errata rows 34 and 35", [("errata row", "34"), ("errata row", "35")]),
        ("a distance of 2.5 m; version 2.47; eq. of 3", []),
    ],
)
def test_places_are_read_as_people_write_them(text, found):
    assert places(text) == found


@pytest.mark.parametrize(
    ("place", "name", "file"),
    [
        ("2.47", "match_norm", "art/reset.py"),
        ("figure 5.16", "figure_5_16", "figures/approach.py"),
        ("5.16", "figure_5_16", "figures/approach.py"),
        ("2.31", "cycle", "art/art2.py"),
        ("2.57", "gain", "kalman/filter.py"),
        ("4.6", "learn", "art/euclidean.py"),
        ("2.12", "QLearner.update", "mdp/q_learning.py"),
    ],
)
def test_the_first_home_is_the_method_itself(place, name, file):
    first = trace(place).iloc[0]
    assert (first["name"], first.file) == (name, file)


def test_4_2_2_leads_to_the_network_and_its_notebook():
    found = trace("4.2.2")
    assert "EuclideanART" in set(found.name)
    assert any("07_state_segmentation.ipynb" in names for names in found.notebooks)


def test_a_number_of_two_kinds_shows_both_and_a_kind_only_one():
    assert trace("2.1").kind.unique().tolist() == ["eq", "figure", "section"]
    assert trace("figure 2.1").kind.unique().tolist() == ["figure"]


def test_the_command():
    answer = CliRunner().invoke(cli.main, ["trace", "errata", "row", "12"])
    assert answer.exit_code == 0, answer.output
    assert answer.output == in_words(trace("errata row 12")) + "\n"
    assert "tests/pomdp/test_model.py::test_errata_12_and_14_the_corridor" in answer.output
    answer = CliRunner().invoke(cli.main, ["trace", "9.9"])
    assert answer.exit_code == 2 and "got '9.9'" in answer.output

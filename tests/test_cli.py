"""The arkaq command's work: train, watch, reproduce."""

import re

import pandas as pd
import pytest
from click.testing import CliRunner

from arkaq_edu import cli
from arkaq_edu.arkaq import Arkaq, TrainingSettings
from arkaq_edu.figures import gallery
from arkaq_edu.figures.report import anchor


@pytest.fixture
def run(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    return lambda *words: CliRunner().invoke(cli.main, [str(word) for word in words])


@pytest.fixture
def brief(monkeypatch):
    """Make every training short: what is tested is the command, not the learning."""
    from arkaq_edu.experiments import approach, goal

    def short(seed, vigilance=None, **options):
        options["learning"] = TrainingSettings(patterns=300, exploration=500, exploitation=0)
        return long(seed, vigilance, **options)

    def short_goal(seed, vigilance=None, **options):
        options["learning"] = TrainingSettings.goal(patterns=100, exploration=150, exploitation=0)
        return long_goal(seed, vigilance, **options)

    long, long_goal = approach.train, goal.train
    monkeypatch.setattr(approach, "train", short)
    monkeypatch.setattr(goal, "train", short_goal)


def test_train_leaves_an_agent_and_says_how_well_it_does(run, brief, tmp_path):
    answer = run("train", "--seed", 2, "--vigilance", 0.2, "--out", "mine.npz")
    assert answer.exit_code == 0, answer.output
    agent = Arkaq.load(tmp_path / "mine.npz")
    assert (agent.seed, agent.vigilance) == (2, 0.2)
    assert f"{agent.art.n_clusters_} states" in answer.output


def test_train_teaches_to_score_too_and_watch_films_it(run, brief, tmp_path):
    answer = run("train", "goal", "--seed", 2, "--goal-distance", "far", "--out", "mine.npz")
    assert answer.exit_code == 0, answer.output
    agent = Arkaq.load(tmp_path / "mine.npz")
    assert (agent.task, agent.seed, agent.vigilance) == ("goal", 2, 0.05)
    assert f"{agent.art.n_clusters_} states; goals in" in answer.output
    answer = run("watch", "mine.npz", "--orientation", 0.1, "--seed", 1)
    assert answer.exit_code == 0, answer.output
    assert (tmp_path / "shot.gif").read_bytes()[:3] == b"GIF"


def test_watch_films_a_shot_of_the_courses_own_agent(run, tmp_path):
    answer = run("watch", "goal", "--orientation", -0.2, "--out", "shot.html")
    assert answer.exit_code == 0, answer.output
    assert "after 1 turn" in answer.output
    page = (tmp_path / "shot.html").read_text()
    assert "the goal 0.20 rad right, 1 turn: a" in page and "://" not in page


def test_train_refuses_a_file_that_holds_another_run(run, brief):
    run("train", "--seed", 2, "--out", "mine.npz")
    answer = run("train", "--seed", 3, "--out", "mine.npz")
    assert answer.exit_code == 2
    assert len(answer.output.strip().splitlines()[-1:]) == 1
    assert "another seed" in answer.output


def test_watch_films_the_courses_own_agent(run, tmp_path):
    answer = run("watch", "--distance", 900, "--orientation", 0.1, "--out", "walk.gif")
    assert answer.exit_code == 0, answer.output
    assert "reached the ball" in answer.output
    assert (tmp_path / "walk.gif").read_bytes()[:3] == b"GIF"


@pytest.mark.parametrize(
    ("words", "hint"),
    [
        (["train", "--vigilance", "-1"], "vigilance must be"),
        (["train", "--seed", "-1"], "--seed"),
        (["watch", "no.npz"], "No such file"),
        (["watch", "goal", "--orientation", "3"], "orientation must be"),
        (["watch", "goal", "--goal-distance", "middle"], "--goal-distance"),
        (["train", "dance"], "dance"),
        (["train", "goal", "--kalman", "thesis"], "--kalman applies only to approach"),
        (["train", "--goal-distance", "far"], "--goal-distance applies only to goal"),
        (["watch", "--goal-distance", "far"], "--goal-distance applies only to goal"),
        (["watch", "goal", "--distance", "900"], "--distance applies only to approach"),
        (["watch", "--distance", "1e9"], "distance must be"),
        (["watch", "--out", "walk.txt"], ".gif"),
        (["watch", "begun.npz"], "agent must have learned"),
        (["reproduce", "--jobs", "0"], "jobs must be"),
        (["reproduce", "--seeds", "0"], "--seeds"),
    ],
)
def test_bad_input_gets_one_line_and_status_two(run, words, hint):
    Arkaq(rng=0).save("begun.npz")
    answer = run(*words)
    assert answer.exit_code == 2
    assert len(answer.output.splitlines()) == 1
    assert hint in answer.output


def test_reproduce_writes_a_page_and_its_tables(run, brief, tmp_path, monkeypatch):
    some = {number: gallery.FIGURES[number] for number in ("2.6", "5.16", "5.17", "5.39", "5.40")}
    monkeypatch.setattr(gallery, "FIGURES", some)
    answer = run("reproduce", "--seeds", 1, "--approaches", 2, "--jobs", 1, "--out", "report")
    assert answer.exit_code == 0, answer.output
    names = ["curves.csv", "index.html", "results.csv", "run.json", "runs.csv"]
    assert sorted(p.name for p in (tmp_path / "report").iterdir() if p.is_file()) == names
    table = pd.read_csv(tmp_path / "report" / "results.csv").set_index("quantity")
    printed = [table.thesis[f"centers, vigilance {rho}"] for rho in (0.15, 0.1, 0.075, 0.05, 0.025)]
    assert printed == ["137", "333", "519", "825", "1933"]
    page = (tmp_path / "report" / "index.html").read_text()
    assert "://" not in page
    assert re.findall('id="figure-([^"]+)"', page) == [*some, "search"]
    for quantity in table.index:
        assert f'id="{anchor(quantity)}"' in page
    assert len({anchor(quantity) for quantity in table.index}) == len(table)

"""Studies: the same bytes however they are run, resumed after a stop, refused before they run."""

import ast
import dataclasses
import math
import os
import re
import signal
import subprocess
import sys
import threading
import time
from concurrent.futures import Future, ThreadPoolExecutor
from pathlib import Path

import gymnasium
import numpy as np
import pandas as pd
import pytest
from click.testing import CliRunner

from arkaq_edu import __version__, cli
from arkaq_edu.arkaq import Sarsa, Sensing, TrainingSettings
from arkaq_edu.art import EuclideanART
from arkaq_edu.experiments import goal, read_study, study
from arkaq_edu.experiments.trials import arrange, learning_time, measure
from arkaq_edu.field import Legs
from arkaq_edu.figures import plot_study
from arkaq_edu.mdp import speed_of_convergence

ROOT = Path(__file__).parents[2]
BRIEF = {"patterns": 60, "exploration": 40, "exploitation": 40, "episodes": 3}
GRID = {"vigilance": [0.05, 0.06, 0.075], "learner": ["QLearning", "Sarsa"]}


def draw(seed, mean=0.0, other=0.0, learner=""):
    """Measure nothing but the settings and the seed."""
    x = float(np.random.default_rng(seed).normal(mean))
    return {"x": x, "missing": np.nan}


def once(seed, folder, kill):
    """Fail at the first call, or lose the process; say how often it was called."""
    calls = Path(folder) / f"{seed}.calls"
    n = int(calls.read_text()) if calls.exists() else 0
    calls.write_text(str(n + 1))
    if n == 0 and seed == 1:
        if kill:
            os.kill(os.getpid(), signal.SIGKILL)
        raise OSError("no disk today")
    return {"calls": n + 1.0}


def never(seed):
    """Fail for one seed only."""
    if seed == 1:
        raise OSError("no disk at all")
    return {"x": 1.0}


def agents(folder, jobs):
    study(GRID, 5, task="goal", settings=BRIEF, folder=folder, jobs=jobs, progress=False)
    return (folder / "results.csv").read_bytes()


def start(*words):
    environment = os.environ | {"PYTHONPATH": str(ROOT)}
    command = [sys.executable, "-m", "dask", *words]
    return subprocess.Popen(command, env=environment, stderr=subprocess.DEVNULL)


def agents_on_dask_with_a_worker_killed(folder, own):
    """Return the bytes, how many cells were there at the kill, and how many workers lived."""
    from dask.distributed import Client

    file = own / "scheduler.json"
    common = ("--no-dashboard", "--scheduler-file", str(file))
    alone = ("--no-nanny", "--nthreads", "1", "--local-directory", str(own))
    processes = [start("scheduler", "--host", "127.0.0.1", "--port", "0", *common)]
    processes += [start("worker", *alone, *common) for _ in range(2)]
    killed_after = []

    def kill_a_worker():
        while len(killed_after) < 5:
            killed_after[:] = folder.glob("cells/*.json")
            time.sleep(0.01)
        processes[1].kill()

    killer = threading.Thread(target=kill_a_worker)
    try:
        with Client(scheduler_file=str(file)) as client:
            client.wait_for_workers(2)
            killer.start()
            made = agents(folder, client.get_executor(pure=False))
            killer.join()
            return made, len(killed_after), len(client.scheduler_info()["workers"])
    finally:
        for process in processes:
            process.kill()
            process.wait()


def test_agents_are_the_same_bytes_on_one_process_on_two_and_on_dask_with_a_worker_killed(tmp_path):
    one, two = agents(tmp_path / "one", 1), agents(tmp_path / "two", 2)
    there, at_the_kill, alive = agents_on_dask_with_a_worker_killed(tmp_path / "dask", tmp_path)
    assert one == two == there
    assert 5 <= at_the_kill < 30 and alive == 1
    # Every cell is there, and is what one agent, trained by itself, measures.
    table = pd.read_csv(tmp_path / "one" / "results.csv")
    cells = table.groupby(["vigilance", "learner", "seed"], sort=False)
    assert len(cells) == 30
    cell = cells.get_group((0.06, "Sarsa", 3))
    alone = measure("goal", 3, vigilance=0.06, learner="Sarsa", **BRIEF)
    assert dict(zip(cell.quantity, cell.value, strict=True)) == alone


def test_a_stopped_study_goes_on_where_it_was_and_a_larger_one_runs_only_what_is_new(tmp_path):
    calls = []

    def stopped(seed, x):
        if len(calls) == 3:
            raise KeyboardInterrupt
        return counted(seed, x)

    def counted(seed, x):
        calls.append((x, seed))
        return {"sum": x + seed}

    stopped.__qualname__ = counted.__qualname__  # the same task, but for the stop
    common = {"folder": tmp_path, "jobs": 1, "progress": False}
    with pytest.raises(KeyboardInterrupt):
        study({"x": [0, 10]}, 3, task=stopped, **common)
    assert read_study(tmp_path).value.tolist() == [0, 1, 2]
    table = study({"x": [0, 10]}, 3, task=counted, **common)
    assert table.value.tolist() == [0, 1, 2, 10, 11, 12]
    assert calls == [(x, seed) for x in (0, 10) for seed in range(3)]
    table = study({"x": [20, 0]}, [2, 5], task=counted, **common)
    assert calls[6:] == [(20, 2), (20, 5), (0, 5)]
    assert table.x.tolist() == [20, 20, 0, 0] and table.seed.tolist() == [2, 5, 2, 5]
    assert read_study(tmp_path).equals(table)


def test_a_missing_value_stays_missing(tmp_path):
    made = study({"mean": [1.0]}, 2, task=draw, folder=tmp_path, jobs=1, progress=False)
    again = study({"mean": [1.0]}, 2, task=draw, folder=tmp_path, jobs=1, progress=False)
    assert made.equals(again) and made.value.isna().sum() == 2
    assert "NaN" not in next(tmp_path.glob("cells/*.json")).read_text()


@pytest.mark.parametrize(("kill", "jobs"), [(False, 1), (True, 2)])
def test_a_cell_that_fails_or_is_killed_is_tried_again(tmp_path, kill, jobs):
    common = {"task": once, "jobs": jobs, "progress": False}
    settings = {"folder": str(tmp_path), "kill": kill}
    table = study({}, 3, settings=settings, **common)
    assert table.seed.tolist() == [0, 1, 2]
    assert table.value[1] == 2


class Losing(ThreadPoolExecutor):
    """Workers that die of the first cell, as on a cluster."""

    first = True

    def submit(self, *call, **options):
        if not self.first:
            return super().submit(*call, **options)
        self.first, lost = False, Future()
        lost.set_exception(ConnectionError("the worker died"))
        return lost


def test_a_cell_whose_workers_died_is_tried_again():
    with Losing(2) as workers:
        table = study({"mean": [0.0]}, 3, task=draw, jobs=workers, progress=False)
    assert table.seed.tolist() == [0, 0, 1, 1, 2, 2]
    with Losing(2) as workers, pytest.raises(RuntimeError, match=r"1 cells failed.*worker died"):
        study({"mean": [0.0]}, 3, task=draw, jobs=workers, retries=0, progress=False)


def test_what_fails_for_good_is_named_when_all_else_is_finished(tmp_path):
    with pytest.raises(RuntimeError, match=r"1 cells failed.*'seed': 1.*no disk at all"):
        study({}, 3, task=never, folder=tmp_path, jobs=1, progress=False)
    assert read_study(tmp_path).seed.tolist() == [0, 2]
    assert pd.read_csv(tmp_path / "results.csv").seed.tolist() == [0, 2]


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"grid": {"vigilance": [0.1, -1]}}, "vigilance must be"),
        ({"grid": {"vigilance": [0.1, 0.1]}}, "vigilance must have values of different names"),
        ({"grid": {"vigilance": 0.1}}, "vigilance must be a list"),
        ({"grid": {"gama": [0.9]}}, "goal must be known, got 'gama'; did you mean gamma"),
        ({"grid": {"goal_distance": ["far"]}, "task": "approach"}, "of approach must be known"),
        ({"grid": {"gamma": [1.5]}}, "gamma must be"),
        ({"grid": {"learner": ["QLerning"]}}, "learner must be QLearning, Sarsa"),
        ({"grid": {"segmenter": ["nowhere:Nothing"]}}, "segmenter must be .*No module"),
        ({"grid": {"segmenter": [{"name": "UniformGrid", "cels": [4]}]}}, "UniformGrid cannot"),
        ({"grid": {"learner": [object()]}}, "learner must be a dictionary that names its values"),
        ({"grid": {"episodes": [0]}}, "episodes must be"),
        ({"grid": {"near": [1000.0]}}, "near"),
        ({"grid": {"hold": [1]}, "settings": {"hold": 2}}, "hold must be in grid or in settings"),
        ({"seeds": [1, 1]}, "seeds must be different"),
        ({"seeds": 0}, "seeds must be"),
        ({"seeds": math.inf}, "seeds must be"),
        ({"task": "score"}, 'task must be approach, goal or "module:name"'),
        ({"task": "math:pi"}, "task must be a function"),
        ({"jobs": 0}, "jobs must be"),
    ],
)
def test_a_study_is_refused_before_anything_runs(tmp_path, change, said):
    plan = {"grid": {"vigilance": [0.1]}, "seeds": 2, "task": "goal", "folder": tmp_path} | change
    with pytest.raises(ValueError, match=said):
        study(**plan, progress=False)
    assert not [*tmp_path.iterdir()]


def test_a_folder_of_another_version_is_refused(tmp_path):
    study({}, 1, task=draw, folder=tmp_path, jobs=1, progress=False)
    plan = tmp_path / "study.json"
    plan.write_text(plan.read_text().replace(f'"{__version__}"', '"0.0.1"'))
    with pytest.raises(ValueError, match=r"folder holds a study by arkaq_edu 0\.0\.1"):
        study({}, 1, task=draw, folder=tmp_path, jobs=1, progress=False)


def test_every_kind_of_setting_reaches_the_agent_or_the_task():
    noise = [[4.0, 0.0], [0.0, 0.01]]
    found = arrange(
        "approach",
        {"gamma": 0.9, "sensing": "thesis", "R": noise, "far": 1000.0, "legs": {"slide": 0.0},
         "segmenter": {"name": "EuclideanART", "learning_rate": 0.25}, "learner": Sarsa(),
         "vigilance": 0.3},
    )  # fmt: skip
    agent = found.agent
    assert agent["learning"] == TrainingSettings(gamma=0.9)
    assert agent["sensing"] == dataclasses.replace(Sensing.thesis(), R=noise)
    assert agent["segmenter"].get_params() == EuclideanART(0.3, 0.25).get_params()
    assert type(agent["learner"]) is Sarsa
    assert found.task == {"far": 1000.0, "legs": Legs(slide=0.0)}
    far = arrange("goal", {"goal_distance": "far"}).agent
    assert far["vigilance"] == goal.VIGILANCE["far"] and far["segmenter"] is None
    assert far["learning"] == goal.usual_learning("far")


PAGE = (ROOT / "environment.md").read_text(encoding="utf-8")
FILES = dict(re.findall(r"```(?:python|toml)\n# (\w+\.\w+)\n(.*?)```", PAGE, re.DOTALL))


@pytest.fixture
def researcher(tmp_path, monkeypatch):
    """Write the files of environment.md, with little training, and run one of its plans."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(sys, "path", [str(tmp_path), *sys.path])
    for name, text in FILES.items():
        for setting, n in {
            "seeds": 1,
            "patterns": 100,
            "exploration": 300,
            "exploitation": 0,
        }.items():
            text = re.sub(rf"(?m)^{setting} = \d+", f"{setting} = {n}", text)
        Path(name).write_text(text, encoding="utf-8")
    yield lambda plan: CliRunner().invoke(cli.main, ["study", plan, "--out", "out", "--jobs", "1"])
    for module in ("mine", "pole"):
        sys.modules.pop(module, None)


def test_parts_of_ones_own_stand_beside_the_plan_as_the_page_says(researcher):
    answer = researcher("mine.toml")
    assert answer.exit_code == 0, answer.output
    table = pd.read_csv("out/results.csv")
    assert len(table.groupby(["segmenter", "learner", "sensing", "seed"])) == 8
    wide = table.pivot(index=["segmenter", "learner", "sensing"], columns="quantity").value
    assert (wide.states.loc["mine"] == 18).all() and (wide.states.loc["network"] != 18).all()
    for part in ("segmenter", "learner", "sensing"):  # each changes something: none is left unused
        mine = wide.xs("mine", level=part)
        other = wide.drop("mine", level=part).droplevel(part)
        assert not np.allclose(mine, other.loc[mine.index], equal_nan=True)
    assert Path("out/results.png").read_bytes()[1:4] == b"PNG"


def test_parts_of_ones_own_are_objects_in_python_as_the_page_says(researcher):
    (block,) = re.findall(
        r"```python\n(from arkaq_edu.experiments import study\nfrom mine.*?)```", PAGE, re.DOTALL
    )
    scope = {}
    exec(block.replace("seeds=2,", "seeds=2, jobs=1,"), scope)
    table = scope["table"]
    assert table.learner.unique().tolist() == ["usual", "mine"]
    assert (table.value[table.quantity == "states"] == 18).all()


def test_a_task_of_ones_own_is_a_function_as_the_page_says(researcher):
    answer = researcher("pole.toml")
    assert answer.exit_code == 0, answer.output
    table = pd.read_csv("out/results.csv")
    assert table.vigilance.unique().tolist() == [0.7, 0.5, 0.3]
    states = table.value[table.quantity == "states"].tolist()
    assert states == sorted(states) and states[0] < states[-1]
    env = gymnasium.make("CartPole-v1")
    env.action_space.seed(0)
    steps = 0
    for seed in range(500):
        env.reset(seed=seed)
        over = False
        while not over:
            _, _, over, _, _ = env.step(env.action_space.sample())
            steps += 1
    assert steps / 500 == pytest.approx(22, abs=1)


def test_what_a_researcher_writes_is_short():
    for name in ("mine.py", "pole.py"):
        for node in ast.parse(FILES[name]).body:
            assert node.end_lineno - node.lineno < 30


def test_where_a_cell_failed_is_said_in_the_researchers_own_code(researcher):
    Path("pole.py").write_text("def balance(seed, vigilance, **more):\n    return 1 / 0\n")
    answer = researcher("pole.toml")
    assert answer.exit_code == 2
    assert 'pole.py", line 2, in balance' in answer.output
    last = answer.output.strip().splitlines()[-1]
    assert "3 cells failed" in last and "division by zero" in last


@pytest.mark.parametrize(
    ("plan", "said"),
    [
        ("seeds = ", "plan.toml must be TOML"),
        ("seeds = 1", "plan.toml must have grid and seeds"),
        ("seeds = 1\n[grid]\nvigilance = [-1]", "vigilance must be"),
        ("seeds = 1\nsteps = 3\n[grid]", "plan.toml must have grid and seeds"),
    ],
)
def test_the_command_refuses_a_bad_plan_with_one_line(tmp_path, plan, said):
    (tmp_path / "plan.toml").write_text(plan)
    answer = CliRunner().invoke(
        cli.main, ["study", str(tmp_path / "plan.toml"), "--out", str(tmp_path / "out")]
    )
    assert answer.exit_code == 2
    assert said in answer.output and len(answer.output.strip().splitlines()) == 1


def test_learning_time_is_the_speed_of_convergence_in_cycles():
    agent = goal.load_agent()
    episodes = [row for row in agent.history if row[0] == "Q-learning"]
    n = speed_of_convergence([float(row[3]) for row in episodes], 0.4, window=100)
    assert learning_time(agent, 0.4, 100) == sum(row[1] for row in episodes[:n])
    assert learning_time(agent, 1.0, 100) == sum(row[1] for row in episodes)


def test_a_study_is_drawn_from_its_folder(tmp_path):
    study({"mean": [0.0, 5.0]}, 4, task=draw, folder=tmp_path, jobs=1, progress=False)
    plot = plot_study(tmp_path)
    x = [draw(seed)["x"] for seed in range(4)]
    assert plot.lines["x"][""].get_ydata() == pytest.approx([np.mean(x), np.mean(x) + 5])
    low, high = (plot.bands["x"][""].get_paths()[0].vertices[:, 1].min(), np.mean(x) - np.std(x))
    assert low == pytest.approx(high)
    with pytest.raises(ValueError, match="quantity must be"):
        plot_study(tmp_path, quantity="y")


def test_names_are_drawn_side_by_side_and_numbers_across(tmp_path):
    grid = {"mean": {"none": 0.0, "five": 5.0}, "other": [0.0, 1.0]}
    table = study(grid, 2, task=draw, jobs=1, progress=False)
    by_name = plot_study(table, x="mean", quantity="x")
    assert [t.get_text() for t in by_name.ax.get_xticklabels()] == ["none", "five"]
    assert [*by_name.lines] == ["0.0", "1.0"]
    by_number = plot_study(table, x="other", quantity="x")
    assert by_number.lines["five"].get_xdata().tolist() == [0.0, 1.0]
    assert by_number.lines["five"].get_ydata()[0] - by_number.lines["none"].get_ydata()[0] == 5


def test_many_lines_have_a_color_each_and_a_study_of_one_setting_runs_over_its_seeds():
    grid = {"other": [0.0, 1.0], "mean": [float(i) for i in range(7)], "learner": ["a", "b", "c"]}
    plot = plot_study(study(grid, 1, task=draw, jobs=1, progress=False), quantity="x")
    assert plot.ax.get_xlabel() == "mean"  # the setting with the most values
    assert len({line.get_color() for line in plot.lines.values()}) == len(plot.lines) == 6
    plot = plot_study(study({}, 3, task=draw, jobs=1, progress=False), quantity="x")
    assert plot.ax.get_xlabel() == "seed"
    assert plot.lines[""].get_ydata().tolist() == [draw(seed)["x"] for seed in range(3)]

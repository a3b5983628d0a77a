"""A study: every combination of some settings, over many seeds, as one tidy table.

A finished cell is a file. So a study that is stopped goes on where it was, and one that grows by
a vigilance or by ten seeds runs only what is new.
"""

from __future__ import annotations

import inspect
import json
import math
import os
import platform
import tomllib
import traceback
from collections.abc import Callable, Iterable, Iterator, Mapping
from concurrent.futures import BrokenExecutor, Executor, as_completed
from contextlib import suppress
from itertools import product
from pathlib import Path
from typing import Any, NamedTuple

import joblib
import numpy as np
import pandas as pd
from tqdm.auto import tqdm

from arkaq_edu import __version__, _checks
from arkaq_edu._files import replacing
from arkaq_edu._paths import data_file
from arkaq_edu.experiments.trials import MEASURES, arrange, imported

Task = str | Callable[..., Mapping[str, float]]

FORMAT = 1
#: A value needs a name of its own in the table if it would take more characters than this.
LONGEST_NAME = 60


class Cell(NamedTuple):
    """One combination of settings, and one seed.

    Attributes
    ----------
    shown : dict
        The columns of the table: the settings that vary, and the seed.
    setting : dict
        All settings.
    seed : int
    key : str
        A hash of the task, the settings and the seed: the name of the cell's file.
    """

    shown: dict[str, Any]
    setting: dict[str, Any]
    seed: int
    key: str


def study(
    grid: Mapping[str, Any],
    seeds: int | Iterable[int],
    *,
    task: Task = "approach",
    settings: Mapping[str, Any] | None = None,
    folder: str | os.PathLike[str] | None = None,
    jobs: int | Executor = -1,
    retries: int = 1,
    progress: bool = True,
) -> pd.DataFrame:
    """Train and judge an agent for every combination of settings, over many seeds.

    Parameters
    ----------
    grid : mapping
        The settings that vary, by name: for each a list of values, or a dictionary of values by
        the names that the table calls them. The settings are

        - of the agent: ``vigilance``, ``sensing``, ``segmenter``, ``learner`` (see `Arkaq`);
        - of its learning: every parameter of `TrainingSettings`, for example ``gamma``;
        - of its Kalman filter: every parameter of `Sensing`, for example ``R``, in place of that of
          ``sensing``;
        - of the task: every parameter of `BallApproachEnv` or `ScoreGoalEnv`, for example
          ``goal_distance``, and ``max_episode_steps``;
        - ``episodes``: the number of fresh starts that judge an agent, 500 by default.

        A segmenter, a learner or ``sensing`` is an object, or the name of a class or function of
        `arkaq_edu.art`, `arkaq_edu.arkaq` or `arkaq_edu.experiments.parts`. One of your own is
        "module:name". With parameters it is a dictionary such as
        ``{"name": "UniformGrid", "cells": [20, 17]}``. ``vigilance`` and ``learning_rate`` are
        those of the cell, if they are not given.
    seeds : int or iterable of int
        The seeds, or how many: 0, 1, 2, ...
    task : {"approach", "goal"} or function
        The problem. Or a function of your own, or its "module:name": it is called as
        ``task(seed=0, **settings)`` and returns what it measured, as numbers by name.
    settings : mapping, optional
        The settings that do not vary, by name.
    folder : path, optional
        Where to keep each cell as soon as it is finished, and the table. What is there already
        is not run again.
    jobs : int or concurrent.futures.Executor
        Number of processes; -1 for one a core. Or what runs the cells, for example a Dask cluster:
        ``dask.distributed.Client(address).get_executor(pure=False)``.
    retries : int
        How many times a cell is tried again that failed, or whose process was killed.
    progress : bool
        Whether to show a progress bar.

    Returns
    -------
    DataFrame
        One row a measurement, with the columns of the settings that vary, seed, quantity and
        value. The order is that of the grid, so the same study gives the same bytes however it
        was run. The quantities of the two problems are

        - ``success``: percentage of fresh starts from which the ball was reached, or a goal scored;
        - ``bonus``: percentage that earned the +50 (approach);
        - ``path``: length of the path over that of the straight line, the median (approach);
        - ``cycles`` or ``turns``: the mean number of footstep cycles, or of turns before the kick;
        - ``reward``: the mean reward of an episode, and ``regret``: how much more the planner earns
          that sees the true state, from the same starts;
        - ``states``: the number of categories;
        - ``learning_time``: cycles of Q-learning until the share of successes stays at three
          quarters of the planner's (all cycles, if it does not).

    Raises
    ------
    ValueError
        If a setting is unknown or out of range, before anything is run. If two values of a setting
        have the same name, or a value has none that is short.
    RuntimeError
        If cells fail. All others are finished then, and kept in `folder`. The cause has a note
        with the lines of code at which the first cell failed.

    Notes
    -----
    Agents are trained on the task of the thesis, `approach.make_task` (where equation 5.1 places
    the ball) or `goal.make_task`. `approach.evaluate` (where the balls lie evenly over the view)
    or `goal.evaluate` judges them from other seeds, the same for all settings.

    A part of your own is known by its class and its attributes. If you change its code, choose
    another folder.

    Examples
    --------
    >>> grid = {"vigilance": [0.1, 0.3], "learner": ["Sarsa"]}
    >>> brief = {"patterns": 100, "exploration": 100, "exploitation": 0, "episodes": 3}
    >>> table = study(grid, 1, task="goal", settings=brief, jobs=1, progress=False)
    >>> table.columns.tolist(), len(table)
    (['vigilance', 'learner', 'seed', 'quantity', 'value'], 12)

    A task of one's own.

    >>> def throw(seed, sides):
    ...     return {"eyes": int(np.random.default_rng(seed).integers(sides)) + 1}
    >>> study({"sides": [6, 20]}, [7], task=throw, jobs=1, progress=False)
       sides  seed quantity  value
    0      6     7     eyes    6.0
    1     20     7     eyes   19.0
    """
    if not isinstance(jobs, Executor) and _checks.integer("jobs", jobs, -(2**31), 2**31) == 0:
        raise ValueError("jobs must be a number of processes, or -1 for one a core, got 0")
    measure, cells = _measure(task), _cells(grid, settings or {}, seeds, task)
    for cell in {cell.key: cell for cell in cells if cell.seed == cells[0].seed}.values():
        _refuse(task, measure, cell)
    finished = _begin(folder, task, cells)
    waiting: dict[str, Cell] = {}
    failed: dict[str, Exception] = {}
    done = sum(cell.key in finished for cell in cells)
    with tqdm(total=len(cells), initial=done, unit=" cells", disable=not progress) as bar:
        for _ in range(1 + _checks.integer("retries", retries)):
            waiting = {cell.key: cell for cell in cells if cell.key not in finished}
            killed = RuntimeError("its process was killed")
            failed = dict.fromkeys(waiting, killed)
            # The system may have killed a process. What is not finished then runs again.
            with suppress(BrokenExecutor):
                for key, found in _run(measure, [*waiting.values()], jobs):
                    if isinstance(found, Exception):
                        failed[key] = found
                        continue
                    del failed[key]
                    finished[key] = found
                    _keep(folder, waiting[key], found)
                    bar.update()
    table = _table([(cell.shown, finished.get(cell.key, {})) for cell in cells])
    if folder is not None:
        with replacing(Path(folder) / "results.csv") as fresh:
            table.to_csv(fresh, index=False, lineterminator="\n")
    for key, error in failed.items():
        where = waiting[key].shown
        raise RuntimeError(f"{len(failed)} cells failed, the first at {where}: {error}") from error
    return table


def read_study(folder: str | os.PathLike[str]) -> pd.DataFrame:
    """Return what a study has measured so far, also while it runs.

    Parameters
    ----------
    folder : path
        The folder of the study.

    Returns
    -------
    DataFrame
        See `study`.

    Raises
    ------
    ValueError
        If the folder holds no study.

    Examples
    --------
    >>> import tempfile
    >>> def double(seed, x):
    ...     return {"twice": 2 * x + seed}
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     made = study({"x": [1, 2]}, 2, task=double, folder=folder, jobs=1, progress=False)
    ...     made.equals(read_study(folder))
    True
    """
    plan = _plan(Path(folder))
    if plan is None:
        raise ValueError(f"folder must hold a study, got {_checks.shown(str(folder))}")
    keys = [cell.pop("key") for cell in plan["cells"]]
    values = [_finished(Path(folder), key) or {} for key in keys]
    return _table([*zip(plan["cells"], values, strict=True)])


def load_study(name: str) -> pd.DataFrame:
    """Return a study that comes with the course.

    Parameters
    ----------
    name : str
        The name of its plan in the folder ``data/studies``, without ".toml".

    Returns
    -------
    DataFrame
        See `study`.

    Examples
    --------
    >>> load_study("planned").columns.tolist()
    ['trusts', 'seed', 'quantity', 'value']
    """
    return pd.read_csv(data_file(f"studies/{name}.csv"))


def bands(table: pd.DataFrame, *quantities: str, digits: int = 1) -> pd.DataFrame:
    """Return the means of a study, each plus or minus two standard errors, as text.

    Parameters
    ----------
    table : DataFrame
        See `study`.
    *quantities : str
        The columns, by default all.
    digits : int
        Digits behind the point, 0 to 15.

    Returns
    -------
    DataFrame
        A row for each combination of settings, in the order of the study.

    Raises
    ------
    ValueError
        If `digits` is out of range.

    Examples
    --------
    >>> rows = [[rho, seed, "success", 90.0 + seed] for rho in (0.1, 0.2) for seed in (0, 2)]
    >>> bands(pd.DataFrame(rows, columns=["vigilance", "seed", "quantity", "value"]))
    quantity     success
    vigilance
    0.1        91.0 ± 2.0
    0.2        91.0 ± 2.0
    """
    digits = _checks.integer("digits", digits, 0, 15)
    settings = [*table.columns[: [*table.columns].index("seed")]]
    found = table.groupby([*settings, "quantity"], sort=False).value.agg(["mean", "sem"])
    words = [f"{mean:,.{digits}f} ± {2 * sem:,.{digits}f}" for mean, sem in found.to_numpy()]
    wide = pd.Series(words, found.index, dtype=object).unstack("quantity", sort=False)
    return wide[[*quantities]] if quantities else wide


def read_plan(path: str | os.PathLike[str]) -> dict[str, Any]:
    """Return the arguments of `study` that a TOML file holds.

    Parameters
    ----------
    path : path
        A file with ``seeds``, tables ``[grid]`` and ``[settings]``, and ``task``; the last two may
        be left out.

    Returns
    -------
    dict

    Raises
    ------
    ValueError
        If the file is not TOML, or has other entries.

    Examples
    --------
    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = Path(folder, "plan.toml")
    ...     _ = path.write_text("seeds = 5\\n[grid]\\ngamma = [0.8, 0.9]\\n[settings]\\nhold = 1")
    ...     read_plan(path)
    {'seeds': 5, 'grid': {'gamma': [0.8, 0.9]}, 'settings': {'hold': 1}}
    """
    try:
        plan = tomllib.loads(Path(path).read_text(encoding="utf-8"))
    except (tomllib.TOMLDecodeError, UnicodeDecodeError, RecursionError) as error:
        raise ValueError(f"{path} must be TOML: {str(error)[:200]}") from error
    if not {"grid", "seeds"} <= plan.keys() <= {"grid", "seeds", "settings", "task"}:
        raise ValueError(
            f"{path} must have grid and seeds, may have settings and task, "
            f"got {_checks.shown(list(plan))}"
        )
    return plan


def _measure(task: Task) -> Callable[..., Mapping[str, float]]:
    """Return the function that a task stands for."""
    found: Any = task
    if isinstance(task, str):
        found = MEASURES[task] if task in MEASURES else imported("task", task, MEASURES)
    if not callable(found):
        raise ValueError(f"task must be a function, got {_checks.shown(found)}")
    return found


def _task_name(task: Task) -> str:
    if isinstance(task, str):
        return task
    return f"{task.__module__}:{getattr(task, '__qualname__', type(task).__qualname__)}"


def _cells(
    grid: Mapping[str, Any], settings: Mapping[str, Any], seeds: int | Iterable[int], task: Task
) -> list[Cell]:
    """Return all cells, the last setting varying fastest but for the seed."""
    if not isinstance(seeds, Iterable):
        seeds = range(_checks.integer("seeds", seeds, 1))
    numbers = _checks.integers("seeds", [*seeds]).tolist()
    if not numbers or len(set(numbers)) < len(numbers):
        raise ValueError(f"seeds must be different numbers, at least one, got {numbers}")
    for name in _checks.instance("grid", grid, dict).keys() & settings.keys():
        raise ValueError(f"{name} must be in grid or in settings, got it in both")
    axes = {name: _named(name, values) for name, values in grid.items()}
    cells = []
    for names in product(*axes.values()):
        shown = dict(zip(axes, names, strict=True))
        setting = dict(settings) | {name: axes[name][value] for name, value in shown.items()}
        for seed in numbers:
            key = joblib.hash((_task_name(task), sorted(setting.items()), seed))
            cells.append(Cell(shown | {"seed": seed}, setting, seed, key))
    return cells


def _named(name: str, values: Any) -> dict[Any, Any]:
    """Return the values of a setting by what the table calls them."""
    if isinstance(values, Mapping):
        named = dict(values)
    else:
        if not isinstance(values, (list, tuple)):
            given = _checks.shown(values)
            raise ValueError(f"{name} must be a list of values, or a dictionary, got {given}")
        values = [value.item() if isinstance(value, np.generic) else value for value in values]
        named = {_name(name, value): value for value in values}
    if not named or len(named) < len(values):
        raise ValueError(f"{name} must have values of different names, got {_checks.shown(values)}")
    return named


def _name(setting: str, value: Any) -> Any:
    """Return what the table calls a value that has no name."""
    if value is None or isinstance(value, (bool, int, float, str)):
        return value
    if isinstance(value, Mapping) and "name" in value:
        rest = ", ".join(f"{k}={v}" for k, v in value.items() if k != "name")
        return f"{value['name']}({rest})"
    name = " ".join(repr(value).split())
    if len(name) > LONGEST_NAME or " at 0x" in name:
        raise ValueError(
            f"{setting} must be a dictionary that names its values, since one has no short name: "
            f"{_checks.shown(value)}"
        )
    return name


def _refuse(task: Task, measure: Callable[..., Any], cell: Cell) -> None:
    """Refuse settings that the task does not know, before anything is run."""
    try:
        inspect.signature(measure).bind(seed=cell.seed, **cell.setting)
    except TypeError as error:
        raise ValueError(f"settings must be those of {_task_name(task)}: {error}") from error
    if isinstance(task, str) and task in MEASURES:
        setting = {name: value for name, value in cell.setting.items() if name != "episodes"}
        arrange(task, setting)
        _checks.integer("episodes", cell.setting.get("episodes", 1), 1)


def _run(
    measure: Callable[..., Any], cells: list[Cell], jobs: int | Executor
) -> Iterator[tuple[str, dict[str, float] | Exception]]:
    """Yield each cell's key and values, or its error, as soon as it is finished."""
    if isinstance(jobs, Executor):
        futures = {jobs.submit(_try, measure, cell): cell.key for cell in cells}
        for future in as_completed(futures):
            lost = future.exception()  # Dask's, when workers died of the cell
            yield (futures[future], lost) if isinstance(lost, Exception) else future.result()
        return
    # In batches, a finished cell would wait for others before it is kept.
    parallel = joblib.Parallel(n_jobs=jobs, batch_size=1, return_as="generator_unordered")
    yield from parallel(joblib.delayed(_try)(measure, cell) for cell in cells)


def _try(measure: Callable[..., Any], cell: Cell) -> tuple[str, dict[str, float] | Exception]:
    try:
        found = measure(seed=cell.seed, **cell.setting)
        return cell.key, {str(name): float(value) for name, value in found.items()}
    except Exception as error:  # one bad cell must not cost a night
        error.add_note(traceback.format_exc())  # which a process does not send home by itself
        return cell.key, error.with_traceback(None)


def _begin(
    folder: str | os.PathLike[str] | None, task: Task, cells: list[Cell]
) -> dict[str, dict[str, float]]:
    """Write what the study is to its folder, and return the cells that are finished."""
    if folder is None:
        return {}
    folder = Path(folder)
    known = (_plan(folder) or {"versions": {"arkaq_edu": __version__}})["versions"]["arkaq_edu"]
    if known != __version__:
        raise ValueError(f"folder holds a study by arkaq_edu {known}, this is {__version__}")
    plan = {
        "format": FORMAT,
        "task": _task_name(task),
        "versions": {"arkaq_edu": __version__, "python": platform.python_version()}
        | {module.__name__: module.__version__ for module in (joblib, np, pd)},
        "cells": [{**cell.shown, "key": cell.key} for cell in cells],
    }
    _write(folder / "study.json", plan)
    found = {cell.key: _finished(folder, cell.key) for cell in cells}
    return {key: values for key, values in found.items() if values is not None}


def _plan(folder: Path) -> dict[str, Any] | None:
    path = folder / "study.json"
    return json.loads(path.read_text(encoding="utf-8")) if path.exists() else None


def _keep(folder: str | os.PathLike[str] | None, cell: Cell, values: dict[str, float]) -> None:
    """Write a finished cell to its file. JSON has no NaN: a missing value is null."""
    if folder is not None:
        shown = {name: None if math.isnan(x) else x for name, x in values.items()}
        _write(_file(Path(folder), cell.key), {**cell.shown, "values": shown})


def _finished(folder: Path, key: str) -> dict[str, float] | None:
    """Return the values of a finished cell, or None."""
    path = _file(folder, key)
    if not path.exists():
        return None
    values = json.loads(path.read_text(encoding="utf-8"))["values"]
    return {name: math.nan if x is None else float(x) for name, x in values.items()}


def _file(folder: Path, key: str) -> Path:
    return folder / "cells" / f"{key}.json"


def _write(path: Path, content: dict[str, Any]) -> None:
    with replacing(path) as fresh:
        fresh.write_text(json.dumps(content, indent=1) + "\n", encoding="utf-8")


def _table(cells: list[tuple[dict[str, Any], dict[str, float]]]) -> pd.DataFrame:
    rows = [
        {**shown, "quantity": name, "value": value}
        for shown, values in cells
        for name, value in values.items()
    ]
    return pd.DataFrame(rows, columns=[*cells[0][0], "quantity", "value"])

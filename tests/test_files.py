"""Every file that the package writes is written whole or not at all."""

import dataclasses
import errno
import importlib.util
import resource
from contextlib import contextmanager
from functools import cache

import nbformat
import pandas as pd
import pytest

from arkaq_edu import experiments, figures, pomdp
from arkaq_edu._copy import copy_course, course_folder
from arkaq_edu.arkaq import Arkaq
from arkaq_edu.figures.report import write_report

_spec = importlib.util.spec_from_file_location("store", course_folder() / "notebooks" / "store.py")
store = importlib.util.module_from_spec(_spec)
_spec.loader.exec_module(store)

RUNS = pd.DataFrame({"quantity": "centers, vigilance 0.15", "seed": range(20), "value": 150.0})
MEASURED = experiments.reproduce.Measurements(RUNS, pd.DataFrame())


def store_notebook(path):
    cells = [nbformat.v4.new_code_cell("1 + 1")]
    if not path.exists():
        nbformat.write(nbformat.v4.new_notebook(cells=cells), path)
    store.run, run = lambda notebook, folder: notebook, store.run
    try:
        store.store(path)
    finally:
        store.run = run


WRITERS = {
    "agent.npz": lambda path: Arkaq(rng=0).save(path),
    "model.pomdp": lambda path: pomdp.write_pomdp(pomdp.problem("tiger"), path),
    "picture.png": lambda path: figures.draw("5.6", path),
    "picture.svg": lambda path: figures.draw("5.6", path),
    "results.csv": lambda path: experiments.reproduce.write(path.parent, MEASURED, {}),
    "index.html": lambda path: write_report(path.parent, experiments.judge(RUNS), {}),
    "film.gif": lambda path: figures.save_film(film(), path),
    "film.html": lambda path: figures.save_film(film(), path),
    "page.ipynb": store_notebook,
    "notebooks/00_start_here.ipynb": lambda path: copy_course(path.parents[1]),
}


@cache
def film():
    """Two frames of a shot."""
    shot = experiments.goal.record_episode(experiments.goal.load_agent(), orientation=0.1)
    return dataclasses.replace(shot, frames=shot.frames[:2], looks=shot.looks[:2])


@contextmanager
def disk_full_after(n):
    """Let no file grow beyond n bytes."""
    limits = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (n, limits[1]))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, limits)


@pytest.mark.parametrize("name", WRITERS)
def test_a_full_disk_leaves_the_old_file_and_nothing_else(tmp_path, name):
    path, write = tmp_path / name, WRITERS[name]
    write(path)
    others = {p: p.read_bytes() for p in tmp_path.rglob("*") if p.is_file()}
    if name.startswith("notebooks"):  # a copy keeps what is there
        path.unlink()
        del others[path]
    with disk_full_after(100), pytest.raises(OSError) as error:
        write(path)
    assert error.value.errno == errno.EFBIG
    assert {p: p.read_bytes() for p in tmp_path.rglob("*") if p.is_file()} == others

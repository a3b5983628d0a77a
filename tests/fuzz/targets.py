"""What every reader owes to any bytes: a thing that is whole, or its own error.

Each target takes the bytes of a file and a folder to work in. `SEEDS` gives it good files to start
from. The fuzzer (``make fuzz``) and the tests call the same functions.
"""

from __future__ import annotations

import io
import json
import zipfile

import numpy as np

from arkaq_edu._paths import course_folder, data_file
from arkaq_edu.arkaq import Arkaq
from arkaq_edu.experiments import read_plan, study
from arkaq_edu.pomdp import PomdpFormatError, read_pomdp, write_pomdp

MEMBERS = ("settings", "centers", "counts", "Q", "visits", "history")
#: Between the members of an archive, in the bytes of the target `members`.
BREAK = b"\n--member--\n"


def pomdp(data: bytes, folder) -> None:
    """A model whose rows sum to 1 and that is read back as it was, or an error with a place."""
    path = folder / "a.pomdp"
    path.write_bytes(data)
    try:
        model = read_pomdp(path)
    except PomdpFormatError as error:
        assert 1 <= error.line <= data.count(b"\n") + data.count(b"\r") + 1
        assert 1 <= error.column <= len(data) + 1
        assert len(str(error)) < 500 + len(error.path)
        return
    if isinstance(model.T, np.ndarray) and isinstance(model.O, np.ndarray):
        for rows in (model.T, model.O, model.start):
            assert (rows >= 0).all() and np.allclose(rows.sum(-1), 1, rtol=0, atol=1e-9)
        if model.T.size + model.O.size < 10_000:
            write_pomdp(model, path)
            again = read_pomdp(path)
            for name in ("T", "O", "start"):
                assert np.array_equal(getattr(model, name), getattr(again, name)), name
            assert np.allclose(model.R, again.R, rtol=1e-14)
            assert (model.states, model.gamma) == (again.states, again.gamma)


def agent(data: bytes, folder) -> None:
    """An agent that can be used and saved again, or one error that names the file."""
    path, again = folder / "a.npz", folder / "again.npz"
    path.write_bytes(data)
    try:
        loaded = Arkaq.load(path)
    except ValueError as error:
        assert str(error).startswith(f"{path} is not an agent") and len(str(error)) < 1000
        return
    loaded.save(again)
    same = Arkaq.load(again)
    assert (loaded.phase, loaded.history, loaded.seed) == (same.phase, same.history, same.seed)
    if loaded.q is not None:
        assert np.array_equal(loaded.q.Q, same.q.Q)
        looks = np.zeros((2, len(loaded.sensing.low) + 1))
        looks[0, -1] = 1
        for one in (loaded, same):
            one.reset()
        for look in looks:
            action = loaded.act(look)
            assert action == same.act(look) and 0 <= action < loaded.q.Q.shape[1]


def members(data: bytes, folder) -> None:
    """The same for an archive that is sound, whatever its members are."""
    first, *rest = data.split(BREAK)
    packed = io.BytesIO()
    with zipfile.ZipFile(packed, "w") as archive:
        text = io.BytesIO()
        np.save(text, np.array(first.decode("utf-8", "replace").replace("\0", "")))
        archive.writestr("settings.npy", text.getvalue())
        for name, content in zip(MEMBERS[1:], rest, strict=False):
            archive.writestr(f"{name}.npy", content)
    agent(packed.getvalue(), folder)


def plan(data: bytes, folder) -> None:
    """The arguments of a study that `study` takes or refuses, or one error that names the file."""
    path = folder / "a.toml"
    path.write_bytes(data)
    try:
        found = read_plan(path)
    except ValueError as error:
        assert str(error).startswith(str(path)) and len(str(error)) < 1000
        return
    assert {"grid", "seeds"} <= found.keys()
    try:
        study(**{**found, "task": len_of}, jobs=1, progress=False)
    except ValueError as error:
        assert len(str(error)) < 1000
    except RuntimeError as error:
        assert "cells failed" in str(error)


def len_of(seed: int, **settings: object) -> dict[str, float]:
    """Stand in for a task."""
    return {"settings": len(settings)}


def _small_agent() -> dict[str, np.ndarray]:
    """Return the arrays of an agent with few states, made from the one of the course."""
    with np.load(data_file("ball_approach.npz")) as file:
        arrays = {name: file[name] for name in MEMBERS}
    few = {name: arrays[name][:5] for name in MEMBERS[1:]}
    return few | {"settings": arrays["settings"]}


def _agents() -> list[bytes]:
    packed = io.BytesIO()
    np.savez_compressed(packed, **_small_agent())
    stored = io.BytesIO()
    np.savez(stored, **_small_agent())
    return [packed.getvalue(), stored.getvalue()]


def _members() -> list[bytes]:
    arrays, contents = _small_agent(), []
    settings = json.loads(str(arrays["settings"]))
    for name in MEMBERS[1:]:
        file = io.BytesIO()
        np.save(file, arrays[name])
        contents.append(file.getvalue())
    grid = settings | {"segmenter": {"class": "UniformGrid", "cells": [5, 1]}}
    young = settings | {"phase": "segmentation", "done_in_phase": 0}
    other = settings | {"learner": {"class": "Sarsa"}}
    return [
        BREAK.join([json.dumps(one).encode(), *contents]) for one in (settings, grid, young, other)
    ]


def _plans() -> list[bytes]:
    return [
        b"seeds = 2\n[grid]\nvigilance = [0.2, 0.3]\n[settings]\npatterns = 500\n",
        b'task = "goal"\nseeds = [1, 5]\n[grid]\nlearner = ["Sarsa", "QLearning"]\n',
        b'seeds = 1\ngrid = {a = [1, 2.5, "x", true, [1, 2]]}\nsettings = {b = {c = nan}}\n',
    ]


def _pomdps() -> list[bytes]:
    files = sorted((course_folder() / "data" / "pomdp").glob("*.pomdp"))
    every_word = b"""discount: 0.5 values: cost states: a b actions: 2 observations: x y
start include: a 1
T: 0 identity
T: 1 : a uniform
T: 1 : b reset
O: * : * 0.25 0.75
R: 0 : * : * : * -1.5e0
R: 1 : a : b
1 2"""
    return [every_word, *(file.read_bytes() for file in files)]


TARGETS = {"pomdp": pomdp, "agent": agent, "members": members, "plan": plan}
SEEDS = {"pomdp": _pomdps, "agent": _agents, "members": _members, "plan": _plans}
#: Words that the fuzzer may put together.
WORDS = {
    "pomdp": [
        "discount:", "values:", "reward", "cost", "states:", "actions:", "observations:", "start",
        "start:", "include:", "exclude:", "T:", "O:", "R:", "*", ":", "uniform", "identity",
        "reset", "#", "65536", "65537", "1e100", "1e999", "nan", "-0",
    ],
    "plan": [
        "seeds", "[grid]", "[settings]", "task", "=", "[", "]", "{", "}", "nan", "inf", "1e400",
    ],
    "agent": ["PK\3\4", "PK\1\2", "PK\5\6", "Q.npy", "settings.npy", "\x93NUMPY"],
    "members": [
        "'descr': ", "'<f8'", "'|O'", "'<i8'", "'<U4'", "'shape': ", "(1000000000000,)", "\\n",
        "'fortran_order': True", "\"phase\"", "\"finished\"", "\"Q-learning\"", "NaN", "Infinity",
        "null", "1e308", "10000000000000000000000", "\"class\": \"UniformGrid\"", "[[]]", "true",
        "\"cells\"", "\"task\": \"goal\"", "\"environments\"",
    ],
}  # fmt: skip

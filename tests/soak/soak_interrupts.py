"""Ctrl-C at many random moments of every command that takes long."""

import random

import pytest

from tests.soak.command import SHARE, stopped, without_bars

COMMANDS = {
    "train": ["train"],
    "train goal": ["train", "goal"],
    "watch": ["watch", "--out", "walk.gif"],
    "reproduce": ["reproduce", "--seeds", 4, "--jobs", 2],
}


@pytest.mark.parametrize("compiled", [True, False], ids=["compiled", "compiling"])
@pytest.mark.parametrize("name", COMMANDS)
def test_ctrl_c_at_random_moments(tmp_path, name, compiled):
    moments, wrong = random.Random(0), []
    for trial in range(max(3, round(40 * SHARE))):
        cache = {} if compiled else {"NUMBA_CACHE_DIR": str(tmp_path / f"cache-{trial}")}
        folder = tmp_path / f"trial-{trial}"
        folder.mkdir()
        seconds = moments.uniform(0, 3 if compiled else 12)
        ended = stopped(COMMANDS[name], folder, seconds, **cache)
        finished = ended.status == 0 and name == "watch"
        if not finished and (ended.status, without_bars(ended.said)) != (
            130,
            ["arkaq: interrupted"],
        ):
            wrong.append((seconds, ended))
    assert wrong == []

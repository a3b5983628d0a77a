"""A reproduction: kept as it goes, and the same bytes however often it was stopped."""

import json
import os
import signal
import time
from dataclasses import replace

import numpy as np
import pandas as pd
import pytest

from arkaq_edu.arkaq import TrainingSettings
from arkaq_edu.experiments import approach, judge, measure
from arkaq_edu.experiments.reproduce import write
from arkaq_edu.experiments.runs import Plan, kept

BRIEF = TrainingSettings(patterns=200, exploration=300, exploitation=100)
BRIEF_GOAL = TrainingSettings.goal(patterns=100, exploration=100, exploitation=50)


@pytest.fixture(scope="module")
def plan(tmp_path_factory):
    return Plan(tmp_path_factory.mktemp("run"), 12, BRIEF, BRIEF_GOAL)


@pytest.fixture(scope="module")
def measured(plan):
    return measure(1, plan, jobs=1, progress=False)


def test_runs_reproduce_every_mean_and_band(plan, measured, tmp_path):
    write(tmp_path, measured, plan.settings())
    runs = pd.read_csv(tmp_path / "runs.csv")
    results = pd.read_csv(tmp_path / "results.csv")
    assert set(results.quantity) <= set(runs.quantity)
    for row in results.itertuples():
        values = runs.value[runs.quantity == row.quantity].to_numpy()
        low, high = np.quantile(values, [0.025, 0.975])
        assert (row.mean, row.low, row.high) == pytest.approx((values.mean(), low, high), rel=6e-4)
        assert row.seeds == runs.seed[runs.quantity == row.quantity].notna().sum()
    assert judge(runs).to_csv() == judge(measured.runs).to_csv()


def test_every_claim_is_measured(measured):
    from arkaq_edu.experiments.claims import CLAIMS

    assert set(judge(measured.runs).quantity) == {claim.quantity for claim in CLAIMS}


def test_nothing_is_run_again_and_nothing_changes(plan, measured, monkeypatch):
    monkeypatch.setattr(approach, "evaluate", None)
    monkeypatch.setattr(approach, "train", None)
    again = measure(1, plan, jobs=1, progress=False)
    for one, other in zip(measured, again, strict=True):
        assert one.to_csv() == other.to_csv()


def test_what_was_measured_with_other_settings_is_measured_again(tmp_path):
    calls = []

    def count(seed, plan):
        calls.append(plan.episodes)
        return {"x": float(seed)}

    for episodes in (3, 3, 4):
        assert kept(count, "run", 5, Plan(tmp_path, episodes)) == (5, {"x": 5.0})
    assert calls == [3, 4]


def test_the_manifest_says_with_what_and_how_long(plan, measured):
    write(plan.folder, measured, {"seeds": 1})
    manifest = json.loads((plan.folder / "run.json").read_text())
    assert manifest["settings"] == {"seeds": 1}
    assert {"python", "numpy", "pymunk"} <= set(manifest["versions"])
    assert len(manifest["seconds"]) == len(list((plan.folder / "runs").iterdir())) == 11


@pytest.mark.skipif(not hasattr(os, "fork"), reason="kills a copy of this process")
def test_killed_twice_on_the_way_it_gives_the_same_bytes(plan, measured, tmp_path):
    fresh = replace(plan, folder=tmp_path)
    for files in (2, 6):  # stop it when so many runs are kept
        child = os.fork()
        if child == 0:
            measure(1, fresh, jobs=1, progress=False)
            os._exit(0)
        while len(list((tmp_path / "runs").glob("[!.]*.json"))) < files:
            time.sleep(0.01)
        os.kill(child, signal.SIGKILL)
        assert os.waitpid(child, 0)[1] == signal.SIGKILL
    write(plan.folder, measured, {})
    write(tmp_path, measure(1, fresh, jobs=1, progress=False), {})
    for name in ("results.csv", "runs.csv", "curves.csv"):
        assert (tmp_path / name).read_bytes() == (plan.folder / name).read_bytes()

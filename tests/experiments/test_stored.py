"""The studies that come with the course: each table is the result of its plan."""

import pandas as pd
import pytest

from arkaq_edu._paths import course_folder
from arkaq_edu.experiments import bands, load_study, read_plan
from arkaq_edu.experiments.studies import _cells

FOLDER = course_folder() / "data" / "studies"
STORED = sorted(path.stem for path in FOLDER.glob("*.csv"))


def test_every_plan_has_been_run():
    assert sorted(path.stem for path in FOLDER.glob("*.toml")) == STORED


@pytest.mark.parametrize("name", STORED)
def test_a_stored_table_has_the_cells_of_its_plan_in_their_order(name):
    table, plan = load_study(name), read_plan(FOLDER / f"{name}.toml")
    cells = _cells(plan["grid"], plan.get("settings", {}), plan["seeds"], plan["task"])
    columns = [*cells[0].shown]
    assert table.columns.tolist() == [*columns, "quantity", "value"]
    found = table[columns].drop_duplicates()
    pd.testing.assert_frame_equal(
        found.reset_index(drop=True), pd.DataFrame([cell.shown for cell in cells])
    )
    quantities = table.groupby(columns, sort=False).quantity.agg(tuple)
    assert quantities.nunique() == 1
    assert table.value.notna().mean() > 0.99
    assert table.seed.nunique() == plan["seeds"] == 30


@pytest.mark.parametrize("name", [name for name in STORED if name.endswith(("_goal", "_approach"))])
def test_what_a_robot_earned_and_what_the_planner_earned_more_agree(name):
    table = load_study(name)
    settings = [*table.columns[:-2]]
    wide = table.pivot(index=settings, columns="quantity", values="value")
    best = wide.reward + wide.regret
    # The planner plays the same episodes whatever the setting.
    assert (best.groupby("seed").max() - best.groupby("seed").min()).max() < 1e-9


def test_bands_are_two_standard_errors_to_each_side():
    rows = [["a", seed, "x", value] for seed, value in enumerate([1.0, 2.0, 6.0])]
    table = pd.DataFrame(rows, columns=["part", "seed", "quantity", "value"])
    wanted = f"3.00 ± {2 * (7 / 3) ** 0.5:.2f}"  # the variance of three values is 7
    assert bands(table, "x", digits=2).loc["a", "x"] == wanted

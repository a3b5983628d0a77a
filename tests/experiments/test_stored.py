"""The studies that come with the course: each table is the result of its plan."""

import pandas as pd
import pytest

from arkaq_edu._paths import course_folder
from arkaq_edu.arkaq import TrainingSettings
from arkaq_edu.experiments import bands, goal, load_study, read_plan
from arkaq_edu.experiments.studies import _cells

FOLDER = course_folder() / "data" / "studies"
STORED = sorted(path.stem for path in FOLDER.glob("*.csv"))
SEEDS = {"deep": 10}


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
    assert table.seed.nunique() == plan["seeds"] == SEEDS.get(name, 30)


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


def gains(name, quantity, usual):
    """How many standard errors each setting gains over the usual one, in pairs of one seed."""
    table = pd.concat([load_study(each) for each in name.split(" + ")])
    wide = table[table.quantity == quantity].pivot(
        index="seed", columns=table.columns[0], values="value"
    )
    change = wide.drop(columns=usual).sub(wide[usual], axis=0)
    return (change.mean() / change.sem()).to_dict()


SEGMENTERS = "segmenters_{0} + tiles_{0}".format
BETTER, WORSE, EQUAL = (lambda z: z >= 2), (lambda z: z <= -2), (lambda z: abs(z) < 2)
SAID = [
    # study, quantity, the usual setting, what chapter 12 says of the others
    ("vigilance_goal", "success", 0.1, {0.3: EQUAL, 0.15: EQUAL, 0.06: EQUAL, 0.03: WORSE}),
    ("vigilance_goal", "learning_time", 0.1, {0.03: BETTER}),
    ("vigilance_approach", "success", 0.3, {0.2: WORSE, 0.1: WORSE, 0.05: WORSE}),
    ("vigilance_approach", "bonus", 0.1, {0.05: WORSE}),
    ("sensing_approach", "reward", "consistent",
     {"unfiltered": EQUAL, "thesis": WORSE, "uncontrolled": WORSE}),
    ("sensing_approach", "reward", "unfiltered", {"thesis": WORSE}),
    ("learners_goal", "success", "QLearning",
     {"Sarsa": BETTER, "ExpectedSarsa": BETTER, "AveragedQ": EQUAL}),
    (SEGMENTERS("goal"), "success", "Euclidean ART",
     {"ART 2-A": EQUAL, "tile coding": EQUAL, "uniform grid": WORSE, "ART2": WORSE}),
    (SEGMENTERS("goal"), "learning_time", "Euclidean ART",
     {"ART 2-A": WORSE, "tile coding": WORSE}),
    (SEGMENTERS("approach"), "bonus", "Euclidean ART",
     {"ART 2-A": EQUAL, "ART2": EQUAL, "uniform grid": EQUAL, "tile coding": WORSE}),
    ("exploring_goal", "success", "QLearning", {"AtRandom": EQUAL, "EpsilonGreedy": EQUAL}),
    ("exploring_approach", "reward", "QLearning", {"AtRandom": EQUAL, "EpsilonGreedy": EQUAL}),
    ("holding_approach", "reward", "QLearning", {"AsPrinted": EQUAL}),
    ("holding_approach", "learning_time", "QLearning", {"AsPrinted": BETTER}),  # later
    ("learners_approach", "reward", "QLearning",
     {"Sarsa": EQUAL, "AveragedQ": EQUAL, "ExpectedSarsa": WORSE}),
    ("planned", "reward", "last look", {"belief": BETTER}),
]  # fmt: skip


@pytest.mark.parametrize(("name", "quantity", "usual", "said"), SAID)
def test_chapter_12_says_what_the_tables_show(name, quantity, usual, said):
    found = gains(name, quantity, usual)
    assert [other for other, agrees in said.items() if not agrees(found[other])] == []


def test_even_the_worst_robots_of_sarsa_beat_the_mean_of_q_learning():
    table = load_study("learners_goal").query("quantity == 'success'")
    scores = table.pivot(index="seed", columns="learner", values="value")
    assert scores.Sarsa.nsmallest(5).mean() > scores.QLearning.mean()


def test_each_small_pomdp_is_as_hard_as_chapter_12_says():
    table = load_study("hidden").query("quantity == 'regret'")
    regret = table.groupby(["problem", "remembers"]).value.mean().unstack()
    assert regret.loc["ball_side"].max() < 5  # the last look is enough
    assert regret.loc["cheese", "last look"] > 10 * regret.loc["cheese", "two looks"]
    assert regret.loc["tiger", ["last look", "two looks"]].min() > 5 * regret.belief["tiger"]


def test_a_network_learns_less_than_chapter_12_says_arkaq_does():
    plan, settings = read_plan(FOLDER / "deep.toml"), TrainingSettings.goal()
    cycles = settings.patterns + settings.exploration + settings.exploitation
    assert plan["settings"]["steps"] == cycles
    deep = load_study("deep").pivot_table("value", ["goal_distance", "seed"], "quantity")
    near, arkaq = deep.success["near"], goal.rates(goal.load_study())["near", "ARKAQ, learned"]
    assert near.mean() > deep["success at random"]["near"].max()
    assert near.mean() + 1.9 * near.sem() < arkaq.mean() and near.std() > 2 * arkaq.std()
    assert (deep.success["far"] == 0).all() and (deep["success at random"]["far"] > 0).all()

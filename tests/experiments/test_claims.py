"""What judges the thesis's numbers and claims."""

import re

import numpy as np
import pandas as pd
import pytest

from arkaq_edu.arkaq import TrainingSettings
from arkaq_edu.experiments import counts
from arkaq_edu.experiments.claims import (
    CLAIMS,
    INSIDE,
    NO_NUMBER,
    OUTSIDE,
    WRONG,
    Claim,
    band,
    computed,
    judge,
    with_derived,
)
from arkaq_edu.experiments.runs import tidy
from arkaq_edu.mdp.optimality import earnings


def test_every_claim_has_a_quantity_of_its_own_a_place_and_a_sentence():
    assert len({claim.quantity for claim in CLAIMS}) == len(CLAIMS) > 80
    for claim in CLAIMS:
        assert re.fullmatch(r"(figures?|eq|section|chapter) \d[\d.]*(-[\d.]+)?", claim.place)
        assert claim.why.endswith(".") and len(claim.why) < 250
        assert claim.thesis is None or claim.number is not None or claim.holds is not None


def test_a_band_holds_ninety_five_in_a_hundred():
    values = np.random.default_rng(0).normal(10, 2, 10_000)
    low, high = band(values)
    assert ((values >= low) & (values <= high)).mean() == pytest.approx(0.95, abs=1e-3)
    assert (low, high) == pytest.approx((10 - 1.96 * 2, 10 + 1.96 * 2), abs=0.15)


@pytest.mark.parametrize(
    ("printed", "values", "verdict"),
    [
        ("60", [55, 58, 63, 66], INSIDE),
        ("60", [61, 62, 63], OUTSIDE),
        ("60", [60.4, 60.4], INSIDE),  # to the digits that are printed
        ("60.0", [60.4, 60.4], OUTSIDE),
        ("0.164", [0.16363636], INSIDE),
        (None, [1.0], NO_NUMBER),
    ],
)
def test_a_number_is_inside_if_it_lies_in_the_band_to_its_digits(printed, values, verdict):
    assert Claim("x", "figure 5.40", printed, "why.").verdict(np.array(values, float)) == verdict


@pytest.mark.thesis("errata row 40")
def test_what_the_thesis_prints_wrongly_is_told_from_what_differs_here():
    found = pd.Series({name: [value] for name, value in computed().items()})
    verdict = {
        c.quantity: c.verdict(np.array(found[c.quantity])) for c in CLAIMS if c.quantity in found
    }
    wrong = {name for name, given in verdict.items() if given == WRONG}
    assert wrong == {
        "upper minus middle chain, six terms as eq 2.1 prints",
        "chains that the two models without a horizon choose",
        "a floor down: floor 3", "a floor down: floor 2", "a floor down: floor 1",
        "V(a1) - V(a2) at p(s1) = 0",
        "numbers that one update of Q reads, 20 states, 3 actions",
    }  # fmt: skip
    assert OUTSIDE not in verdict.values()


def test_a_table_is_what_the_runs_say():
    rng = np.random.default_rng(1)
    counts = rng.normal(150, 4, 20)
    runs = tidy((seed, {"centers, vigilance 0.15": n}) for seed, n in enumerate(counts))
    row = judge(runs).iloc[0]
    assert row["mean"] == pytest.approx(counts.mean(), rel=1e-3)
    assert row.low == pytest.approx(np.quantile(counts, 0.025), rel=1e-3)
    assert row.high == pytest.approx(np.quantile(counts, 0.975), rel=1e-3)
    assert row.off_by == pytest.approx(counts.mean() - 137, rel=1e-3)
    assert (row.thesis, row.place, row.verdict, row.seeds) == ("137", "figure 5.10", OUTSIDE, 20)
    for value in (row["mean"], row.low, row.high):
        assert len(f"{value:g}") <= 5


def test_differences_are_taken_seed_by_seed():
    near, far = "goals (%), near, random actions", "goals (%), far, random actions"
    runs = tidy([(0, {near: 40.0, far: 30.0}), (1, {near: 20.0, far: 15.0})])
    added = with_derived(runs).set_index("quantity").value
    assert added["goals (%), random actions: near minus far"].tolist() == [10.0, 5.0]
    assert judge(runs).set_index("quantity").verdict.filter(like="minus far").tolist() == [INSIDE]


@pytest.mark.thesis("errata row 41")
def test_the_best_number_of_states_is_that_of_the_agent_that_earns_most():
    rhos = ("0.15", "0.1", "0.075", "0.05", "0.025")
    values = {
        f"reward, ARKAQ, vigilance {rho}": r for rho, r in zip(rhos, (1, 2, 9, 3, 4), strict=True)
    }
    values |= {f"states, ARKAQ, vigilance {rho}": 100.0 * i for i, rho in enumerate(rhos)}
    swept = tidy([(0, values), (1, {"reward, ARKAQ, vigilance 0.1": 5.0})])
    made = with_derived(swept).set_index("quantity")
    assert made.loc["states with which most reward is earned"].to_list() == [0, 200.0]


def test_a_claim_about_a_sign_says_in_how_many_seeds_it_is_so():
    kept = "goals (%), near: the last 200 kicks minus the first 100"
    rows = judge(tidy((seed, {kept: value}) for seed, value in enumerate([3.0, 5.0, -1.0])))
    assert rows.why[0].endswith("It exploits what it has learned. It is so in 2 of 3 seeds.")
    assert judge(tidy([(0, {kept: 3.0})])).why[0] == "It exploits what it has learned."


def test_the_numbers_in_the_reasons_are_those_that_are_found():
    why = {claim.quantity: claim.why for claim in CLAIMS}
    found = counts.load_search()
    eta, patterns, least = counts.nearest(found)
    said = why["centers, vigilance 0.1"]
    assert (eta, patterns) == (TrainingSettings().learning_rate, TrainingSettings().patterns)
    stops = counts.needed(found, eta)
    assert f"by {least:.0f} %" in said
    assert f"({round(stops.min(), -3):,.0f} to {round(stops.max(), -3):,.0f} patterns)" in said
    assert "39 × 10" in why["states with which most reward is earned"]
    assert computed()["footsteps along times across"] == 390
    assert "8, 10 and 0" in why["upper minus middle chain, six terms as eq 2.1 prints"]
    assert earnings(6, 0.9)[0].tolist() == [8, 10, 0]

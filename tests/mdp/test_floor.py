"""Value iteration and Q-learning on the course's floor: what the chapter says of them."""

import itertools

from arkaq_edu.mdp.floor import lives, sweeps


def test_the_error_falls_by_gamma_a_sweep_at_least_and_stays_below_its_bound():
    for gamma, slip in itertools.product((0.5, 0.8, 0.95), (0.0, 0.1, 0.5)):
        run = sweeps(gamma, slip)
        assert (run.error[1:] <= gamma * run.error[:-1] + 1e-9).all()
        assert (run.error <= run.bound + 1e-9).all()
        assert run.right[-1].sum() == 37 or run.error[-1] > 0.01


def test_the_chapter_asks_of_the_bridge_and_this_is_the_answer():
    """At its left end: across by default; away where feet slip, and where the sight is short."""
    chosen = {}
    for gamma, slip in ((0.95, 0.1), (0.95, 0.5), (0.5, 0.1)):
        run = sweeps(gamma, slip)
        chosen[gamma, slip] = run.best[-1][run.grid.places.tolist().index([2, 3])].tolist()
    across, away = [True, False, False, False], [False, False, True, False]
    assert list(chosen.values()) == [across, away, away]


def test_the_band_says_what_the_chapter_says_of_learning_rate_and_temperature():
    """At slip 0.1: a constant 1 does not settle; a cold robot stays ignorant; 0.1 does well."""
    final = {
        (alpha, T): lives(alpha, T).error[:, -1].mean()
        for alpha, T in ((0.1, 10.0), (1.0, 1000.0), (0.1, 0.1), ("1/visits", 10.0))
    }
    assert final[0.1, 10.0] < 10
    assert final[1.0, 1000.0] > 60, "hot and hasty: every fall counts as if it were certain"
    assert final[0.1, 0.1] > 30, "cold: it takes the first step it finds"
    assert final["1/visits", 10.0] > 15, "the first, empty targets weigh too long"

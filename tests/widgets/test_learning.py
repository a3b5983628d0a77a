"""The explorers of chapter 1 without a browser: what they draw at every end of their controls."""

import itertools
import re

import numpy as np
import pytest

from arkaq_edu.mdp import machines
from arkaq_edu.mdp.machines import MACHINES
from arkaq_edu.widgets import bandit_explorer, horizon_explorer, learning
from arkaq_edu.widgets.scene import Cells, Line, Points, Text

CHAINS = ((2, 2.0), (5, 10.0), (6, 11.0))
NAMES = ("upper", "middle", "lower")


def set_all(explorer, **values):
    for name, value in values.items():
        explorer.controls[name].value = value
        assert explorer.error is None


# --- the three models -----------------------------------------------------------------------------


@pytest.fixture(scope="module")
def models():
    return horizon_explorer()


def sums(h, gamma):
    """What the three chains earn by the three models, from their closed forms."""
    finite = [max(h - delay, 0) * reward for delay, reward in CHAINS]
    geometric = [gamma**delay * reward / (1 - gamma) for delay, reward in CHAINS]
    return finite, geometric, [reward for _, reward in CHAINS]


def first(earned):
    """The names of the best, as the explorer says them."""
    best = [name for name, x in zip(NAMES, earned, strict=True) if x > max(earned) - 1e-9]
    return "any" if len(best) == 3 else " or ".join(best)


def coins(x):
    """Three digits, and four of a thousand."""
    return f"{x:.4g}" if x > 999 else f"{x:.3g}"


ENDS = list(itertools.product((1, 5, 6, 16, 17, 30), (0.0, 0.58, 0.59, 0.9, 0.91, 0.99)))


@pytest.mark.parametrize("h, gamma", ENDS)
def test_the_explorer_says_what_each_chain_earns_and_which_is_chosen(models, h, gamma):
    set_all(models, h=h, gamma=gamma)
    earned = sums(h, gamma)
    told = [f"{first(e)} ({', '.join(map(coins, e))})" for e in earned]
    assert repr(models) == f"h = {h}: {told[0]}; gamma = {gamma:g}: {told[1]}; average: {told[2]}"
    scales = (h, 1 / (1 - gamma), 1)
    for panel, model, scale in zip(models.drawn.panels, earned, scales, strict=True):
        marks = [x for x in panel.layers if isinstance(x, Points)]
        here = [mark for mark in marks if mark.y[0] < 11.5 and mark.radius != 4.0]
        assert [mark.y[0] for mark in here] == pytest.approx(np.array(model) / scale)
        large = {mark.radius for mark, x in zip(here, model, strict=True) if x == max(model)}
        small = {mark.radius for mark, x in zip(here, model, strict=True) if x < max(model) - 1e-9}
        assert not large or not small or min(large) > max(small), "the chosen one is marked"
    for panel, model in zip(models.drawn.panels[:2], earned, strict=False):
        words = [layer.text for layer in panel.layers if isinstance(layer, Text)]
        assert words[1:] == [f"{n}: {coins(x)}" for n, x in zip(NAMES, model, strict=True)]


def test_the_curves_are_the_closed_forms_and_meet_where_the_choice_flips(models):
    over_h, over_gamma, _ = models.drawn.panels
    for panel, step in ((over_h, 0), (over_gamma, 1)):
        curves = [x for x in panel.layers if isinstance(x, Line) and x.width == 2.0]
        for i, curve in enumerate(curves):
            for x, y in zip(curve.x, curve.y, strict=True):
                at = (x, 0.5) if step == 0 else (1, x)
                scale = x if step == 0 else 1 / (1 - x)
                assert y == pytest.approx(sums(*at)[step][i] / scale)
    colors = learning.CHAIN_COLORS

    def strip(panel):
        cells = next(layer for layer in panel.layers if isinstance(layer, Cells))
        pieces = zip(cells.polygons, cells.colors, strict=True)
        return [(cells.palette[c], piece[:, 0].min(), piece[:, 0].max()) for piece, c in pieces]

    gray = strip(over_h)[0][0]
    assert strip(over_h) == [
        (gray, 1, 2.5), (colors["upper"], 2.5, 5.5), (colors["middle"], 5.5, 15.5),
        (gray, 15.5, 16.5), (colors["lower"], 16.5, 30),
    ]  # fmt: skip
    flips = [end for color, _, end in strip(over_gamma) if color != gray][:-1]
    # Two chains earn alike where gamma^(difference of the delays) is the ratio of the rewards.
    assert flips == pytest.approx([(2 / 10) ** (1 / 3), 10 / 11], abs=0.005)


def test_it_starts_at_the_thesiss_numbers_and_a_step_more_flips_the_choice(models):
    explorer = horizon_explorer()
    assert "h = 5: upper (6, 0, 0); gamma = 0.9: middle (16.2, 59, 58.5)" in repr(explorer)
    set_all(explorer, h=6, gamma=0.91)
    assert re.match(r"h = 6: middle \(8, 10, 0\); gamma = 0.91: lower", repr(explorer))


def test_a_sum_of_more_than_a_thousand_is_said_in_full():
    explorer = horizon_explorer()
    set_all(explorer, gamma=0.99)
    assert "gamma = 0.99: lower (196, 951, 1036);" in repr(explorer)
    words = [x.text for x in explorer.drawn.panels[1].layers if isinstance(x, Text)]
    assert "lower: 1036" in words


def test_a_slider_that_adds_up_steps_says_no_other_gamma():
    assert learning.draw_models(5, 0.1 + 0.2).fact == learning.draw_models(5, 0.3).fact


@pytest.mark.parametrize("h", [0, 31, 2.5])
def test_a_horizon_that_is_not_on_the_axis_is_refused(h):
    with pytest.raises(ValueError, match=r"h must be an integer in \[1, 30\]"):
        learning.draw_models(h, 0.9)


# --- the bandit -----------------------------------------------------------------------------------

FACT = re.compile(
    r"(\d+) pulls?, (\d+) coins?: regret (-?[\d.]+) (with|without) luck; random (-?[\d.]+), "
    r"epsilon-greedy (-?[\d.]+), Boltzmann (-?[\d.]+), UCB (-?[\d.]+)"
)


@pytest.fixture
def bandit():
    return bandit_explorer()


@pytest.mark.parametrize("number", [1, 3, 30])
@pytest.mark.parametrize("reveal", [False, True])
@pytest.mark.parametrize("n", [1, 13, 41, 120])
def test_the_explorer_counts_what_the_presses_earned(bandit, number, reveal, n):
    set_all(bandit, machines=number)
    presses = tuple(MACHINES[i % 3] for i in range(n))
    set_all(bandit, pulls=presses, reveal=reveal)
    played = machines.game(number, presses)
    chances = played.bandit.p
    assert [MACHINES[arm] for arm in played.arms] == list(presses)
    fact = FACT.fullmatch(repr(bandit))
    assert [int(fact[1]), int(fact[2])] == [n, played.rewards.sum()]
    expected = [max(chances) - chances[i % 3] for i in range(n)]
    shortfalls = expected if reveal else [max(chances) - r for r in played.rewards]
    assert float(fact[3]) == pytest.approx(sum(shortfalls), abs=0.051)
    assert fact[4] == ("without" if reveal else "with")

    left, right = bandit.drawn.panels
    yours = next(x for x in right.layers if isinstance(x, Line) and len(x.x) == n + 1
                 and x.width == 2.6)  # fmt: skip
    assert np.diff(yours.y) == pytest.approx(shortfalls)
    for mark in (x for x in left.layers if isinstance(x, Points)):
        paid = [r for i, r in enumerate(played.rewards) if i % 3 == mark.x[0] - 1]
        assert mark.hollow and mark.y[0] == pytest.approx(np.mean(paid))
    shown = [x.y[0] for x in left.layers if isinstance(x, Line)]
    assert shown == (pytest.approx(chances) if reveal else [])
    assert right.xlim[1] >= n and right.ylim[1] >= max(yours.y)


def test_buttons_play_other_machines_are_a_new_game_and_hide_their_chances(bandit):
    assert bandit.controls["pulls"].value == learning.OPENING
    assert FACT.match(repr(bandit))[1] == "12"
    bandit.controls["pulls"].children[1].click()
    assert FACT.match(repr(bandit))[1] == "13"
    set_all(bandit, reveal=True)
    assert "without luck" in repr(bandit)
    set_all(bandit, machines=4)
    assert repr(bandit) == "no pull yet: which of the four machines pays best?"
    assert bandit.controls["reveal"].value is False
    bandit.controls["pulls"].children[0].click()
    assert FACT.match(repr(bandit))[1] == "1"
    bandit.controls["pulls"].children[-1].click()
    assert repr(bandit).startswith("no pull yet")


def test_all_the_words_stay_inside_their_panels(models, bandit):
    set_all(models, h=30, gamma=0.99)
    set_all(bandit, pulls=MACHINES * 60, reveal=True)
    for panel in (*models.drawn.panels, *bandit.drawn.panels):
        for word in (layer for layer in panel.layers if isinstance(layer, Text)):
            assert panel.xlim[0] <= word.x <= panel.xlim[1]
            assert panel.ylim[0] <= word.y <= panel.ylim[1]


def test_what_is_no_machine_is_refused():
    with pytest.raises(ValueError, match="name must be one of machine 1"):
        bandit_explorer().controls["pulls"].press("machine 5")

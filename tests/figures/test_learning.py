"""The pictures of the chapter on reinforcement learning: what they draw is what was computed."""

import matplotlib.pyplot as plt
import numpy as np
import pytest
from matplotlib.colors import to_rgb
from matplotlib.figure import Figure

from arkaq_edu.figures import FIGURES, learning
from arkaq_edu.mdp import earnings


@pytest.fixture
def ax():
    return Figure().subplots()


def by_hand(delay, reward, horizon, gamma):
    """What a chain earns by each model, term by term."""
    rewards = [0.0] * delay + [reward] * 5000
    return (
        sum(rewards[:horizon]),
        sum(gamma**t * r for t, r in enumerate(rewards)),
        reward,
    )


@pytest.mark.thesis("figure 2.1")
def test_the_loop_closes_through_indication_reward_and_policy(ax):
    plot = learning.figure_2_1(ax)
    after = {}
    for start, end in plot.wires:
        after.setdefault(start, set()).add(end)
    assert after == {
        "world": {"I", "R"}, "I": {"policy"}, "R": {"policy"}, "policy": {"world"},
    }  # fmt: skip
    symbols = " ".join(text.get_text() for text in plot.parts.values())
    for symbol in ("$s$", "$I$", "$o$", r"$\pi$", "$R$", "$r$", "$a$"):
        assert symbol in symbols
    # Beside a wire stands what it carries: its name is between the two things that it joins.
    place = {name: text.get_position() for name, text in plot.parts.items()}
    for name, start, end in (("s", "world", "I"), ("o", "I", "policy"), ("r", "R", "policy")):
        assert place[start][0] < place[name][0] < place[end][0]


@pytest.mark.parametrize("horizon, gamma", [(1, 0.0), (5, 0.9), (6, 0.91), (16, 0.5), (40, 0.99)])
def test_figure_2_2_is_the_thesiss_chains_and_their_earnings(ax, horizon, gamma):
    plot = learning.figure_2_2(ax, horizon=horizon, gamma=gamma)
    expected = np.array(
        [by_hand(delay, reward, horizon, gamma) for delay, reward in ((2, 2), (5, 10), (6, 11))]
    )
    assert pytest.approx(expected) == earnings(horizon, gamma).T
    for i, (name, delay) in enumerate({"upper": 2, "middle": 5, "lower": 6}.items()):
        assert len(plot.chains[name]) == delay + 1, "an arrow a step, and the last state's own"
        told = [text.get_text() for text in plot.earnings[name]]
        assert told == [f"{x:.3g}" for x in expected[i]]
        bold = [text.get_weight() == "bold" for text in plot.earnings[name]]
        assert bold == [bool(np.isclose(x, x_all.max())) for x, x_all in zip(
            expected[i], expected.T, strict=True
        )]  # fmt: skip


def test_figure_2_2_prints_the_thesiss_digits(ax):
    plot = learning.figure_2_2(ax)
    told = {name: [text.get_text() for text in texts] for name, texts in plot.earnings.items()}
    assert told == {
        "upper": ["6", "16.2", "2"],
        "middle": ["0", "59", "10"],
        "lower": ["0", "58.5", "11"],
    }
    labels = {text.get_text() for text in ax.texts}
    assert {"+2", "+10", "+11"} <= labels


@pytest.mark.parametrize(
    "horizon, gamma, fact",
    [
        (1, 0.0, "best is any with 1 step left, any discounted by 0, the lower on average"),
        (16, 0.95, "best is the middle or the lower with 16 steps left, the lower discounted by"),
        (17, 0.5, "best is the lower with 17 steps left, the upper discounted by 0.5"),
    ],
)
def test_figure_2_2_states_which_is_best_and_which_are_equal(ax, horizon, gamma, fact):
    assert repr(learning.figure_2_2(ax, horizon=horizon, gamma=gamma)).startswith(fact)


@pytest.mark.parametrize("options", [{"horizon": 0}, {"gamma": 1.0}, {"gamma": -0.1}])
def test_a_horizon_or_a_discount_that_is_none_is_refused(ax, options):
    with pytest.raises(ValueError, match=r"(horizon|gamma) must be"):
        learning.figure_2_2(ax, **options)


def test_regret_is_drawn_as_mean_and_one_sigma(ax):
    rng = np.random.default_rng(1)
    regrets = {name: rng.random((30, 50)).cumsum(axis=1) for name in ("random", "UCB")}
    plot = learning.plot_regret(regrets, ax, title="two ways to play")
    assert repr(plot) == "two ways to play"
    for name, values in regrets.items():
        x, mean = plot.lines[name].get_data()
        assert x.tolist() == list(range(1, 51))
        assert mean == pytest.approx(values.mean(axis=0))
        top = plot.bands[name].get_datalim(ax.transData).ymax
        assert top == pytest.approx((values.mean(axis=0) + values.std(axis=0)).max())
        assert to_rgb(plot.lines[name].get_color()) == to_rgb(plot.bands[name].get_facecolor()[0])
    assert plot.lines["random"].get_color() != plot.lines["UCB"].get_color()
    assert ax.get_ylim()[0] == 0


def test_one_player_is_no_claim(ax):
    with pytest.raises(ValueError, match="UCB must be played by at least 20, got 19"):
        learning.plot_regret({"UCB": np.zeros((19, 5))}, ax)
    with pytest.raises(ValueError, match="colors for at most 5 names"):
        learning.plot_regret({str(i): np.zeros((20, 5)) for i in range(6)}, ax)
    with pytest.raises(ValueError, match="UCB must"):
        learning.plot_regret({"UCB": [[np.nan]] * 20}, ax)


@pytest.mark.parametrize("number", ["2.1", "2.2"])
def test_the_gallery_draws_it_on_axes_of_its_own(number):
    plot = FIGURES[number]()
    assert plot.ax.figure.number in plt.get_fignums() and repr(plot)
    plot.ax.figure.draw_without_rendering()
    plt.close(plot.ax.figure)

"""The plots of the Kalman chapter draw what the filter computes."""

import matplotlib.pyplot as plt
import numpy as np
import pytest
from matplotlib.figure import Figure
from scipy import stats

import arkaq_edu as ae
from arkaq_edu.figures import kalman
from arkaq_edu.figures.drawing import style

NAN = float("nan")


@pytest.fixture
def ax():
    return Figure().subplots()


def walker(**options):
    given = {"Q": [[30.0**2]], "R": [[60.0**2]], "B": [[-100.0]], "x0": [1500.0]} | options
    return ae.KalmanFilter([[1.0]], [[1.0]], P0=[[40.0**2]], **given)


def test_figure_2_22_is_equations_2_49_and_2_50(ax):
    plot = kalman.figure_2_22(ax)
    into = {}
    for start, end in plot.arrows:
        into.setdefault(end, set()).add(start)

    def term(name):
        """Read the diagram backwards from a node, as an equation."""
        words, kind, _ = kalman.MODEL[name]
        if kind == "sum":
            return " + ".join(sorted(term(start) for start in into[name]))
        if kind == "matrix":
            (vector,) = into[name]
            return words.strip("$") + " " + kalman.MODEL[vector][0].strip("$")
        return words.strip("$")

    (sum_,) = into["x"]
    assert term(sum_) == "A x_{k-1} + B u_{k-1} + w"
    (sum_,) = into["z"]
    assert term(sum_) == "H x_k + v"
    assert set(plot.nodes) == set(kalman.MODEL)
    beside = {text.get_text() for text in ax.texts}
    assert {"$Q$", "$R$"} <= beside


def test_figure_2_23_goes_round_with_the_five_equations(ax):
    plot = kalman.figure_2_23(ax)
    assert {("predict", "correct"), ("correct", "predict"), ("z", "correct"), ("u", "predict")} <= (
        set(plot.arrows)
    )
    left = [line.split("=")[0] for name in kalman.CYCLE for line in kalman.CYCLE[name]]
    assert left == [r"$\hat{x}_{k|k-1} ", "$P_{k|k-1} ", "$K_k ", r"$\hat{x}_k ", "$P_k "]
    for name, equations in kalman.CYCLE.items():
        assert plot.nodes[name].get_text().split("\n") == equations


@pytest.mark.parametrize("figure", [kalman.figure_2_22, kalman.figure_2_23])
def test_a_diagram_makes_its_own_axes_and_says_what_it_is(figure):
    plot = figure()
    assert repr(plot).startswith("Kalman filter") and plot.ax.figure.number in plt.get_fignums()
    plot.ax.figure.draw_without_rendering()  # an equation that cannot be set would fail here
    plt.close(plot.ax.figure)


def test_densities_are_those_of_one_turn_and_the_filter_stays_as_it_is(ax):
    kf = walker()
    plot = kalman.plot_predict_correct(kf, 1490.0, [1.0], ax)
    assert (kf.x[0], kf.P[0, 0]) == (1500.0, 1600.0)
    gain = 2500 / (2500 + 3600)  # by hand: 40 squared and 30 squared, against 60 squared
    expected = {
        "before": (1500.0, 40.0),
        "predicted": (1400.0, 50.0),
        "seen": (1490.0, 60.0),
        "corrected": (1400 + gain * 90, np.sqrt((1 - gain) * 2500)),
    }
    for name, (mean, sigma) in expected.items():
        x, density = plot.curves[name].get_data()
        assert density == pytest.approx(stats.norm(mean, sigma).pdf(x))
    assert repr(plot) == "predicted 1400 ± 50, seen 1490 ± 60: corrected 1437 ± 38.4"


def test_a_sighting_in_other_units_is_drawn_where_the_state_would_be(ax):
    kf = ae.KalmanFilter([[1]], [[2.0]], [[0]], [[36.0]], x0=[10], P0=[[4]])
    x, density = kalman.plot_predict_correct(kf, 24.0, ax=ax).curves["seen"].get_data()
    assert density == pytest.approx(stats.norm(12, 3).pdf(x))


def test_densities_need_a_single_number(ax):
    A, H = ae.constant_velocity(1.0, 1)
    with pytest.raises(ValueError, match="kf must have one state"):
        kalman.plot_predict_correct(ae.KalmanFilter(A, H, np.eye(2), [[1]]), 1.0, ax=ax)
    with pytest.raises(ValueError, match="z must"):
        kalman.plot_predict_correct(walker(), NAN, [1.0], ax)


def test_a_track_shows_truth_sightings_estimate_and_one_sigma(ax):
    kf = ae.KalmanFilter(np.eye(2), np.eye(2), np.eye(2), np.diag([4.0, 9.0]))
    Z = np.array([[1.0, 5.0], [NAN, NAN], [3.0, 7.0]])
    trace = kf.filter(Z)
    plot = kalman.plot_track([5.0, 6.0, 7.0], Z, trace, ax, axis=1)
    assert plot.truth.get_ydata().tolist() == [5.0, 6.0, 7.0]
    assert plot.sightings.get_markerfacecolor() == "none"
    np.testing.assert_array_equal(plot.sightings.get_ydata(), Z[:, 1])
    assert plot.estimate.get_ydata() == pytest.approx(trace.x[:, 1])
    assert plot.estimate.get_color() == style.OURS
    sigma = np.sqrt(trace.P[:, 1, 1])
    heights = plot.band.get_datalim(ax.transData)
    assert heights.ymin == pytest.approx((trace.x[:, 1] - sigma).min())
    assert heights.ymax == pytest.approx((trace.x[:, 1] + sigma).max())
    assert ax.get_ylabel() == "orientation (rad)" and repr(plot) == "a track of 3 looks"


@pytest.mark.parametrize("truth, Z", [([1.0], [[1.0]] * 2), ([1.0] * 2, [[1.0]])])
def test_a_track_of_two_lengths_is_refused(ax, truth, Z):
    trace = walker().filter([[1.0]] * 2)
    with pytest.raises(ValueError, match=r"(truth|Z) must"):
        kalman.plot_track(truth, Z, trace, ax)

"""The Kalman explorer without a browser: what it draws at every end of its sliders."""

import itertools
import re

import numpy as np
import pytest
from matplotlib.colors import to_rgb
from scipy import stats

from arkaq_edu.figures.drawing import style
from arkaq_edu.kalman import walk
from arkaq_edu.widgets import kalman, kalman_explorer
from arkaq_edu.widgets.scene import Line, Points, Text

WALK = walk.simulated_walk()
FACT = re.compile(
    r"mean NIS ([\d.]+) where ([\d.]+) to ([\d.]+) is right; "
    r"estimate (\d+) mm off, sightings (\d+) mm"
)


@pytest.fixture(scope="module")
def explorer():
    return kalman_explorer()


def by_hand(r, q, missing):
    """The same filter, written out for one number; its NIS and its estimates."""
    x, P, nis, estimates, sigmas = 3400.0, 100.0**2, [], [], []
    for z, u, gone in zip(WALK.Z[:, 0], WALK.U[:, 0], missing, strict=True):
        x, P = x - 100 * u, P + q**2
        if not gone:
            S = P + r**2
            nis.append((z - x) ** 2 / S)
            x, P = x + P / S * (z - x), P * r**2 / S
        estimates.append(x)
        sigmas.append(np.sqrt(P))
    return np.array(nis), np.array(estimates), np.array(sigmas)


ENDS = list(itertools.product((10.0, 100.0, 1000.0), (2.5, 25.0, 250.0), (0.0, 0.3, 0.9)))


@pytest.mark.parametrize("r, q, dropout", ENDS)
def test_the_explorer_shows_what_the_filter_makes_of_the_walk(explorer, r, q, dropout):
    for name, value in (("r", r), ("q", q), ("dropout", dropout)):
        explorer.controls[name].value = value
    assert explorer.error is None
    missing = WALK.draws < dropout
    nis, x, sigma = by_hand(r, q, missing)
    mean, low, high, ours, theirs = map(float, FACT.fullmatch(repr(explorer)).groups())
    assert mean == pytest.approx(nis.mean(), abs=0.006)
    ends = stats.chi2.ppf([0.025, 0.975], len(nis)) / len(nis)
    assert [low, high] == pytest.approx(ends, abs=0.006)
    assert ours == pytest.approx(np.sqrt(np.mean((x - WALK.truth) ** 2)), abs=0.6)
    gaps = (WALK.Z[:, 0] - WALK.truth)[~missing]
    assert theirs == pytest.approx(np.sqrt(np.mean(gaps**2)), abs=0.6)

    track, beside = explorer.drawn.panels
    band, truth, estimate, marks, told = track.layers[:5]
    assert np.asarray(truth.y) == pytest.approx(WALK.truth)
    assert np.asarray(estimate.y) == pytest.approx(x)
    edge = np.concatenate([x + sigma, (x - sigma)[::-1]])
    assert band.polygons[0][:, 1] == pytest.approx(edge)
    assert np.column_stack([marks.x, marks.y]) == pytest.approx(
        np.column_stack([np.flatnonzero(~missing), WALK.Z[~missing, 0]])
    )
    assert marks.hollow and told.text.endswith(f"{missing.sum()} of 60 missing")
    funnel, _, running = beside.layers[:3]
    assert len(running.y) == len(nis) == len(funnel.polygons[0]) / 2
    assert running.y[-1] == pytest.approx(np.clip(nis.mean(), 0.05, 500))
    assert all(np.asarray(layer.y).min() > 0 for layer in beside.layers if isinstance(layer, Line))


def test_the_noise_is_the_same_at_every_position(explorer):
    seen = {}
    for dropout in (0.0, 0.2, 0.5, 0.9):
        explorer.controls["dropout"].value = dropout
        marks = next(m for m in explorer.drawn.panels[0].layers if isinstance(m, Points))
        seen[dropout] = set(zip(np.asarray(marks.x), np.asarray(marks.y), strict=True))
    assert seen[0.0] > seen[0.2] > seen[0.5] > seen[0.9] and len(seen[0.0]) == 60
    assert len(seen[0.9]) >= 3
    assert repr(kalman_explorer()) == repr(kalman_explorer())


def test_it_starts_at_the_thesiss_r_and_the_truth_is_a_stop_that_passes():
    explorer = kalman_explorer()
    start = {name: control.value for name, control in explorer.controls.items()}
    assert start == {"r": 10.0, "q": 25.0, "dropout": 0.0}
    explorer.controls["r"].value = walk.SIGHTING_NOISE
    mean, low, high = map(float, FACT.match(repr(explorer)).groups()[:3])
    assert low < mean < high
    for name, truth in (("r", walk.SIGHTING_NOISE), ("q", walk.STEP_NOISE)):
        slider = explorer.controls[name]
        stops = 10 ** (slider.min + slider.step * np.arange(41))
        assert stops[-1] == pytest.approx(10**slider.max)
        for stop in (truth, start[name]):  # a browser moves a slider that starts between two
            assert np.abs(stops / stop - 1).min() < 1e-9


@pytest.mark.parametrize("r, q, side", [(10, 25, 1), (100, 2.5, 1), (1000, 25, -1), (100, 250, -1)])
def test_noise_believed_too_small_lifts_the_nis_and_too_large_lowers_it(r, q, side):
    right, wrong = (FACT.match(kalman.draw(WALK, *told, 0.0).fact) for told in ((100, 25), (r, q)))
    mean, low, high, error, _ = map(float, wrong.groups())
    assert mean > high if side > 0 else mean < low
    assert error > float(right[4]), "and the estimate is the worse for it"


def test_a_slider_that_adds_up_steps_misses_no_other_sightings():
    one = kalman.draw(WALK, 100.0, 25.0, 0.1 + 0.2)
    assert one.fact == kalman.draw(WALK, 100.0, 25.0, 0.3).fact


def test_a_band_is_sent_and_painted_in_its_own_shade(explorer):
    track, beside = explorer.drawn.panels
    sigma = track.layers[0]
    look = sigma.look()
    assert sigma.kind == "cells" and look["border"] == 0 and len(look["palette"]) == 1
    shade = [0.75 + 0.25 * channel for channel in to_rgb(style.OURS)]
    assert to_rgb(look["palette"][0]) == pytest.approx(shade, abs=0.01)
    assert beside.layers[0].look()["palette"] != look["palette"]
    from matplotlib.figure import Figure

    ax = Figure().subplots()
    sigma.paint(ax)
    (area,) = ax.collections
    assert area.get_facecolor()[0, :3] == pytest.approx(to_rgb(look["palette"][0]))
    assert area.get_paths()[0].vertices[:-1] == pytest.approx(sigma.polygons[0])
    assert area.get_linewidth() == 0


def test_all_the_words_stay_inside_their_panels(explorer):
    for panel in explorer.drawn.panels:
        for word in (layer for layer in panel.layers if isinstance(layer, Text)):
            assert panel.xlim[0] <= word.x <= panel.xlim[1]
            assert panel.ylim[0] <= word.y <= panel.ylim[1]

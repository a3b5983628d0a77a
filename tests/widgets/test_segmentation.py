"""The vigilance explorer without a browser: what it draws and says for each setting."""

import re

import numpy as np
import pandas as pd
import pytest

import arkaq_edu as ae
from arkaq_edu.experiments import segmentation
from arkaq_edu.widgets import segmentation as widgets
from arkaq_edu.widgets import vigilance_explorer
from arkaq_edu.widgets.scene import Line
from tests.stand_in import triangle_stream

PATTERNS = triangle_stream(2000)


@pytest.fixture(scope="module")
def explored():
    return vigilance_explorer(PATTERNS, learning_rate=0.5)


def stated(explored):
    """The count, the coverage (%) and the error that an explorer states."""
    fact = r"([\d,]+) categor(?:y|ies) at vigilance .*; coverage ([\d.]+) %, error ([\d.]+)"
    return [float(x.replace(",", "")) for x in re.fullmatch(fact, repr(explored)).groups()]


def leaders(patterns, vigilance, eta):
    """Centers by a search through all of them, pattern by pattern."""
    centers = patterns[:1].copy()
    for x in patterns[1:]:
        gaps = np.linalg.norm(centers - x, axis=1)
        j = gaps.argmin()
        if gaps[j] < vigilance:
            centers[j] += eta * (x - centers[j])
        else:
            centers = np.vstack([centers, x])
    return centers


def spread(labels):
    """How far the patterns are from the mean of their label, by pandas."""
    table = pd.DataFrame(PATTERNS)
    return np.sqrt(((table - table.groupby(labels).transform("mean")) ** 2).sum(axis=1).mean())


def set_all(explored, **values):
    for name, value in values.items():
        explored.controls[name].value = value
        assert explored.error is None


ALL = {"method": "Euclidean", "order": "as recorded", "eta": 0.5, "n": 2000}
SETTINGS = [
    {"vigilance": at} for at in (0.025, 0.05, 0.075, 0.1, 0.11, 0.15, 0.2)
] + [
    {"vigilance": 0.15, "eta": 0.05},
    {"vigilance": 0.15, "eta": 1.0},
    {"vigilance": 0.1, "n": 153},
    {"vigilance": 0.1, "n": 1530, "order": "shuffled"},
    {"vigilance": 0.15, "order": "sorted by distance"},
]  # fmt: skip


@pytest.mark.parametrize("setting", SETTINGS, ids=str)
def test_the_explorer_shows_the_centers_of_the_setting(explored, setting):
    setting = ALL | setting
    set_all(explored, **setting)
    learned = PATTERNS[: setting["n"]]
    if setting["order"] == "shuffled":
        learned = segmentation.in_order(learned, "shuffled")
    elif setting["order"] == "sorted by distance":
        learned = np.array(sorted(learned.tolist(), key=lambda pattern: pattern[0]))
    centers = leaders(learned, setting["vigilance"], setting["eta"])
    gaps = np.linalg.norm(PATTERNS[:, None] - centers, axis=2)
    covered = 100 * (gaps.min(axis=1) < setting["vigilance"]).mean()
    wanted = [len(centers), covered, spread(gaps.argmin(axis=1))]
    assert stated(explored) == pytest.approx(wanted, abs=0.051)
    assert stated(explored)[2] == pytest.approx(wanted[2], abs=0.00051)
    map_, curve = explored.drawn.panels
    cells, dots = map_.layers
    assert len(cells.polygons) == len(cells.colors) == len(dots.x) == len(centers)
    assert np.column_stack([dots.x, dots.y]) == pytest.approx(segmentation.in_view(centers))
    ours = next(x for x in curve.layers if isinstance(x, Line) and not x.dashed)
    if {**setting, "vigilance": 0} == {**ALL, "vigilance": 0}:
        assert dict(zip(ours.x, ours.y, strict=True))[setting["vigilance"]] == len(centers)


@pytest.mark.parametrize("cosine", [0.5, 0.95, 0.99])
def test_the_angular_method_has_a_vigilance_of_its_own(explored, cosine):
    distance, own = explored.controls["vigilance"], explored.controls["cosine"]
    set_all(explored, **ALL)
    assert (distance.layout.display, own.layout.display) == (None, "none")
    set_all(explored, method="angular", cosine=cosine)
    assert (distance.layout.display, own.layout.display) == ("none", None)
    templates = ae.ART2A(cosine, 0.5).fit(PATTERNS).cluster_centers_
    cosines = PATTERNS @ templates.T / np.linalg.norm(PATTERNS, axis=1, keepdims=True)
    covered = 100 * (cosines.max(axis=1) > cosine).mean()
    wanted = [len(templates), covered, spread(cosines.argmax(axis=1))]
    assert stated(explored) == pytest.approx(wanted, abs=0.051)
    assert stated(explored)[2] == pytest.approx(wanted[2], abs=0.00051)
    assert f"at vigilance {cosine}, a cosine: {np.degrees(np.arccos(cosine)):.1f}°" in repr(
        explored
    )
    curve = explored.drawn.panels[1]
    ours = next(x for x in curve.layers if isinstance(x, Line) and not x.dashed)
    assert dict(zip(ours.x, ours.y, strict=True))[cosine] == len(templates)
    assert max(ours.y) < curve.ylim[1]
    set_all(explored, **ALL)


def test_the_slider_starts_at_the_thesiss_first_figure_and_stops_at_all_five():
    slider = vigilance_explorer(PATTERNS[:50]).controls["vigilance"]
    assert (slider.min, slider.value, slider.max) == (0.025, 0.15, 0.2)
    stops = slider.min + slider.step * np.arange(100)
    for printed in segmentation.THESIS_COUNTS:
        assert np.abs(stops - printed).min() < 1e-12
        assert printed in widgets.VIGILANCES
    # As a browser adds steps up: 0.15000000000000002 is the thesis's 0.15.
    drawn = widgets.draw(PATTERNS, {}, vigilance=0.025 + 25 * 0.005 + 2e-17)
    assert "at vigilance 0.15, the thesis printed 137;" in drawn.fact


def test_every_control_is_in_the_widget_once_and_the_canvas_under_them(explored):
    *rows, view, message = explored.children
    assert [x for row in rows for x in row.children] == [
        explored.controls[name] for name in ("method", "vigilance", "cosine", "order", "eta", "n")
    ]
    assert view is explored.view and message.value == ""


def test_the_update_factor_is_the_readers():
    for eta in (0.1, 0.5, 1.0):
        explored = vigilance_explorer(PATTERNS[:500], eta)
        assert explored.controls["eta"].value == eta
        assert stated(explored)[0] == len(leaders(PATTERNS[:500], 0.15, eta))
    for bad in (7, 0, "count"):
        with pytest.raises(ValueError, match="learning_rate"):
            vigilance_explorer(PATTERNS, bad)


@pytest.mark.parametrize("bad", [[[1, 2, 3]], [[0, np.nan]], "a stream"])
def test_bad_patterns_are_refused(bad):
    with pytest.raises(ValueError, match="patterns must"):
        vigilance_explorer(bad)


def test_without_patterns_it_takes_the_recorded_stream(monkeypatch):
    monkeypatch.setattr(segmentation, "recorded_patterns", lambda: PATTERNS[:100])
    assert repr(vigilance_explorer()) == repr(vigilance_explorer(PATTERNS[:100]))

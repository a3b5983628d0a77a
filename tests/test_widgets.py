"""Explorers without a browser: what is drawn for each slider, what is sent, what is stored."""

import base64
import io
import json
from pathlib import Path

import ipywidgets
import numpy as np
import pytest
from IPython.core.formatters import DisplayFormatter
from matplotlib.figure import Figure
from PIL import Image
from stand_in import triangle_stream

import arkaq_edu as ae
from arkaq_edu.figures import segmentation
from arkaq_edu.widgets import Explorer, vigilance, vigilance_explorer
from arkaq_edu.widgets.scene import Cells, Line, Panel, Points, Scene, Text

PATTERNS = triangle_stream(2000)


def dot_at(x):
    if x == 13:
        raise RuntimeError("no luck <here>")
    return Scene(f"a dot at {x}", [Panel("x", "y", (0, 20), (0, 1), [Points([x], [0.5])])])


@pytest.fixture
def explorer():
    return Explorer(dot_at, x=ipywidgets.IntSlider(3, max=20))


@pytest.fixture(scope="module")
def explored():
    return vigilance_explorer(PATTERNS, learning_rate=0.5)


@pytest.mark.parametrize("at", [0.025, 0.05, 0.075, 0.1, 0.11, 0.15, 0.2])
def test_the_vigilance_explorer_counts_what_the_network_founds(explored, at):
    slider = explored.controls["vigilance"]
    slider.value = at
    assert explored.error is None
    centers = ae.EuclideanART(at, 0.5).fit(PATTERNS).cluster_centers_
    assert repr(explored) == segmentation.count_fact(len(centers), at)
    map_, curve = explored.drawn.panels
    cells, dots = map_.layers
    assert len(cells.polygons) == len(cells.colors) == len(dots.x) == len(centers)
    assert np.column_stack([dots.x, dots.y]) == pytest.approx(segmentation.in_view(centers))
    ours = next(layer for layer in curve.layers if isinstance(layer, Line) and not layer.dashed)
    assert dict(zip(ours.x, ours.y, strict=True))[at] == len(centers)


def test_the_slider_starts_at_the_thesiss_first_figure_and_stops_at_all_five():
    slider = vigilance_explorer(PATTERNS[:50]).controls["vigilance"]
    assert (slider.min, slider.value, slider.max) == (0.025, 0.15, 0.2)
    stops = slider.min + slider.step * np.arange(100)
    for printed in segmentation.THESIS_COUNTS:
        assert np.abs(stops - printed).min() < 1e-12
        assert printed in vigilance.VIGILANCES
    # As a browser adds steps up: 0.15000000000000002 is the thesis's 0.15.
    drawn = vigilance.draw(PATTERNS, 0.5, {}, 0.025 + 25 * 0.005 + 2e-17)
    assert drawn.fact.endswith("at vigilance 0.15, the thesis printed 137")


def test_the_update_factor_is_the_readers():
    repr_of = {eta: repr(vigilance_explorer(PATTERNS, eta)) for eta in (0.1, 1.0, "count")}
    for eta, fact in repr_of.items():
        n = ae.EuclideanART(0.15, eta).fit(PATTERNS).n_clusters_
        assert fact.startswith(f"{n} categories")
    with pytest.raises(ValueError, match="learning_rate"):
        vigilance_explorer(PATTERNS, 7)


@pytest.mark.parametrize("bad", [[[1, 2, 3]], [[0, np.nan]], "a stream"])
def test_bad_patterns_are_refused_at_the_door(bad):
    with pytest.raises(ValueError, match="patterns must"):
        vigilance_explorer(bad)


def test_without_patterns_it_takes_the_recorded_stream(monkeypatch):
    monkeypatch.setattr(segmentation, "recorded_patterns", lambda: PATTERNS[:100])
    assert repr(vigilance_explorer()) == repr(vigilance_explorer(PATTERNS[:100]))


def test_the_canvas_is_sent_every_number(explored):
    scene = explored.drawn
    explored.view.show(scene)
    layout = json.loads(json.dumps(explored.view.scene))
    numbers = np.frombuffer(explored.view.numbers, np.float32)
    assert layout["fact"] == scene.fact
    end = 0
    for panel, drawn in zip(layout["panels"], scene.panels, strict=True):
        for layer, source in zip(panel["layers"], drawn.layers, strict=True):
            assert layer["start"] == end
            end += layer["length"]
            mine = numbers[layer["start"] : end]
            if isinstance(source, Cells):
                n = int(mine[0])
                sizes, colors = mine[1 : 1 + n].astype(int), mine[1 + n : 1 + 2 * n]
                corners = np.split(mine[1 + 2 * n :].reshape(-1, 2), np.cumsum(sizes)[:-1])
                assert colors.tolist() == list(source.colors)
                for corner, polygon in zip(corners, source.polygons, strict=True):
                    assert corner == pytest.approx(polygon, rel=1e-6)
            else:
                xy = np.column_stack([source.x, source.y])
                assert mine.reshape(-1, 2) == pytest.approx(xy, rel=1e-6)
    assert end == len(numbers)


def test_every_layer_has_a_painter_in_the_browser():
    script = Path(vigilance.__file__).with_name("canvas.js").read_text()
    for layer in (Cells, Points, Line, Text):
        assert f"\n  {layer.kind}(ctx, at, layer, numbers) {{" in script
    assert "http" not in script and "import " not in script, "it has to work offline"


def test_a_picture_travels_in_one_message(explorer, monkeypatch):
    sent = []
    monkeypatch.setattr(
        explorer.view, "send_state", lambda keys=None: sent.append(set(keys)), raising=False
    )
    explorer.view.show(dot_at(5))
    assert sent == [{"scene", "numbers"}]


def test_moving_a_control_draws_anew(explorer):
    explorer.controls["x"].value = 20
    assert explorer.view.scene["fact"] == repr(explorer) == "a dot at 20"
    assert np.frombuffer(explorer.view.numbers, np.float32).tolist() == [20.0, 0.5]


def test_an_error_is_shown_and_goes_when_all_is_well_again(explorer):
    message = explorer.children[-1]
    explorer.controls["x"].value = 13
    assert isinstance(explorer.error, RuntimeError)
    assert 'role="alert"' in message.value and "RuntimeError: no luck &lt;here&gt;" in message.value
    explorer.controls["x"].value = 14
    assert explorer.error is None and message.value == ""
    with pytest.raises(RuntimeError, match="no luck"):
        Explorer(dot_at, x=ipywidgets.IntSlider(13, max=20))


def test_a_stored_notebook_shows_the_picture_and_the_fact(explored):
    slider = explored.controls["vigilance"]
    pictures = []
    for at in (0.15, 0.05):
        slider.value = at
        data, metadata = DisplayFormatter().format(explored)
        assert data["text/plain"] == repr(explored)
        assert "application/vnd.jupyter.widget-view+json" in data
        png = data["image/png"]
        picture = Image.open(io.BytesIO(base64.b64decode(png) if isinstance(png, str) else png))
        assert picture.width == 2 * metadata["image/png"]["width"]
        pictures.append(np.asarray(picture.convert("RGB")))
    assert (pictures[0] != pictures[1]).any(axis=2).mean() > 0.1
    assert explored.drawn.png() == explored.drawn.png()


def test_matplotlib_and_the_canvas_agree_on_the_axes():
    layers = [Points([0.3], [2000.0], hollow=True), Text(0.1, 10, "far")]
    panel = Panel("rad", "mm", (0.5, -0.5), (10, 4000), layers, log=False, yticks=[10, 4000])
    layout, _ = Scene("a view", [panel]).pack()
    sent = layout["panels"][0]
    assert sent["yticks"] == [[10.0, "10"], [4000.0, "4,000"]]
    figure = Figure()
    ax = figure.subplots()
    panel.paint(ax)
    figure.canvas.draw()
    for ticks, axis in ((sent["xticks"], ax.xaxis), (sent["yticks"], ax.yaxis)):
        assert [label.get_text() for label in axis.get_ticklabels()] == [t[1] for t in ticks]
        assert axis.get_ticklocs() == pytest.approx([t[0] for t in ticks])
    assert (ax.get_xlim(), ax.get_ylim()) == ((0.5, -0.5), (10, 4000))
    assert ax.lines[0].get_markerfacecolor() == "none"

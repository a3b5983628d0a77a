"""Explorers without a browser: what is drawn for each slider, what is sent, what is stored."""

import base64
import io
import json
import re
from pathlib import Path

import ipywidgets
import numpy as np
import pandas as pd
import pytest
from IPython.core.formatters import DisplayFormatter
from matplotlib.figure import Figure
from PIL import Image

import arkaq_edu as ae
from arkaq_edu.experiments import segmentation
from arkaq_edu.widgets import Buttons, CanvasView, Drag, Explorer, vigilance_explorer
from arkaq_edu.widgets import segmentation as widgets
from arkaq_edu.widgets.scene import Cells, Line, Panel, Picture, Points, Scene, Text
from tests.stand_in import triangle_stream

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


def stated(explored):
    """The count, the coverage (%) and the error that an explorer states."""
    fact = r"(\d+) categor(?:y|ies) at vigilance .*; coverage ([\d.]+) %, error ([\d.]+)"
    return [float(x) for x in re.fullmatch(fact, repr(explored)).groups()]


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
    script = Path(widgets.__file__).with_name("canvas.js").read_text()
    for layer in (Cells, Points, Line, Text, Picture):
        assert f"\n  {layer.kind}(ctx, at, layer, numbers) {{" in script
    assert "http" not in script and "import " not in script, "it has to work offline"


def test_a_picture_keeps_every_pixel_on_both_its_ways():
    pixels = np.random.default_rng(0).integers(0, 256, (3, 5, 3), dtype=np.uint8)
    pixels[0, 0] = (1, 0, 128)  # 1, 0, 128, 255 is a NaN to a float, and has to stay this one
    layers = [Points([1.0], [1.0]), Picture(pixels, (2.0, 7.0, 1.0, 4.0), smooth=False)]
    panel = Panel("", "", (0, 10), (0, 5), layers, bare=True)
    view = CanvasView()
    view.show(Scene("pixels", [panel]))
    sent = view.scene["panels"][0]["layers"][1]
    assert (sent["columns"], sent["smooth"]) == (5, False)
    assert list(sent["within"]) == [2.0, 7.0, 1.0, 4.0]
    found = np.frombuffer(view.numbers, np.uint8)[4 * sent["start"] :].reshape(3, 5, 4)
    assert len(found.tobytes()) == 4 * sent["length"]
    assert (found[..., :3] == pixels).all() and (found[..., 3] == 255).all()
    ax = Figure().subplots()
    panel.paint(ax)
    (image,) = ax.images
    assert (image.get_array() == pixels).all() and image.get_extent() == [2.0, 7.0, 1.0, 4.0]
    assert (ax.get_xlim(), ax.get_ylim()) == ((0, 10), (0, 5)) and ax.get_aspect() == 1.0


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
    panel = Panel("rad", "mm", (0.5, -0.5), (10, 4000), layers, log="y", yticks=[10, 4000])
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
    assert (ax.get_xscale(), ax.get_yscale(), sent["log"]) == ("linear", "log", "y")
    assert ax.lines[0].get_markerfacecolor() == "none"


def test_an_explorer_goes_step_by_step_with_buttons():
    def draw(steps):
        if steps.count("left") > 2:
            raise ValueError("the wall")
        return Scene(" ".join(steps) or "at the start", [])

    explorer = Explorer(draw, steps=Buttons(["left", "right"]))
    left, right, again = explorer.controls["steps"].children
    assert repr(explorer) == "at the start"
    for button in (left, right, left):
        button.click()
    assert repr(explorer) == "left right left"
    left.click()
    assert str(explorer.error) == "the wall"
    again.click()
    assert explorer.error is None and repr(explorer) == "at the start"
    with pytest.raises(ValueError, match="'up'"):
        explorer.controls["steps"].press("up")


def pulled(number, start, to, panel=0, phase="move"):
    return {"number": number, "panel": panel, "from": start, "to": to, "phase": phase}


def slider(value=0.5, step=0.1, low=0, high=1):
    return ipywidgets.FloatSlider(value, min=low, max=high, step=step)


def test_a_drag_moves_its_slider_to_the_stop_next_to_the_pointer():
    explorer = Explorer(dot_at, x=Drag(ipywidgets.IntSlider(3, max=20)))
    assert explorer.view.draggable == [0] and repr(explorer) == "a dot at 3"
    for to, shown in [((7.4, 0.1), 7), ((7.6, 9.0), 8), ((-3.0, 0.5), 0), ((99.0, 0.5), 20)]:
        explorer.view.drag = pulled(1, (3.0, 0.5), to)
        assert repr(explorer) == f"a dot at {shown}"
        assert explorer.controls["x"].value == explorer.controls["x"].children[0].value == shown
    explorer.controls["x"].children[0].value = 5
    assert repr(explorer) == "a dot at 5", "the slider alone does it too"
    explorer.controls["x"].value = 6
    assert explorer.controls["x"].children[0].value == 6
    explorer.view.drag = pulled(2, (6.0, 0.5), (13.0, 0.5))
    assert isinstance(explorer.error, RuntimeError), "an error shows, as with any control"


def test_arrow_keys_step_and_none_is_lost_when_the_kernel_was_busy():
    one = Drag(slider())
    view = CanvasView()
    one.follow(view)
    for pressed, value in [((1, 0), 0.6), ((1, 1), 0.7), ((-2, 1), 0.4), ((30, 1), 1.0)]:
        view.arrows = pressed
        assert one.value == pytest.approx(value)


def test_a_drag_by_gain_goes_from_where_the_sliders_were_and_tells_of_both_at_once():
    both = Drag(slider(0, 1, -90, 90), slider(30, 1, 0, 60), panel=1, gain=(-20, 10))
    view, told = CanvasView(), []
    both.follow(view)
    both.observe(lambda change: told.append(change["new"]), names="value")
    view.drag = pulled(1, (0.5, 0.5), (1.5, 1.0), panel=1, phase="begin")
    view.drag = pulled(1, (0.5, 0.5), (2.5, 1.5), panel=1)
    assert told == [(-20, 35), (-40, 40)], "not added up: it is counted from where it began"
    view.drag = pulled(2, (0.0, 0.0), (0.0, 9.0), panel=1)
    assert both.value == (-40, 60), "no further than the slider goes"
    view.drag = pulled(3, (0.0, 0.0), (1.0, 1.0), panel=0)
    assert both.value == (-40, 60), "that was another panel's"
    view.arrows = (1, -2)
    assert both.value == (-40, 60), "and so are the keys, then"
    view.drag = pulled(4, (0.0, 0.0), (0.0, 0.0), panel=1)
    view.arrows = (2, -4)
    assert both.value == (-41, 58), "a key goes the way that a drag goes"
    told.clear()
    both.value = (7, 8)
    assert [slider.value for slider in both.children] == [7, 8] and set(told) == {(7, 8)}


def test_two_drags_share_a_canvas():
    view = CanvasView()
    one, other = Drag(slider()), Drag(y=slider(), panel=1)
    one.follow(view)
    other.follow(view)
    assert view.draggable == [0, 1]
    view.arrows = (1, 0)
    assert (one.value, other.value) == pytest.approx((0.6, 0.5)), "keys are the first one's"
    view.drag = pulled(1, (0.0, 0.0), (0.9, 0.2), panel=1)
    assert (one.value, other.value) == pytest.approx((0.6, 0.2))


def test_the_script_tells_all_that_a_drag_reads():
    script = Path(widgets.__file__).with_name("canvas.js").read_text()
    for name in ("drag", "arrows", "draggable"):
        assert f'"{name}"' in script and CanvasView.class_traits()[name].metadata["sync"]


def test_a_bare_panel_has_no_axes_and_one_scale():
    panel = Panel("", "", (0, 4), (0, 1), [], bare=True)
    assert Scene("a view", [panel]).pack()[0]["panels"][0]["bare"] is True
    ax = Figure().subplots()
    panel.paint(ax)
    assert not ax.axison and ax.get_aspect() == 1

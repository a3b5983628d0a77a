"""Scenes: what is sent to the browser, and what matplotlib draws of the same layers."""

import json
from pathlib import Path

import numpy as np
import pytest
from matplotlib.figure import Figure

from arkaq_edu.widgets import CanvasView
from arkaq_edu.widgets import scene as module
from arkaq_edu.widgets.scene import Cells, Line, Panel, Picture, Points, Scene, Text


def test_the_canvas_is_sent_every_number():
    rng = np.random.default_rng(0)
    polygons = [rng.uniform(size=(corners, 2)) for corners in (3, 5, 4)]
    cells = Cells(polygons, [2, 0, 1], (0.0, 1.0, 0.0, 1.0))
    dots, line = Points(*rng.uniform(size=(2, 7))), Line(*rng.uniform(size=(2, 9)))
    ends = (0.0, 1.0), (0.0, 1.0)
    panels = [
        Panel("x", "y", *ends, [cells, dots]),
        Panel("x", "y", *ends, [line, Text(1, 2, "a")]),
    ]
    scene, view = Scene("a map beside a curve", panels), CanvasView()
    view.show(scene)
    layout = json.loads(json.dumps(view.scene))
    numbers = np.frombuffer(view.numbers, np.float32)
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
    script = Path(module.__file__).with_name("canvas.js").read_text()
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


def test_a_bare_panel_has_no_axes_and_one_scale():
    panel = Panel("", "", (0, 4), (0, 1), [], bare=True)
    assert Scene("a view", [panel]).pack()[0]["panels"][0]["bare"] is True
    ax = Figure().subplots()
    panel.paint(ax)
    assert not ax.axison and ax.get_aspect() == 1

"""The explorers of adaptive resonance: what is drawn for each slider, and what is stored."""

import base64
import io
import itertools

import numpy as np
import pytest
from IPython.core.formatters import DisplayFormatter
from matplotlib.path import Path as Polygon
from PIL import Image

from arkaq_edu.art import ART1, LETTERS, learned_norm, match_norm, reset_fact
from arkaq_edu.art.reset import COSINES
from arkaq_edu.figures.drawing import style
from arkaq_edu.widgets import art as widgets
from arkaq_edu.widgets import letters_explorer, resonance_explorer
from arkaq_edu.widgets.scene import Line, Points, Text


@pytest.fixture(scope="module")
def surface():
    return resonance_explorer()


@pytest.fixture(scope="module")
def letters():
    return letters_explorer()


ENDS = list(itertools.product((0.05, 0.1, 0.5), (0.5, 0.9, 0.95), (0.75, 0.95, 0.99)))


@pytest.mark.parametrize(("c", "d", "vigilance"), ENDS)
def test_the_surface_follows_its_sliders(surface, c, d, vigilance):
    for name, value in {"c": c, "d": d, "vigilance": vigilance}.items():
        surface.controls[name].value = value
    assert surface.error is None
    assert repr(surface) == reset_fact(c, d, vigilance)
    above, curves = surface.drawn.panels

    # Each band holds the points whose norm of r lies between its levels.
    levels = [0, *widgets.LEVELS, 1.1]
    points = np.random.default_rng(0).uniform([0.01, 0.01], [1.49, 0.99], (200, 2))
    norm_r = match_norm(points[:, 1], points[:, 0], c)
    for polygon, low, high in zip(above.layers[0].polygons, levels[:-1], levels[1:], strict=True):
        inside = Polygon(polygon).contains_points(points)
        assert (norm_r[inside] > low - 2e-3).all() and (norm_r[inside] < high + 2e-3).all()

    lines = [
        layer for layer in curves.layers if isinstance(layer, Line) and layer.color == style.INK
    ]
    assert len(lines) == 2 * len(COSINES)
    for line, cosine in zip(lines, np.repeat(COSINES, 2), strict=True):
        assert line.y == pytest.approx(match_norm(cosine, line.x, c))
        learned = min(learned_norm(c, d), 1.5)
        assert line.x[0 if line.dashed else -1] == pytest.approx(learned)
    thick = next(line for line in above.layers if isinstance(line, Line) and line.width > 2)
    for x, cosine in zip(thick.x, thick.y, strict=True):
        if cosine > 0:
            assert match_norm(cosine, x, c) == pytest.approx(vigilance)


def test_the_dot_is_where_a_learned_node_starts_to_be_reset(surface):
    for name, value in {"c": 0.1, "d": 0.9, "vigilance": 0.9}.items():
        surface.controls[name].value = value
    (dot,) = [layer for layer in surface.drawn.panels[0].layers if isinstance(layer, Points)]
    assert dot.x == pytest.approx([0.9])
    assert match_norm(dot.y[0], 0.9, 0.1) == pytest.approx(0.9)
    surface.controls["c"].value = 0.3
    assert not any(isinstance(layer, Points) for layer in surface.drawn.panels[0].layers)
    assert "must not exceed 1" in repr(surface)


def test_the_sliders_start_where_the_paper_is(surface):
    fresh = resonance_explorer()
    assert {name: box.value for name, box in fresh.controls.items()} == {
        "c": 0.1, "d": 0.9, "vigilance": 0.95,
    }  # fmt: skip
    # As a browser adds steps up: 0.15000000000000002 is 0.15.
    assert widgets.draw_surface(0.15000000000000002, 0.8, 0.9).fact == reset_fact(0.15, 0.8, 0.9)


@pytest.mark.parametrize("vigilance", [0.0, 0.45, 0.5, 0.8, 1.0])
def test_the_letters_are_those_of_a_stable_network(letters, vigilance):
    letters.controls["vigilance"].value = vigilance
    assert letters.error is None
    patterns = np.array(list(LETTERS.values()))
    network = ART1(vigilance).fit(patterns)
    for _ in range(20):
        network.partial_fit(patterns)
    n = network.n_clusters_
    assert repr(letters) == f"{n} categories of 8 letters at vigilance {vigilance:g}"

    grids, *names = letters.drawn.panels[0].layers
    assert np.reshape(grids.colors, (n, 25)) == pytest.approx(network.cluster_centers_)
    assert all(isinstance(name, Text) for name in names)
    members = [name.text.replace("none now", "").split() for name in names]
    for letter, j in zip(LETTERS, network.labels_, strict=True):
        assert letter in members[j]
    assert sum(map(len, members)) == 8
    # The first square of a grid is its upper left one.
    corners = np.array([polygon.min(axis=0) for polygon in grids.polygons[:25]])
    assert corners[0, 0] == corners[:, 0].min() and corners[0, 1] == corners[:, 1].max()

    line, dot = letters.drawn.panels[1].layers
    assert dict(zip(line.x, line.y, strict=True))[vigilance] == n == dot.y[0]


def test_all_eight_letters_have_room(letters):
    letters.controls["vigilance"].value = 1.0
    panel = letters.drawn.panels[0]
    corners = np.concatenate(panel.layers[0].polygons)
    assert corners.min() >= 0 and (corners.max(axis=0) <= [panel.xlim[1], panel.ylim[1]]).all()
    tops = {tuple(polygon.min(axis=0)) for polygon in panel.layers[0].polygons}
    assert len(tops) == 200


@pytest.mark.parametrize(
    ("make", "name"), [(resonance_explorer, "c"), (letters_explorer, "vigilance")]
)
def test_a_stored_notebook_shows_the_picture_and_the_fact(make, name):
    explorer = make()
    pictures = []
    for value in (0.1, 0.3):
        explorer.controls[name].value = value
        data, _ = DisplayFormatter().format(explorer)
        assert data["text/plain"] == repr(explorer)
        png = data["image/png"]
        picture = Image.open(io.BytesIO(base64.b64decode(png) if isinstance(png, str) else png))
        pictures.append(np.asarray(picture.convert("RGB")))
    assert (pictures[0] != pictures[1]).any(axis=2).mean() > 0.01


def test_the_canvas_gets_the_colors_of_the_squares(letters):
    layer = letters.view.scene["panels"][0]["layers"][0]
    assert layer["kind"] == "cells" and layer["palette"][1] == style.INK

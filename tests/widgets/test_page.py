"""The page of an explorer: what its link says, own patterns, the centers to download."""

import numpy as np
import pytest

from arkaq_edu.experiments.patterns import read_patterns
from arkaq_edu.widgets import EXPLORERS, vigilance_explorer
from arkaq_edu.widgets.page import Page, set_to, setting, visit

FLOWERS = "\n".join(
    ["length,width", *(f"{i % 7 + i % 3 / 10},{i % 5 + i % 4 / 5}" for i in range(300))]
)


def press(explorer):
    """Move the controls of an explorer away from where they were."""
    for control in explorer.controls.values():
        if hasattr(control, "press"):
            names = getattr(control, "names", None) or control.problems["corridor"].actions
            control.press(names[0])
        elif hasattr(control, "options"):
            control.index = 1
        elif hasattr(control, "min"):
            control.value = control.min


@pytest.mark.parametrize("name", [name for name in EXPLORERS if name != "vigilance"])
def test_a_link_brings_back_the_same_picture(name):
    page = Page(f"explorer={name}")
    before = page.desk.query
    press(page.explorer)
    assert page.desk.query != before
    again = Page(page.desk.query)
    assert again.explorer.drawn.pack() == page.explorer.drawn.pack()
    assert again.desk.query == page.desk.query and again.children[1].value == ""


def test_own_patterns_are_shown_in_their_units_and_downloaded():
    page = Page("", read_patterns(FLOWERS))
    where, counts = page.explorer.drawn.panels
    assert (where.xlabel, where.ylabel) == ("length", "width")
    assert where.xlim == (0, 6.2) and where.ylim == (0, 4.6)
    assert "thesis" not in page.explorer.drawn.fact
    assert not any(getattr(layer, "text", "") == "the thesis" for layer in counts.layers)
    page.explorer.controls["vigilance"].value = 0.2
    head, *rows = page.centers().splitlines()
    centers = np.array([row.split(",") for row in rows], dtype=float)
    assert head == "length,width"
    assert f"{len(centers)} categories at vigilance 0.2; " in page.explorer.drawn.fact
    dots = where.layers[1]
    page.explorer.controls["vigilance"].value = 0.15
    np.testing.assert_allclose(
        np.array([row.split(",") for row in page.centers().splitlines()[1:]], dtype=float),
        np.column_stack([dots.x, dots.y]), atol=1e-6,
    )  # fmt: skip


def test_a_csv_opened_in_the_page_keeps_the_setting():
    page = Page("explorer=vigilance&vigilance=0.2&order=%22shuffled%22", read_patterns(FLOWERS))
    sent = []
    page.desk.send = lambda message, buffers=None: sent.append(message)
    page._asked(page.desk, {"kind": "opened", "name": "a.csv", "text": FLOWERS[:600]}, [])
    assert page.explorer.controls["order"].value == "shuffled"
    assert "at vigilance 0.2; " in page.explorer.drawn.fact and page.children[1].value == ""
    page._asked(page.desk, {"kind": "centers"}, [])
    assert sent == [{"name": "centers.csv", "text": page.centers()}]
    page._asked(page.desk, {"kind": "opened", "name": "b.csv", "text": "<b>\nno"}, [])
    assert "b.csv: patterns must be two columns of numbers" in page.children[1].value
    assert "<b>" not in page.children[1].value


def test_what_a_link_says_wrongly_is_named_and_the_rest_is_kept():
    explorer = EXPLORERS["value"]()
    words = set_to(explorer, {"belief": "0.75", "horizon": "[]", "color": "1"})
    assert words == "the link has no sense here: horizon=[], color=1"
    assert setting(explorer) == {"horizon": "3", "belief": "0.75"}
    with pytest.raises(ValueError, match=r"explorer must be one of horizon, .* got 'dance'"):
        Page("explorer=dance")


def test_a_visit_asks_the_address_first(monkeypatch, tmp_path):
    monkeypatch.setenv("QUERY_STRING", "explorer=value&belief=0.6")
    assert visit("kalman").explorer.controls["belief"].value == 0.6
    monkeypatch.setenv("QUERY_STRING", "")
    csv = tmp_path / "flowers.csv"
    csv.write_text(FLOWERS)
    assert visit("vigilance", str(csv)).explorer.drawn.panels[0].xlabel == "length"


@pytest.mark.parametrize(
    ("text", "names", "low", "high"),
    [
        ("1,2\n3,4\n5,7", ("x", "y"), (1, 2), (5, 7)),
        ("a;b;c\n0.5;-1;9\n1;0;9\n-0.5;0.5;9", ("a", "b"), (-1, -1), (1, 1)),
        ("t\tname\tu\n0\tone\t5\n1\ttwo\t5\n2\tthree\t5", ("t", "u"), (0, 5), (2, 6)),
        ("x,y\n1,2\n,5\n3,4\ninf,1\n5,7", ("x", "y"), (1, 2), (5, 7)),
    ],
)
def test_many_kinds_of_csv_are_read(text, names, low, high):
    read = read_patterns(text)
    assert (read.names, read.low, read.high) == (names, low, high)
    assert np.abs(read.scaled).max() <= 1 and len(read.scaled) == 3


def test_the_robots_columns_are_scaled_as_the_robot_scales_them():
    text = "cycle,orientation,distance\n0,0.5,2150\n1,0,200\n2,-0.5,4100\n3,0.7,300\n4,0,5000"
    assert read_patterns(text).scaled.tolist() == [[0, 1], [-1, 0], [1, -1]]
    with pytest.raises(ValueError, match="rows of patterns must be"):
        read_patterns("distance,orientation\n9000,0\n9000,0\n9000,0")


def test_an_array_of_patterns_is_the_robots():
    explorer = vigilance_explorer([[0.0, 0.0], [0.5, 0.5], [1.0, 1.0]])
    assert explorer.drawn.panels[0].ylabel == "distance (mm)"

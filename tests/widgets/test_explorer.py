"""Explorers without a browser: what moves them, what is sent, what is stored."""

import base64
import io
import itertools
from pathlib import Path

import ipywidgets
import numpy as np
import pytest
from IPython.core.formatters import DisplayFormatter
from PIL import Image

from arkaq_edu.widgets import Buttons, CanvasView, Drag, Explorer
from arkaq_edu.widgets import explorer as module
from arkaq_edu.widgets.scene import Cells, Panel, Points, Scene


def dot_at(x):
    if x == 13:
        raise RuntimeError("no luck <here>")
    return Scene(f"a dot at {x}", [Panel("x", "y", (0, 20), (0, 1), [Points([x], [0.5])])])


@pytest.fixture
def explorer():
    return Explorer(dot_at, x=ipywidgets.IntSlider(3, max=20))


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


def test_a_stored_notebook_shows_the_picture_and_the_fact():
    def striped(n):
        edges = np.linspace(0, 9, n + 1)
        stripes = [np.array([(a, 0), (b, 0), (b, 1), (a, 1)]) for a, b in itertools.pairwise(edges)]
        cells = Cells(stripes, [stripe % 2 for stripe in range(n)], (0, 9, 0, 1))
        return Scene(f"{n} stripes", [Panel("x", "y", (0, 9), (0, 1), [cells])])

    explorer, pictures = Explorer(striped, n=ipywidgets.IntSlider(2, max=9)), []
    for n in (2, 5):
        explorer.controls["n"].value = n
        data, metadata = DisplayFormatter().format(explorer)
        assert data["text/plain"] == repr(explorer) == f"{n} stripes"
        assert "application/vnd.jupyter.widget-view+json" in data
        png = data["image/png"]
        picture = Image.open(io.BytesIO(base64.b64decode(png) if isinstance(png, str) else png))
        assert picture.width == 2 * metadata["image/png"]["width"]
        pictures.append(np.asarray(picture.convert("RGB")))
    assert (pictures[0] != pictures[1]).any(axis=2).mean() > 0.1
    assert explorer.drawn.png() == explorer.drawn.png()


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
    script = Path(module.__file__).with_name("canvas.js").read_text()
    for name in ("drag", "arrows", "draggable"):
        assert f'"{name}"' in script and CanvasView.class_traits()[name].metadata["sync"]

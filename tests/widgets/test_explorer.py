"""Explorers without a browser: what moves them, what is sent, what is stored."""

import base64
import gc
import importlib
import io
import itertools
import pkgutil
import weakref
from pathlib import Path

import ipywidgets
import numpy as np
import pytest
from IPython.core.formatters import DisplayFormatter
from PIL import Image

import arkaq_edu.widgets
from arkaq_edu.experiments import approach
from arkaq_edu.widgets import Buttons, CanvasView, Drag, Explorer
from arkaq_edu.widgets import explorer as module
from arkaq_edu.widgets.explorer import slider
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


def pulled(number, start, to, phase="move"):
    return {"number": number, "panel": 0, "from": start, "to": to, "phase": phase}


def belief(value=0.5, step=0.1, low=0, high=1):
    return slider("belief", value, low, high, step)


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
    one = Drag(belief())
    view = CanvasView()
    one.follow(view)
    for pressed, value in [((1, 0), 0.6), ((1, 1), 0.7), ((-2, 1), 0.4), ((30, 1), 1.0)]:
        view.arrows = pressed
        assert one.value == pytest.approx(value)


def test_a_drag_by_gain_goes_from_where_the_sliders_were_and_tells_of_both_at_once():
    both = Drag(belief(0, 1, -90, 90), belief(30, 1, 0, 60), gain=(-20, 10))
    view, told = CanvasView(), []
    both.follow(view)
    both.observe(lambda change: told.append(change["new"]), names="value")
    view.drag = pulled(1, (0.5, 0.5), (1.5, 1.0), phase="begin")
    view.drag = pulled(1, (0.5, 0.5), (2.5, 1.5))
    assert told == [(-20, 35), (-40, 40)], "not added up: it is counted from where it began"
    view.drag = pulled(2, (0.0, 0.0), (0.0, 9.0))
    assert both.value == (-40, 60), "no further than the slider goes"
    view.arrows = (1, -2)
    assert both.value == (-41, 58), "a key goes the way that a drag goes"
    told.clear()
    both.value = (7, 8)
    assert [slider.value for slider in both.children] == [7, 8] and set(told) == {(7, 8)}


def test_the_script_tells_all_that_a_drag_reads():
    script = Path(module.__file__).with_name("canvas.js").read_text()
    for name in ("drag", "arrows", "draggable"):
        assert f'"{name}"' in script and CanvasView.class_traits()[name].metadata["sync"]


# --- closed is closed -----------------------------------------------------------------------------


def film():
    return arkaq_edu.widgets.film_explorer(approach.trajectory(1))


MAKERS = [film] + [
    getattr(arkaq_edu.widgets, name)
    for name in arkaq_edu.widgets.__all__
    if name.endswith("_explorer") or name == "control_panel"
    if name != "film_explorer"  # it needs an episode: see above
]


def alive():
    """All widgets that ipywidgets keeps, and would save with the notebook."""
    return set(ipywidgets.widgets.widget._instances)


def play(explorer):
    """Move every control once, as a reader does."""
    for control in explorer.controls.values():
        if hasattr(control, "press"):
            names = getattr(control, "names", None) or control.problems["corridor"].actions
            control.press(names[0])
        elif hasattr(control, "menu"):
            control.menu.index = 1
    for control in explorer.controls.values():
        if hasattr(control, "options"):
            control.index = 0
        elif hasattr(control, "min"):
            control.value = control.max
    if "turns" in explorer.controls:
        explorer.controls["turns"].menu.value = "tiger"
    assert explorer.error is None


@pytest.mark.parametrize("make", MAKERS, ids=lambda make: make.__name__)
def test_of_a_closed_explorer_no_widget_is_left(make):
    before = alive()
    explorer = make()
    play(explorer)
    assert len(alive() - before) > 5
    explorer.close()
    assert alive() == before
    gone = weakref.ref(explorer.view)
    del explorer
    gc.collect()
    assert gone() is None, "and its memory is given back"


@pytest.fixture
def run_cell(monkeypatch):
    """A function that runs code as a notebook does: in a cell, by a request of its own."""
    shell, numbers = type("Shell", (), {})(), itertools.count()
    monkeypatch.setattr(module, "get_ipython", lambda: shell)
    monkeypatch.setattr(module, "_MADE", {})

    def run(cell, make):
        header = {"msg_id": f"request {next(numbers)}"}
        request = {"header": header, "metadata": {"cellId": cell} if cell else {}}
        shell.get_parent = lambda: request
        return make()

    return run


def test_a_cell_that_runs_again_leaves_no_widget_over(run_cell):
    def two():
        return [Explorer(dot_at, x=slider("x", 3, 0, 20)) for _ in range(2)]

    before = alive()
    run_cell("a", two)
    once = len(alive() - before)
    for _ in range(3):
        kept = run_cell("a", two)
        assert len(alive() - before) == once
    assert all(explorer.comm is not None for explorer in kept), "both of the last run are open"
    run_cell("b", two)
    run_cell(None, two)
    assert len(alive() - before) == 3 * once, "what other cells made stays"


def test_every_cache_of_an_explorer_has_a_bound():
    caches = []
    for package in (arkaq_edu.widgets, arkaq_edu.experiments, arkaq_edu.mdp, arkaq_edu.pomdp):
        for found in pkgutil.walk_packages(package.__path__, f"{package.__name__}."):
            members = vars(importlib.import_module(found.name)).values()
            caches += [member for member in members if hasattr(member, "cache_info")]
    assert len(caches) >= 7
    assert all(cache.cache_info().maxsize for cache in caches)

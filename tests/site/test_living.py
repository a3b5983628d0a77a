"""Explorers without a kernel: what is packed is what the notebook shows."""

import json
import re

import nbformat
import numpy as np
import pytest

from arkaq_edu import widgets
from arkaq_edu.site import living
from arkaq_edu.site.chapters import alive_in, masters
from arkaq_edu.site.living import LIVING, Handle, Pack, handles, name_of, packed, settings
from arkaq_edu.site.packing import rounded, unpack
from arkaq_edu.site.robots import RECORDINGS, Recording, recorded
from arkaq_edu.widgets.robot import CHANCE, Robot


def shown(told, numbers, scene):
    """The scene of that number as canvas.js takes it: its fact, its layout, its numbers."""
    fact, panels = told["scenes"][scene]
    parts, found = [], []
    for panel in (told["panels"][i] for i in panels):
        layers = [told["layers"][i] for i in panel["layers"]]
        parts += [numbers[layer["start"] :][: layer["length"]] for layer in layers]
        found.append(panel | {"layers": [{**layer, "start": None} for layer in layers]})
    return fact, found, np.concatenate(parts)


def without_starts(layout):
    return [
        {**panel, "layers": [{**layer, "start": None} for layer in panel["layers"]]}
        for panel in layout["panels"]
    ]


@pytest.fixture(scope="module")
def value():
    stops = {"belief.0": [n / 10 for n in range(11)]}
    return unpack(packed(living.Living(widgets.value_explorer, (stops,))))


def test_every_stop_shows_what_the_notebook_shows(value):
    told, numbers = value
    explorer = widgets.value_explorer()
    assert len(told["settings"]) == 5 * 12  # where it starts is a stop, too
    for horizon, belief, scene in told["settings"][::7]:
        explorer.controls["horizon"].value = horizon + 1
        explorer.controls["belief"].value = belief / 100
        layout, raw = explorer.drawn.pack()
        fact, panels, own = shown(told, numbers, scene)
        assert fact == repr(explorer)
        assert json.dumps(panels) == json.dumps(without_starts(layout))
        np.testing.assert_allclose(own, np.frombuffer(raw, np.float32), rtol=1e-4, atol=1e-6)


def test_what_scenes_share_is_stored_once(value):
    told, numbers = value
    plain = sum(
        told["layers"][layer]["length"]
        for _, panels in told["scenes"]
        for panel in panels
        for layer in told["panels"][panel]["layers"]
    )
    assert len(numbers) < plain / 5


def test_a_page_starts_where_the_notebook_starts(value):
    told, numbers = value
    start = [handle["start"] for handle in told["handles"]]
    (scene,) = [row[-1] for row in told["settings"] if row[:-1] == start]
    assert shown(told, numbers, scene)[0] == repr(widgets.value_explorer())


def test_a_drag_knows_the_values_of_its_stops(value):
    (drag,) = value[0]["drag"]
    assert drag["handles"] == ["belief.0"] and drag["values"][0][25] == 0.25
    assert drag["gain"] is None


def test_buttons_lead_from_history_to_history(monkeypatch):
    explorer = widgets.belief_explorer()
    way = living.Living(widgets.belief_explorer, presses=lambda turns: living._turns(turns, 30))
    turns = handles(explorer, way)["turns"]
    corridor = turns.look["roots"]["corridor"]
    right = turns.look["after"][corridor]["right"]
    assert turns.values[right] == ("corridor", "right")
    assert turns.start == corridor
    assert set(turns.look["after"][right]) <= {"nothing", "goal", "let the world answer"}
    assert turns.look["rows"]["tiger"][0][0] == "do"


def test_a_setting_keeps_its_start_and_the_stops_that_are_named():
    made = {"a": Handle({}, [0.0, 0.1, 0.30000000000000004], 0), "b": Handle({}, ["x", "y"], 1)}
    assert settings(made, [{"a": (0.3,)}]) == [(0, 0), (0, 1), (2, 0), (2, 1)]
    assert settings(made, [{"a": slice(0, None, 2), "b": living.START}]) == [(0, 1), (2, 1)]


def test_pictures_are_packed_byte_by_byte():
    pixels = np.random.default_rng(0).integers(0, 256, (4, 5, 3)).astype(np.uint8)
    picture = widgets.scene.Picture(pixels, (0, 1, 0, 1))
    scene = widgets.scene.Scene("", [widgets.scene.Panel("", "", (0, 1), (0, 1), [picture])])
    pack = Pack()
    pack.add(scene)
    _, numbers = unpack(pack.to_bytes())
    assert (numbers.view(np.uint8).reshape(4, 5, 4)[..., :3] == pixels).all()


def test_numbers_are_rounded_by_less_than_a_pixel():
    x = np.random.default_rng(0).normal(size=1000).astype(np.float32) * 4000
    np.testing.assert_allclose(rounded(x), x, rtol=2**-16)
    assert np.isnan(rounded(np.float32([np.nan]))[0])


def test_a_menu_shows_the_sliders_of_its_method_only():
    patterns = [[0.0, 0.0], [0.1, 0.0], [1.0, 1.0]]
    explorer = widgets.vigilance_explorer(patterns)
    made = handles(explorer, living.Living(widgets.vigilance_explorer))
    assert living._hidden(explorer, made) == {"method": [["cosine"], ["vigilance"]]}
    assert explorer.controls["method"].value == "Euclidean"


def test_every_explorer_of_the_chapters_lives():
    names = {"vigilance_explorer", *map(name_of, LIVING), *RECORDINGS}
    shows = re.compile(r"(\w+_explorer|control_panel|live_robot|vigilance_robot|race)\(")
    found = set()
    for master in masters():
        for cell in nbformat.read(master, as_version=4).cells:
            pictured = any(
                "image/png" in output.get("data", {}) for output in cell.get("outputs", [])
            )
            if pictured and shows.match(cell.source.strip().rpartition("\n")[2]):
                alive = alive_in(cell.source)
                assert alive, cell.source
                found |= {each.name for each in alive}
    assert found <= names and set(map(name_of, LIVING)) <= found


def test_a_recording_is_what_the_robot_does():
    told, _ = unpack(recorded(Recording("goal", (CHANCE,), range(3, 4))))
    robot = Robot("goal")
    robot.set(driver=CHANCE, seed=3)
    frames = told["takes"]["0,0,0"]
    assert frames[0]["words"] == robot.frame()["words"]
    assert [frame["words"] for frame in frames[1:5]] == [robot.step()["words"] for _ in frames[1:5]]
    assert sum(frame["over"] for frame in frames) == 2
    assert told["maps"][frames[0]["map"]]

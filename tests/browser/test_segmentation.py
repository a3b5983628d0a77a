"""Notebook 07 in a real browser: it reads well, it runs, its explorer follows the keyboard."""

import re

from playwright.sync_api import expect

from tests.browser.conftest import RUN_ALL
from tests.browser.reading import OUTPUTS, assert_sound, errors, picture, slider_of

NOTEBOOK = "07_state_segmentation.ipynb"
CELL = "from arkaq_edu.widgets import vigilance_explorer; vigilance_explorer()"
FACT = re.compile(r"^([\d,]+) categories at vigilance ([\d.]+?)[,;]")


def fact(canvas):
    """The count and the vigilance that the canvas states."""
    count, vigilance = FACT.match(canvas.get_attribute("aria-label")).groups()
    return int(count.replace(",", "")), float(vigilance)


def assert_reads_well(page):
    """Fail where the page, before anything is run, lacks a stored picture or shows a widget."""
    cell = page.locator(".jp-CodeCell", has_text="vigilance_explorer()")
    stored = cell.locator(".jp-OutputArea img")
    expect(stored).to_be_visible()
    assert stored.evaluate("(image) => image.naturalWidth") > 1000
    pictures = [o for o in page.evaluate(OUTPUTS) if "image/png" in o.get("data", {})]
    assert page.locator(".jp-OutputArea img").count() == len(pictures)
    assert page.get_by_role("slider").count() == 0
    assert_sound(page)


def test_reads_well_then_runs_and_follows_the_keyboard(open_notebook):
    page = open_notebook(NOTEBOOK, run=False)
    assert_reads_well(page)
    page.evaluate(RUN_ALL)
    assert errors(page) == []

    canvas = page.get_by_role("img", name=FACT)
    expect(canvas).to_be_visible()
    slider, readout = slider_of(page, "vigilance")
    slider.focus()
    (first_count, vigilance), drawn = fact(canvas), picture(canvas)
    for key, step in [("ArrowLeft", -0.005), ("ArrowLeft", -0.005), ("PageDown", None)]:
        slider.press(key)
        expect(canvas).not_to_have_attribute(
            "aria-label", re.compile(f"vigilance {vigilance:g}[,;]")
        )
        (count, new_vigilance), new_picture = fact(canvas), picture(canvas)
        assert count > first_count and new_vigilance < vigilance
        assert step is None or abs(new_vigilance - vigilance - step) < 1e-9
        assert new_picture != drawn
        vigilance, drawn = new_vigilance, new_picture
    assert float(readout.inner_text()) == vigilance

    page.get_by_label("method").select_option("angular")
    expect(canvas).to_have_attribute("aria-label", re.compile(r"vigilance 0\.95, a cosine"))
    assert picture(canvas) != drawn
    slider, readout = slider_of(page, "vigilance")
    slider.press("ArrowLeft")
    expect(canvas).to_have_attribute("aria-label", re.compile(r"vigilance 0\.94, a cosine"))
    assert float(readout.inner_text()) == 0.94
    page.get_by_label("method").select_option("Euclidean")
    expect(canvas).to_have_attribute("aria-label", re.compile(f"vigilance {vigilance:g}[,;]"))
    page.get_by_label("order").select_option("sorted by distance")
    expect(canvas).not_to_have_attribute("aria-label", re.compile(f"^{count} categories"))
    assert_sound(page)


def test_fits_the_window_and_the_screen(open_cells):
    page = open_cells(CELL, viewport={"width": 1280, "height": 900}, device_scale_factor=2)
    canvas, (slider, _) = page.get_by_role("img", name=FACT), slider_of(page, "vigilance")
    expect(canvas).to_be_visible()
    wide, output = canvas.bounding_box(), page.locator(".jp-OutputArea", has=canvas).bounding_box()
    assert canvas.evaluate("(canvas) => [canvas.width, canvas.height]") == [
        2 * wide["width"],
        2 * wide["height"],
    ]

    slider.press("Home")
    expect(canvas).to_have_attribute("aria-label", re.compile(r"vigilance 0\.025[,;]"))
    after = page.locator(".jp-OutputArea", has=canvas).bounding_box()
    assert (after["width"], after["height"]) == (output["width"], output["height"])
    moved = canvas.bounding_box()["y"] - after["y"] - (wide["y"] - output["y"])
    assert abs(moved) < 0.01, "the picture jumps as the slider moves"

    page.set_viewport_size({"width": 620, "height": 900})
    expect(canvas).not_to_have_attribute("style", re.compile(f"width: {wide['width']:g}px"))
    narrow = canvas.bounding_box()
    assert narrow["width"] < wide["width"]
    assert canvas.evaluate("(canvas) => canvas.width") == 2 * narrow["width"]

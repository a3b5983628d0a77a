"""Explorers 4 in a real browser: the belief is dragged, the bowl is turned."""

import re

from playwright.sync_api import expect

from tests.browser.reading import assert_sound, picture, slider_of


def drag(canvas, start, end):
    """Pull the mouse over a canvas, from one share of its width and height to another.

    Return the size of the canvas.
    """
    page = canvas.page
    canvas.scroll_into_view_if_needed()
    box = canvas.bounding_box()
    places = [(box["x"] + x * box["width"], box["y"] + y * box["height"]) for x, y in (start, end)]
    page.mouse.move(*places[0])
    page.mouse.down()
    page.mouse.move(*places[1], steps=8)
    page.mouse.up()
    return box["width"], box["height"]


def test_plans_follow_the_mouse_and_the_keys(run_cell):
    cell = run_cell("from arkaq_edu.widgets import value_explorer; value_explorer()")
    surface = cell.get_by_role("img", name=re.compile("plans are needed"))
    expect(surface).to_have_attribute("aria-label", re.compile(r"^3 steps .*= 0.25: "))
    slider, _ = slider_of(cell, "steps to go")
    slider.first.focus()
    slider.first.press("ArrowRight")
    expect(surface).to_have_attribute("aria-label", re.compile("^4 steps .* 16 of 686 plans"))
    slider.first.press("ArrowLeft")
    expect(surface).to_have_attribute("aria-label", re.compile("^3 steps .* 7 of 128 plans"))
    drawn = picture(surface)
    width, _ = drag(surface, (0.3, 0.5), (0.45, 0.3))
    axis = width * 1.3 / 2.3 - 62 - 14  # the left panel's share, less its margins
    p = (0.45 * width - 62) / axis
    expect(surface).to_have_attribute("aria-label", re.compile(f"= {p:.2f}: .*begin with a1"))
    _, readout = slider_of(cell, "belief")
    expect(readout).to_have_text(f"{p:.2f}")
    assert picture(surface) != drawn
    drag(surface, (0.4, 0.5), (0.01, 0.5))  # beyond the axis
    expect(surface).to_have_attribute("aria-label", re.compile(r"= 0.00: worth 3.7.*with a2"))
    for key, p in [("ArrowRight", "0.01"), ("ArrowUp", "0.02"), ("ArrowLeft", "0.01")]:
        cell.page.keyboard.press(key)
        expect(surface).to_have_attribute("aria-label", re.compile(f"= {p}: "))
    assert surface.evaluate("(canvas) => document.activeElement === canvas")
    assert_sound(cell)


def test_the_bowl_is_turned(run_cell):
    cell = run_cell("from arkaq_edu.widgets import bowl_explorer; bowl_explorer()")
    bowl = cell.get_by_role("img", name=re.compile("planes"))
    expect(bowl).to_have_attribute("aria-label", re.compile("7 planes, .*seen from 46°, 38° up$"))
    drawn = picture(bowl)
    width, height = drag(bowl, (0.3, 0.5), (0.4, 0.65))
    unit = min(width * 1.2 / 2.2 / 2.7, height / 3.15)
    azimuth = 2 * round((46 + 60 * 0.1 * width / unit) / 2)
    elevation = 2 * round((38 + 60 * 0.15 * height / unit) / 2)
    turned = re.compile(f"from {azimuth}°, {elevation}° up")
    expect(bowl).to_have_attribute("aria-label", turned)
    assert picture(bowl) != drawn
    cell.page.keyboard.press("ArrowLeft")
    cell.page.keyboard.press("ArrowDown")
    turned = re.compile(f"from {azimuth - 2}°, {elevation + 2}° up")
    expect(bowl).to_have_attribute("aria-label", turned)
    drag(bowl, (0.75, 0.4), (0.9, 0.4))  # the map is not for turning
    expect(bowl).to_have_attribute("aria-label", turned)
    assert_sound(cell)

"""Explorers 2 in a real browser: a key is a sweep, a second key a learning run."""

import re

from playwright.sync_api import expect

from tests.browser.reading import assert_sound, picture, slider_of

SWEPT = re.compile(r"^sweep (\d+): (\d+) arrows? turned, (\d+) of 37 are right")
LEARNED = re.compile(r"^([\d,]+) steps: (\d+) of 37 arrows are right")


def test_a_key_is_a_sweep(run_cell):
    cell = run_cell("from arkaq_edu.widgets import planning_explorer; planning_explorer()")
    canvas = cell.get_by_role("img", name=SWEPT)
    expect(canvas).to_be_visible()
    slider, readout = slider_of(cell, "sweeps")
    slider.focus()
    right, drawn = [4], picture(canvas)
    for sweep in (1, 2, 3):
        slider.press("ArrowRight")
        expect(canvas).to_have_attribute("aria-label", re.compile(f"^sweep {sweep}: "))
        assert int(readout.inner_text()) == sweep
        right.append(int(SWEPT.match(canvas.get_attribute("aria-label"))[3]))
        assert picture(canvas) != drawn
        drawn = picture(canvas)
    assert right == sorted(right) and right[-1] > right[0]
    slider.press("End")
    expect(canvas).to_have_attribute("aria-label", re.compile("^sweep 40: 0 arrows turned, 37 of"))
    slip, _ = slider_of(cell, "slip")
    slip.press("End")
    expect(canvas).to_have_attribute("aria-label", re.compile("^sweep 40: .* off by [1-9]"))
    assert_sound(cell)


def test_learning_follows_the_keys(run_cell):
    cell = run_cell("from arkaq_edu.widgets import q_learning_explorer; q_learning_explorer()")
    life = cell.get_by_role("img", name=LEARNED)
    steps, _ = slider_of(cell, "steps")
    steps.press("Home")
    expect(life).to_have_attribute("aria-label", re.compile("^0 steps: 0 of 37"))
    heat, readout = slider_of(cell, "temperature")
    before = picture(life)
    steps.press("End")
    expect(life).to_have_attribute("aria-label", re.compile("^20,000 steps: "))
    assert picture(life) != before
    fact = life.get_attribute("aria-label")
    heat.press("End")
    expect(life).not_to_have_attribute("aria-label", fact)
    assert readout.inner_text() == "1000"
    assert_sound(cell)

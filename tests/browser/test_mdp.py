"""Notebook 02 in a real browser: it runs, and a key is a sweep."""

import re

from playwright.sync_api import expect

from tests.browser.reading import assert_sound, errors, picture, slider_of

NOTEBOOK = "02_markov_decision_processes.ipynb"
SWEPT = re.compile(r"^sweep (\d+): (\d+) arrows? turned, (\d+) of 37 are right")
LEARNED = re.compile(r"^([\d,]+) steps: (\d+) of 37 arrows are right")


def test_runs_and_a_key_is_a_sweep(open_notebook):
    page = open_notebook(NOTEBOOK)
    assert errors(page) == []

    canvas = page.get_by_role("img", name=SWEPT)
    expect(canvas).to_be_visible()
    slider, readout = slider_of(page, "sweeps")
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
    slip, _ = slider_of(page, "slip")
    slip.press("End")
    expect(canvas).to_have_attribute("aria-label", re.compile("^sweep 40: .* off by [1-9]"))

    life = page.get_by_role("img", name=LEARNED)
    steps, _ = slider_of(page, "steps")
    steps.press("Home")
    expect(life).to_have_attribute("aria-label", re.compile("^0 steps: 0 of 37"))
    heat, readout = slider_of(page, "temperature")
    before = picture(life)
    steps.press("End")
    expect(life).to_have_attribute("aria-label", re.compile("^20,000 steps: "))
    assert picture(life) != before
    fact = life.get_attribute("aria-label")
    heat.press("End")
    expect(life).not_to_have_attribute("aria-label", fact)
    assert readout.inner_text() == "1000"
    assert_sound(page)

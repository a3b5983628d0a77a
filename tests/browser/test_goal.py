"""Notebook 11 in a real browser: it runs, and what scores follows the keyboard."""

import re

from playwright.sync_api import expect

from tests.browser.reading import assert_sound, errors, picture, slider_of

NOTEBOOK = "11_scoring_goals.ipynb"
FACT = re.compile(r"^([\d,]+) mm, spread ([\d.]+), .* vigilance ([\d.]+): (\d+) % score")


def test_runs_and_follows_the_keyboard(open_notebook):
    page = open_notebook(NOTEBOOK)
    assert errors(page) == []
    canvas = page.get_by_role("img", name=FACT)
    expect(canvas).to_be_visible()

    def stated():
        return FACT.match(canvas.get_attribute("aria-label")).groups()

    assert stated()[:3] == ("1,850", "1", "0.06")
    scored, drawn = int(stated()[3]), picture(canvas)
    for name, key, fact in [
        ("kick's spread", "ArrowLeft", "^1,850 mm, spread 0.9, "),
        ("distance", "ArrowLeft", "^1,800 mm, spread 0.9, "),
        ("vigilance", "ArrowRight", "vigilance 0.075: "),
    ]:
        slider, _ = slider_of(page, name)
        slider.press(key)
        expect(canvas).to_have_attribute("aria-label", re.compile(fact))
        assert picture(canvas) != drawn
        drawn = picture(canvas)
    assert int(stated()[3]) > scored, "nearer, and with a steadier kick"

    slider, readout = slider_of(page, "vigilance")
    slider.press("End")
    expect(canvas).to_have_attribute("aria-label", re.compile(r"1 state at vigilance 1\.2: "))
    assert readout.inner_text() == "1.2"
    assert_sound(page)

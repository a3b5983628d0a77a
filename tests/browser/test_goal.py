"""Explorer 11 in a real browser: what scores follows the keyboard."""

import re

from playwright.sync_api import expect

from tests.browser.reading import assert_sound, picture, slider_of

FACT = re.compile(r"^([\d,]+) mm, spread ([\d.]+), .* vigilance ([\d.]+): (\d+) % score")


def test_follows_the_keyboard(run_cell):
    cell = run_cell("from arkaq_edu.widgets import scoring_explorer; scoring_explorer()")
    canvas = cell.get_by_role("img", name=FACT)
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
        slider, _ = slider_of(cell, name)
        slider.press(key)
        expect(canvas).to_have_attribute("aria-label", re.compile(fact))
        assert picture(canvas) != drawn
        drawn = picture(canvas)
    assert int(stated()[3]) > scored, "nearer, and with a steadier kick"

    slider, readout = slider_of(cell, "vigilance")
    slider.press("End")
    expect(canvas).to_have_attribute("aria-label", re.compile(r"1 state at vigilance 1\.2: "))
    assert readout.inner_text() == "1.2"
    assert_sound(cell)

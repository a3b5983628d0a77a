"""Explorer 8 in a real browser: the robot goes where keys and presses send it."""

import re

from playwright.sync_api import expect

from tests.browser.reading import assert_sound, picture, slider_of


def test_is_driven_by_hand(run_cell):
    cell = run_cell("from arkaq_edu.widgets import control_panel; control_panel()")
    canvas = cell.get_by_role("img", name=re.compile(r"\(true"))
    expect(canvas).to_have_attribute("aria-label", re.compile(r"^ball 1,.* next \+100 mm, \+0\.00"))
    drawn = picture(canvas)

    def press(name):
        cell.get_by_role("button", name=name, exact=True).filter(visible=True).click()

    def shows(fact):
        nonlocal drawn
        expect(canvas).to_have_attribute("aria-label", re.compile(fact))
        assert picture(canvas) != drawn
        drawn = picture(canvas)

    slider, readout = slider_of(cell, "right stride")
    slider.press("ArrowRight")
    shows(r"next \+105 mm, \+0\.06 rad$")
    assert readout.inner_text() == "110"
    press("step")
    shows(r"^ball 1,1.* mm, .* \(true .*; goal ")
    slider_of(cell, "head to the left")[0].press("ArrowRight")
    shows("^the head moves, no look counts")
    press("wait 0.1 s")
    press("wait 0.1 s")
    shows(r"^ball 1,1.* \(true ")
    press("ball to the paw")
    press("kick")
    shows("^kicked [0-9,]+ mm, (no|a) goal; ")
    press("start again")
    expect(canvas).to_have_attribute("aria-label", re.compile("^the head moves"))
    assert_sound(cell)

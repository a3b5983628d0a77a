"""Explorer 3 in a real browser: the belief follows the buttons."""

import re

from playwright.sync_api import expect

from tests.browser.reading import assert_sound, picture


def test_steps_a_belief(run_cell):
    cell = run_cell("from arkaq_edu.widgets import belief_explorer; belief_explorer()")
    canvas = cell.get_by_role("img", name=re.compile("bits of doubt|[?]$"))
    expect(canvas).to_have_attribute("aria-label", re.compile("^corridor, at first: "))

    def press(name):
        cell.get_by_role("button", name=name, exact=True).filter(visible=True).click()

    goal = cell.get_by_role("button", name="goal", exact=True).filter(visible=True)
    expect(goal).to_be_disabled()
    drawn = picture(canvas)
    for name, fact in [
        ("right", "corridor, step 1, right: nothing .67 or goal .33?"),
        ("goal", "corridor, step 1, right then goal: goal 1.00; 0.00 bits of doubt"),
        ("left", "corridor, step 2, left: nothing 1.00?"),
    ]:
        press(name)
        expect(canvas).to_have_attribute("aria-label", fact)
        assert picture(canvas) != drawn
        drawn = picture(canvas)
    expect(goal).to_be_disabled()  # it cannot be met twice running
    press("let the world answer")
    expect(canvas).to_have_attribute("aria-label", re.compile("^corridor, step 2, left then noth"))

    cell.get_by_label("problem").select_option("three_places")
    expect(canvas).to_have_attribute("aria-label", re.compile("^three_places, at first: "))
    press("look")
    press("seen-left")
    expect(canvas).to_have_attribute("aria-label", re.compile("^three_places, step 1.* left .70;"))
    press("start again")
    expect(canvas).to_have_attribute("aria-label", re.compile("^three_places, at first: "))
    assert_sound(cell)

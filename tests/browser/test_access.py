"""Explorers at the keyboard and for a screen reader, in a real browser."""

from playwright.sync_api import expect

from tests.browser.conftest import N_CELLS
from tests.browser.reading import assert_sound


def test_controls_have_names_and_values_and_keep_keys_and_focus(run_cell):
    filtered = run_cell("from arkaq_edu.widgets import kalman_explorer; kalman_explorer()")
    believed = run_cell("from arkaq_edu.widgets import belief_explorer; belief_explorer()")
    page = filtered.page
    cells = page.evaluate(N_CELLS)
    dropout = filtered.get_by_role("slider", name="dropout", exact=True)
    expect(dropout).to_have_attribute("aria-valuetext", "0%")
    expect(dropout).to_have_attribute("aria-description", "The share of sightings that are missing")
    dropout.press("ArrowRight")
    expect(dropout).to_have_attribute("aria-valuetext", "10%")
    expect(dropout).to_be_focused()
    sigma = filtered.get_by_role("slider", name="sigma of Q (mm)")
    expect(sigma).to_have_attribute("aria-valuetext", "25.0")
    assert page.locator('[title="null"]').count() == 0

    for key in ("b", "a", "d", "d", "x"):  # shortcuts that insert and delete cells
        sigma.press(key)
    right = believed.get_by_role("button", name="right", exact=True)
    right.press("b")
    assert page.evaluate(N_CELLS) == cells

    right.press("Enter")
    expect(believed.get_by_role("img", name="corridor, step 1, right: ")).to_be_visible()
    expect(right).to_be_disabled()
    expect(right).to_be_focused()
    right.press("Enter")  # nothing: an observation is due
    believed.get_by_role("button", name="goal", exact=True).press("Enter")
    expect(believed.get_by_role("img", name="corridor, step 1, right then goal")).to_be_visible()
    assert_sound(page)

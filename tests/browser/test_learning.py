"""Explorers 1 in a real browser: both follow keys and presses."""

import re

from playwright.sync_api import expect

from tests.browser.reading import assert_sound, picture, slider_of


def test_horizons_follow_the_keys(run_cell):
    cell = run_cell("from arkaq_edu.widgets import horizon_explorer; horizon_explorer()")
    models = cell.get_by_role("img", name=re.compile("^h = 5: upper"))
    expect(models).to_be_visible()
    horizon, readout = slider_of(cell, "horizon h")
    drawn = picture(models)
    horizon.press("ArrowRight")
    models = cell.get_by_role("img", name=re.compile(r"^h = 6: middle \(8, 10, 0\)"))
    expect(models).to_be_visible()
    assert readout.inner_text() == "6" and picture(models) != drawn
    slider_of(cell, "discount gamma")[0].press("ArrowRight")
    expect(models).to_have_attribute("aria-label", re.compile(r"gamma = 0\.91: lower"))
    assert_sound(cell)


def test_bandits_follow_the_presses(run_cell):
    cell = run_cell("from arkaq_edu.widgets import bandit_explorer; bandit_explorer()")
    bandit = cell.get_by_role("img", name=re.compile("^12 pulls"))
    drawn = picture(bandit)
    cell.get_by_role("button", name="machine 3").click()
    bandit = cell.get_by_role("img", name=re.compile("^13 pulls, .* with luck"))
    expect(bandit).to_be_visible()
    assert picture(bandit) != drawn
    cell.get_by_label("show their chances").check()
    expect(cell.get_by_role("img", name=re.compile("^13 pulls, .* without luck"))).to_be_visible()
    slider_of(cell, "machines no.")[0].press("ArrowRight")
    expect(cell.get_by_role("img", name=re.compile("^no pull yet"))).to_be_visible()
    assert not cell.get_by_label("show their chances").is_checked()
    cell.get_by_role("button", name="machine 1").click()
    expect(cell.get_by_role("img", name=re.compile("^1 pull, "))).to_be_visible()
    assert_sound(cell)

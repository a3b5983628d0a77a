"""Notebook 01 in a real browser: it runs, and both explorers follow keys and presses."""

import re

from playwright.sync_api import expect

from tests.browser.reading import assert_sound, errors, picture, slider_of


def test_runs_and_follows_keys_and_presses(open_notebook):
    page = open_notebook("01_reinforcement_learning.ipynb")
    assert errors(page) == []

    models = page.get_by_role("img", name=re.compile("^h = 5: upper"))
    expect(models).to_be_visible()
    horizon, readout = slider_of(page, "horizon h")
    drawn = picture(models)
    horizon.press("ArrowRight")
    models = page.get_by_role("img", name=re.compile(r"^h = 6: middle \(8, 10, 0\)"))
    expect(models).to_be_visible()
    assert readout.inner_text() == "6" and picture(models) != drawn
    slider_of(page, "discount gamma")[0].press("ArrowRight")
    expect(models).to_have_attribute("aria-label", re.compile(r"gamma = 0\.91: lower"))

    bandit = page.get_by_role("img", name=re.compile("^12 pulls"))
    drawn = picture(bandit)
    page.get_by_role("button", name="machine 3").click()
    bandit = page.get_by_role("img", name=re.compile("^13 pulls, .* with luck"))
    expect(bandit).to_be_visible()
    assert picture(bandit) != drawn
    page.get_by_label("show their chances").check()
    expect(page.get_by_role("img", name=re.compile("^13 pulls, .* without luck"))).to_be_visible()
    slider_of(page, "machines no.")[0].press("ArrowRight")
    expect(page.get_by_role("img", name=re.compile("^no pull yet"))).to_be_visible()
    assert not page.get_by_label("show their chances").is_checked()
    page.get_by_role("button", name="machine 1").click()
    expect(page.get_by_role("img", name=re.compile("^1 pull, "))).to_be_visible()
    assert_sound(page)

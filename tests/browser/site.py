"""Every page of the site in a real Chromium, opened from the disk, with the network off.

    make site site-check

Each page opens at the width of a desk and of a phone, without an error or a request. Each slider of
each explorer goes to both ends by the keyboard, and the picture changes. At the end it says how
long a picture takes to follow a key, which should be under 50 ms on a quiet machine.
"""

import os
import statistics
from pathlib import Path

import pytest

from arkaq_edu.site.links import problems
from tests.browser.reading import CLOCK

SITE = Path(os.environ.get("SITE", Path(__file__).parents[2] / "build" / "site")).resolve()
PAGES = sorted(SITE.rglob("*.html"))
WANTED = 50  # ms from a key to the picture

PICTURE = "canvas => canvas.toDataURL()"
DONE = "() => new Promise(done => requestAnimationFrame(() => requestAnimationFrame(done)))"
CLIPPED = "document.documentElement.scrollWidth > document.documentElement.clientWidth"


@pytest.fixture
def open_page(chromium):
    """A function that opens a page from the disk; what goes wrong there is kept in its faults."""
    windows = []

    def open_(path, width):
        window = chromium.new_context(
            viewport={"width": width, "height": 900}, offline=True, color_scheme="dark"
        )
        windows.append(window)
        page = window.new_page()
        page.faults = []
        page.on("pageerror", lambda error: page.faults.append(str(error)))
        page.on(
            "console",
            lambda said: said.type in ("error", "warning") and page.faults.append(said.text),
        )
        page.on(
            "request",
            lambda request: (
                request.url.startswith(("file:", "data:", "blob:"))
                or page.faults.append(f"asks for {request.url}")
            ),
        )
        page.on("requestfailed", lambda request: page.faults.append(f"no {request.url}"))
        page.goto(path.as_uri())
        page.evaluate(DONE)
        return page

    yield open_
    for window in windows:
        window.close()


def test_no_link_is_broken_and_no_page_is_heavy():
    assert PAGES, f"no pages in {SITE}: make site"
    assert problems(SITE) == []


@pytest.mark.parametrize("width", [1360, 390])
@pytest.mark.parametrize("path", PAGES, ids=lambda path: path.relative_to(SITE).as_posix())
def test_a_page_opens_without_error_or_request(open_page, path, width):
    page = open_page(path, width)
    assert not page.evaluate(CLIPPED), "it is wider than the window"
    assert page.faults == []


@pytest.mark.parametrize(
    "path",
    [path for path in PAGES if "arkaq-living" in path.read_text(encoding="utf-8")],
    ids=lambda path: path.stem,
)
def test_every_explorer_follows_the_keyboard(open_page, path, capsys):
    page = open_page(path, 1360)
    page.locator("body").evaluate(CLOCK)
    times = []
    for place in page.locator(".arkaq-living").all():
        place.scroll_into_view_if_needed()
        canvas = place.locator("canvas")
        canvas.wait_for()
        name = place.get_attribute("data-explorer")
        for slider in place.get_by_role("slider").filter(visible=True).all():
            if slider.evaluate("slider => slider.labels[0].textContent") == "speed":
                continue  # nothing is played here, so no picture shows it
            pictures = []
            for key in ("Home", "End", "Home", *["ArrowRight"] * 5):
                page.evaluate("times.length = 0")
                slider.press(key)
                page.evaluate(DONE)
                page.wait_for_timeout(30)
                times += page.evaluate("times")
                pictures.append(canvas.evaluate(PICTURE))
            low, high = pictures[:2]
            assert low != high, f"{name}: {slider.get_attribute('title')}: changes nothing"
        for button in place.get_by_role("button").all()[:3]:
            # At the start there is nothing to start again, and a button may have to wait its turn.
            if button.get_attribute("aria-disabled") == "true" or "start" in button.inner_text():
                continue
            before = canvas.evaluate(PICTURE)
            button.click()
            page.evaluate(DONE)
            assert canvas.evaluate(PICTURE) != before, f"{name}: {button.inner_text()}"
    assert page.faults == []
    if not times:
        return  # it has buttons alone
    with capsys.disabled():
        most, median = max(times), statistics.median(times)
        slow = "" if most < WANTED else "  slower than wanted"
        print(f"\n{path.stem:30} median {median:3.0f} ms, most {most:3.0f} ms{slow}", end="")

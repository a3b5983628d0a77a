"""How long from a key on a slider to the new picture, for every slider of every explorer.

    make latency

It opens a JupyterLab of its own with all explorers of the course in one notebook, and presses the
keys in a real Chromium. The time runs from the key to the frame after the canvas was painted. Where
it is above what is wanted, on a quiet machine, it says so and fails. `make bench` reads what it
found.
"""

import statistics

import pandas as pd

from arkaq_edu import widgets
from benchmarks.widgets import MEASURED
from tests.browser.reading import CLOCK, assert_sound

WANTED = {"median": 100, "p90": 150}  # ms
KEYS = ["Home", *["ArrowRight"] * 14, "End", *["ArrowLeft"] * 7, "PageDown", "PageUp"]

# A live robot goes at its own pace; `make live` counts its frames.
LIVE = {"robot", "robot-goal", "race", "walk"}
SHOWN = "(n) => times.length > n"


def test_every_slider_is_followed_in_time(open_cells, capsys):
    names = [name for name in widgets.EXPLORERS if name not in LIVE]
    made = [f'widgets.EXPLORERS["{name}"]()' for name in names]
    page = open_cells("from arkaq_edu import widgets", *made)
    assert_sound(page)
    slow, rows = [], []
    for i, name in enumerate(names):
        explorer = page.locator(".arkaq-explorer").nth(i)
        explorer.locator("canvas").evaluate(CLOCK)
        for slider in explorer.get_by_role("slider").filter(visible=True).all():
            times = [time for key in KEYS if (time := pressed(page, slider, key)) is not None]
            median, p90 = statistics.median(times), statistics.quantiles(times, n=10)[-1]
            told = slider.get_attribute("aria-label")
            row = f"{name:12} {told:24} median {median:4.0f} ms, p90 {p90:4.0f}, {len(times)} keys"
            missed = median > WANTED["median"] or p90 > WANTED["p90"]
            slow += [row] * missed
            rows.append({"explorer": name, "slider": told, "median": median, "p90": p90})
            with capsys.disabled():
                print(row, "  slower than wanted" * missed, flush=True)
    MEASURED.parent.mkdir(exist_ok=True)
    pd.DataFrame(rows).to_csv(MEASURED, index=False)
    assert not slow, "\n".join(slow)


def pressed(page, slider, key):
    """Press a key; return the time to the picture (ms), or None where the slider is at its end."""
    before, n = slider.get_attribute("aria-valuetext"), page.evaluate("times.length")
    slider.press(key)
    if slider.get_attribute("aria-valuetext") == before:
        return None
    page.wait_for_function(SHOWN, arg=n)
    return page.evaluate("times.at(-1)")

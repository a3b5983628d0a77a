"""The live robot for as long as a lesson, in a real JupyterLab.

    make live

It opens chapters 8 to 11 and counts the pictures a second of each live robot, moves the ball by
pointer, hides the page, watches a whole training, and lets a robot go for MINUTES. It takes some
ten minutes.
"""

import os
import re

import pytest
from playwright.sync_api import expect

from tests.browser.reading import assert_sound, errors
from tests.browser.test_live import ASK, CODE, RUN

MINUTES = float(os.environ.get("MINUTES", "3"))
GROWTH = 8  # MB that the page, or the kernel, may grow by in the second half of that time
CANVAS = ".arkaq-canvas:has(.arkaq-help) canvas"
MEMORY = "import gc, psutil; gc.collect(); print(psutil.Process().memory_info().rss)"
CHAPTERS = (
    "08_robot_and_field", "09_arkaq_learning", "10_ball_approaching", "11_scoring_goals",
)  # fmt: skip


def listen(page):
    """A list that will hold what goes wrong in the page."""
    problems = []
    page.on("pageerror", lambda error: problems.append(str(error)))
    page.on("console", lambda said: said.type == "error" and problems.append(said.text))
    return problems


def painted(canvas):
    return int(canvas.get_attribute("data-painted"))


def rate(page, canvas, seconds=4):
    """Pictures a second."""
    before = painted(canvas)
    page.wait_for_timeout(1000 * seconds)
    return (painted(canvas) - before) / seconds


@pytest.mark.parametrize("chapter", CHAPTERS)
def test_every_robot_of_a_chapter_goes(open_notebook, chapter, capsys):
    page = open_notebook(f"{chapter}.ipynb")
    problems = listen(page)
    assert errors(page) == []
    canvases = page.locator(CANVAS)
    assert canvases.count() >= 1
    for i in range(canvases.count()):
        canvas = canvases.nth(i)
        canvas.scroll_into_view_if_needed()
        canvas.press("Space")
        fact, told = canvas.get_attribute("aria-label"), rate(page, canvas)
        with capsys.disabled():
            print(f"\n{chapter}, robot {i}: {told:.0f} pictures a second", end="")
        expect(canvas).not_to_have_attribute("aria-label", fact)
        canvas.press("Space")
    page.wait_for_timeout(3000)  # each ends its cycle
    still = [painted(canvas) for canvas in canvases.all()]
    page.wait_for_timeout(2000)
    assert [painted(canvas) for canvas in canvases.all()] == still
    assert problems == []
    assert_sound(page)


def test_a_ball_dragged_by_the_pointer_is_seen_where_it_was_put(open_cells):
    where = "print(*[round(x) for x in robot.robots[0].ball])"
    page = open_cells(CODE, where)
    canvas = page.locator(CANVAS)
    expect(canvas).to_have_attribute("aria-label", re.compile("cycle 0"))
    box = canvas.bounding_box()
    field = 0.585 * (box["width"] - 10)  # as live.js plans it
    scale = field / 6000

    def place(x, y):
        return box["x"] + 5 + (x + 3000) * scale, box["y"] + 5 + (2000 - y) * scale

    x, y = map(int, page.evaluate(RUN, 1).split())
    page.mouse.move(*place(x, y))
    page.mouse.down()
    page.mouse.move(*place(-1000, 200), steps=8)
    page.mouse.up()
    page.wait_for_timeout(500)
    x, y = map(int, page.evaluate(RUN, 1).split())
    assert abs(x + 1000) < 60 and abs(y - 200) < 60
    canvas.press(".")
    expect(canvas).to_have_attribute("aria-label", re.compile("cycle 1: seen at 1,[34]"))


def test_a_hidden_page_asks_for_nothing_and_goes_on_when_shown(open_cells):
    page = open_cells(CODE, ASK)
    problems, canvas = listen(page), page.locator(CANVAS)
    expect(canvas).to_have_attribute("aria-label", re.compile("cycle 0"))
    canvas.press("Space")
    assert rate(page, canvas) > 5
    page.evaluate("jupyterapp.commands.execute('launcher:create')")  # in front of the notebook
    page.wait_for_timeout(1500)
    before = painted(canvas)
    page.wait_for_timeout(2000)
    assert painted(canvas) == before
    page.evaluate("""() => {
        const { shell } = window.jupyterapp;
        shell.activateById(Array.from(shell.widgets('main')).find((each) => each.context).id);
    }""")
    assert rate(page, canvas) > 5
    assert problems == []


def test_learning_is_watched_to_its_end(open_cells, capsys):
    page = open_cells(CODE.replace("live_robot()", "live_robot(driver='an agent that learns')"))
    canvas = page.locator(CANVAS)
    expect(canvas).to_have_attribute("aria-label", re.compile("segmentation, 1 of 6,500"))
    speed = page.get_by_role("slider", name="speed").filter(visible=True)
    speed.press("End")
    canvas.press("Space")
    expect(canvas).to_have_attribute("aria-label", re.compile("Q-learning"), timeout=300_000)
    expect(canvas).to_have_attribute("aria-label", re.compile("^cycle|^the ball"), timeout=900_000)
    speed.press("Home")
    assert_sound(page)
    with capsys.disabled():
        print("\nafter learning:", canvas.get_attribute("aria-label"))


def test_memory_stays_flat(open_cells, capsys):
    page = open_cells(CODE, MEMORY)
    session, canvas = page.context.new_cdp_session(page), page.locator(CANVAS)
    expect(canvas).to_have_attribute("aria-label", re.compile("cycle 0"))
    page.get_by_role("slider", name="speed").filter(visible=True).press("PageUp")
    canvas.press("Space")
    memory = []
    for _ in range(4):
        page.wait_for_timeout(MINUTES * 60_000 / 4)
        session.send("HeapProfiler.collectGarbage")
        heap = session.send("Runtime.getHeapUsage")["usedSize"]
        memory.append((heap / 1e6, int(page.evaluate(RUN, 1)) / 1e6))
    with capsys.disabled():
        told = ", ".join(f"{heap:.0f} and {kernel:.0f}" for heap, kernel in memory)
        print(f"\npage and kernel, four times in {MINUTES:g} minutes: {told} MB")
    for before, after in zip(memory[1], memory[-1], strict=True):
        assert after - before < GROWTH

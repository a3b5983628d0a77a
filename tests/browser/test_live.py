"""The live robot in a real browser: it goes, a hand moves the ball, and nothing is left of it."""

import re

from playwright.sync_api import expect

from tests.browser.reading import assert_sound, picture

CODE = "from arkaq_edu.widgets import live_robot\nrobot = live_robot()\nrobot"
ASK = "print('frame', robot.number)"
RUN = """async (i) => {
    const notebook = window.jupyterapp.shell.currentWidget;
    notebook.content.activeCellIndex = i;
    await window.jupyterapp.commands.execute('notebook:run-cell');
    const outputs = notebook.content.widgets[i].model.sharedModel.getOutputs();
    return outputs.map((output) => output.text).flat().join('');
}"""
DELETE = """async () => {
    window.jupyterapp.shell.currentWidget.content.activeCellIndex = 0;
    await window.jupyterapp.commands.execute('notebook:delete-cell');
}"""

CHANGED = "(drawn) => document.querySelector('.arkaq-canvas canvas').toDataURL() != drawn"


def test_goes_is_moved_and_stops(open_cells):
    page = open_cells(CODE, ASK)
    problems = []
    page.on("pageerror", lambda error: problems.append(str(error)))
    page.on("console", lambda said: said.type == "error" and problems.append(said.text))

    def frames(cell=1):
        return int(page.evaluate(RUN, cell).split()[-1])

    canvas = page.locator(".arkaq-canvas canvas")
    expect(canvas).to_have_attribute("aria-label", re.compile("cycle 0: seen at .*; state "))

    drawn = picture(canvas)
    canvas.focus()
    canvas.press("ArrowUp")  # the ball moves, in the field and in the camera's picture
    page.wait_for_function(CHANGED, arg=drawn)
    canvas.press(".")
    expect(canvas).to_have_attribute("aria-label", re.compile("cycle 1: "))

    canvas.press("Space")
    play = page.get_by_role("button", name="play", exact=True)
    expect(play).to_have_attribute("aria-pressed", "true")
    before, asked = int(canvas.get_attribute("data-painted")), frames()
    page.wait_for_timeout(2000)
    rate = (int(canvas.get_attribute("data-painted")) - before) / 2
    assert frames() > asked
    page.evaluate(DELETE)
    asked = frames(0)
    page.wait_for_timeout(1500)
    assert frames(0) == asked
    assert rate > 5, f"{rate} pictures a second"  # 30 and more where the machine is not busy
    assert problems == []
    assert_sound(page)

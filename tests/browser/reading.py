"""What every browser test reads from an open notebook."""

import re

BROKEN = re.compile("model not found|error displaying widget|error creating widget", re.IGNORECASE)
OUTPUTS = """() => {
    const { model } = window.jupyterapp.shell.currentWidget.content;
    return Array.from(model.cells).flatMap((cell) => cell.sharedModel.getOutputs?.() ?? []);
}"""


def errors(page):
    """The outputs of the open notebook that are errors."""
    return [o for o in page.evaluate(OUTPUTS) if o["output_type"] == "error"]


def slider_of(page, name):
    """The visible slider of that name, and the number beside it."""
    row = page.locator(".widget-hslider", has_text=name).filter(visible=True)
    return row.get_by_role("slider"), row.locator(".widget-readout")


def picture(canvas):
    """The pixels of a canvas, as text."""
    return canvas.evaluate("(canvas) => canvas.toDataURL()")


def assert_sound(page):
    """Fail where a widget shows an error, or is none."""
    assert page.get_by_role("alert").filter(visible=True).count() == 0
    assert BROKEN.search(page.inner_text("body")) is None

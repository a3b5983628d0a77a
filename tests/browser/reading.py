"""What every browser test reads from an open notebook."""

import re

BROKEN = re.compile("model not found|error displaying widget|error creating widget", re.IGNORECASE)
OUTPUTS = """() => {
    const { model } = window.jupyterapp.shell.currentWidget.content;
    return Array.from(model.cells).flatMap((cell) => cell.sharedModel.getOutputs?.() ?? []);
}"""
# The clock of an element starts at a key and stops in the frame that shows what a canvas in it was
# given: then its label has changed.
CLOCK = """(element) => {
    window.times = [];
    let pressed = null;
    document.addEventListener("keydown", () => { pressed = performance.now(); }, true);
    new MutationObserver(() => {
        if (pressed === null) return;
        const since = pressed;
        pressed = null;
        requestAnimationFrame(() => setTimeout(() => times.push(performance.now() - since)));
    }).observe(element, { subtree: true, attributes: true, attributeFilter: ["aria-label"] });
}"""


def errors(page):
    """The outputs of the open notebook that are errors."""
    return [o for o in page.evaluate(OUTPUTS) if o["output_type"] == "error"]


def slider_of(place, name):
    """The visible slider of that name in a page or a cell, and the number beside it."""
    row = place.locator(".widget-hslider", has_text=name).filter(visible=True)
    return row.get_by_role("slider"), row.locator(".widget-readout")


def picture(canvas):
    """The pixels of a canvas, as text."""
    return canvas.evaluate("(canvas) => canvas.toDataURL()")


def assert_sound(place):
    """Fail where a widget of a page or a cell shows an error, or is none."""
    assert place.get_by_role("alert").filter(visible=True).count() == 0
    assert place.get_by_text(BROKEN).filter(visible=True).count() == 0

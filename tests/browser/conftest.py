"""A JupyterLab on a copy of the course, and a real Chromium in front of it."""

import json
import os
import shutil
import socket
import subprocess
import sys
import time
import uuid
from contextlib import contextmanager
from pathlib import Path
from urllib.error import URLError
from urllib.request import urlopen

import nbformat
import pytest
from nbformat.v4 import new_code_cell, new_notebook

from tests.browser.reading import errors

NOTEBOOKS = Path(__file__).parents[2] / "notebooks"
CHROMIUM = next(filter(None, map(shutil.which, ("chromium", "chromium-browser", "chrome"))), None)
QUIET = (
    "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run", "--disable-sync",
    "--disable-background-networking", "--disable-component-update",
)  # fmt: skip
PATIENCE = 120  # seconds; only a broken page, or a machine on its knees, takes so long
SETTINGS = {
    "apputils-extension/notification": {"fetchNews": "false", "checkForUpdates": False},
    # Every cell is in the page, whether it is in view or not.
    "notebook-extension/tracker": {"windowingMode": "none"},
}


def pytest_collection_modifyitems(items):
    for item in items:
        if Path(__file__).parent in item.path.parents:
            item.add_marker("browser")
            if CHROMIUM is None:
                item.add_marker(pytest.mark.skip(reason="needs Chromium, and finds none on PATH"))


@pytest.fixture(scope="session")
def course(tmp_path_factory):
    """A folder with a copy of the notebooks."""
    folder = tmp_path_factory.mktemp("lab") / "course"
    shutil.copytree(NOTEBOOKS, folder, ignore=shutil.ignore_patterns(".*", "__pycache__"))
    return folder


@pytest.fixture(scope="session")
def desk(course, lab, chromium):
    """A notebook in a window of its own, on which the tests of a worker lay their cells."""
    nbformat.write(notebook_of([]), course / "desk.ipynb")
    with opening(lab, chromium) as open_:
        yield open_("desk.ipynb", run=False)


@pytest.fixture
def run_cell(desk):
    """A function that runs a new cell of code, by itself, and returns its place in the page."""

    def run(code):
        desk.evaluate(RUN_NEW, code)
        assert errors(desk) == []
        return desk.locator(".jp-Notebook .jp-CodeCell").nth(desk.evaluate(N_CELLS) - 1)

    yield run
    desk.evaluate(CLEAR)


@pytest.fixture
def open_cells(course, open_notebook):
    """A function that opens a notebook with these cells of code, runs it, returns the page."""

    def open_(*cells, **options):
        nbformat.write(notebook_of(cells), course / "cells.ipynb")
        return open_notebook("cells.ipynb", **options)

    return open_


def notebook_of(cells):
    """A notebook with these cells of code."""
    return new_notebook(
        cells=[new_code_cell(code) for code in cells],
        metadata={"kernelspec": {"display_name": "Python 3", "name": "python3"}},
    )


@pytest.fixture(scope="session")
def lab(course):
    """The address of a JupyterLab that knows nothing of this user's files and settings."""
    home = course.parent
    command = [
        sys.executable, "-m", "jupyterlab", "--no-browser", "--allow-root",
        f"--ServerApp.root_dir={course}",
    ]  # fmt: skip
    with serving(command, home, course) as address:
        yield address


@contextmanager
def serving(command, home, folder, **variables):
    """The address of what a command that starts JupyterLab in a folder serves."""
    for name, values in SETTINGS.items():
        file = home / "settings" / "@jupyterlab" / f"{name}.jupyterlab-settings"
        file.parent.mkdir(parents=True)
        file.write_text(json.dumps(values))
    (home / "config").mkdir()
    (home / "config" / "jupyter_lab_config.py").write_text(
        "c.ServerApp.ip = '127.0.0.1'\nc.ServerApp.port_retries = 0\n"
        "c.LabApp.expose_app_in_browser = True\n"
    )
    folders = {
        "IPYTHONDIR": "ipython", "JUPYTERLAB_SETTINGS_DIR": "settings",
        "JUPYTERLAB_WORKSPACES_DIR": "workspaces", "JUPYTER_CONFIG_DIR": "config",
        "JUPYTER_DATA_DIR": "data", "JUPYTER_RUNTIME_DIR": "runtime",
    }  # fmt: skip
    with socket.create_server(("127.0.0.1", 0)) as probe:
        port = probe.getsockname()[1]
    token = uuid.uuid4().hex
    environment = (
        os.environ
        | {name: str(home / place) for name, place in folders.items()}
        | {"JUPYTER_PORT": str(port), "JUPYTER_TOKEN": token}
        | variables
    )
    log = (home / "lab.log").open("w+")
    server = subprocess.Popen(command, cwd=folder, env=environment, stdout=log, stderr=log)
    try:
        _wait_for(f"http://127.0.0.1:{port}/api/status?token={token}", server, log)
        yield f"http://127.0.0.1:{port}/lab/workspaces/{{workspace}}/tree/{{path}}?token={token}"
    finally:
        server.terminate()
        server.wait(PATIENCE)
        log.close()


def _wait_for(address, server, log):
    deadline = time.monotonic() + PATIENCE
    while time.monotonic() < deadline and server.poll() is None:
        try:
            with urlopen(address, timeout=5):
                return
        except (URLError, TimeoutError, ConnectionError):
            time.sleep(0.2)
    log.seek(0)
    pytest.fail(f"JupyterLab did not come up:\n{log.read()[-3000:]}")


@pytest.fixture(scope="session")
def chromium():
    """A running Chromium."""
    from playwright.sync_api import expect, sync_playwright

    expect.set_options(timeout=1000 * PATIENCE)
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=CHROMIUM, args=QUIET)
        yield browser
        browser.close()


@pytest.fixture
def open_notebook(lab, chromium):
    """A function that opens a notebook of the course in a window, runs it, returns the page.

    Options are those of a window: ``viewport``, ``device_scale_factor``.
    """
    with opening(lab, chromium) as open_:
        yield open_


@contextmanager
def opening(address, chromium):
    """A function that opens the notebooks which JupyterLab serves."""
    windows = []

    def open_(name, *, run=True, **options):
        options = {"viewport": {"width": 1280, "height": 1000}, **options}
        window = chromium.new_context(**options)
        windows.append(window)
        window.set_default_timeout(1000 * PATIENCE)
        page = window.new_page()
        page.goto(address.format(workspace=uuid.uuid4().hex, path=name))
        page.evaluate(READY)
        if run:
            page.evaluate(RUN_ALL)
        return page

    yield open_
    for window in windows:
        window.pages[0].evaluate(SHUT_DOWN)
        window.close()


RUN_ALL = "jupyterapp.commands.execute('notebook:run-all-cells')"
N_CELLS = "jupyterapp.shell.currentWidget.content.widgets.length"
RUN_NEW = """async (code) => {
    const { content } = jupyterapp.shell.currentWidget;
    content.model.sharedModel.addCell({ cell_type: "code", source: code });
    content.activeCellIndex = content.widgets.length - 1;
    await jupyterapp.commands.execute("notebook:run-cell");
}"""
CLEAR = """() => {
    const { content } = jupyterapp.shell.currentWidget;
    content.model.sharedModel.deleteCellRange(0, content.widgets.length);
}"""
READY = """async () => {
    const soon = () => new Promise((done) => setTimeout(done, 50));
    while (!window.jupyterapp) await soon();
    await jupyterapp.restored;
    while (!jupyterapp.shell.currentWidget?.context) await soon();
    await jupyterapp.shell.currentWidget.context.ready;
    await jupyterapp.shell.currentWidget.sessionContext.ready;
}"""
SHUT_DOWN = "() => window.jupyterapp?.shell.currentWidget?.sessionContext?.shutdown()"

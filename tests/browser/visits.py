"""`arkaq explore` in a real Chromium: one's own csv, and fifty visits that leave nothing behind.

    make visits

It needs Voila, and takes some minutes.
"""

import re
import socket
import subprocess
import sys
import time
from urllib.error import URLError
from urllib.request import urlopen

import psutil
import pytest
from playwright.sync_api import expect

from arkaq_edu.widgets import EXPLORERS
from tests.browser.conftest import PATIENCE
from tests.browser.reading import BROKEN

pytest.importorskip("voila")

VISITS = 50
GROWTH = 20  # MB that the server may have grown by after the first ten visits


@pytest.fixture(scope="module")
def server(tmp_path_factory):
    """A running `arkaq explore`, as a process, with its address."""
    with socket.create_server(("127.0.0.1", 0)) as probe:
        port = probe.getsockname()[1]
    log = tmp_path_factory.mktemp("explore") / "log"
    command = [sys.executable, "-m", "arkaq_edu.cli", "explore", "--no-browser", f"--port={port}"]
    with log.open("w") as file, subprocess.Popen(command, stdout=file, stderr=file) as process:
        process.address = f"http://127.0.0.1:{port}/"
        deadline = time.monotonic() + PATIENCE
        while time.monotonic() < deadline and process.poll() is None:
            try:
                urlopen(f"{process.address}voila/static/main.js", timeout=1).close()
            except (URLError, ConnectionError, TimeoutError) as error:
                if getattr(error, "code", None):  # any answer is one
                    break
                time.sleep(0.2)
            else:
                break
        yield process
        process.terminate()
        process.wait(PATIENCE)


@pytest.fixture
def page(chromium):
    window = chromium.new_context(viewport={"width": 1600, "height": 1000})
    window.set_default_timeout(1000 * PATIENCE)
    page = window.new_page()
    page.problems = []
    page.on("pageerror", lambda error: page.problems.append(str(error)))
    yield page
    page.goto("about:blank")
    window.close()


def kernels(server):
    return [child for child in psutil.Process(server.pid).children() if child.is_running()]


def visit(page, server, query=""):
    page.goto(server.address + query)
    canvas = page.locator(".arkaq-canvas canvas").first
    expect(canvas).to_be_visible()
    return canvas


def test_own_csv_and_a_link_that_comes_back(page, server, tmp_path):
    canvas = visit(page, server)
    expect(canvas).to_have_attribute("aria-label", re.compile("at vigilance 0.15"))
    assert "read_patterns" not in page.inner_text("body") and "visit(" not in page.content()
    csv = tmp_path / "flowers.csv"
    rows = [f"{i % 7 + 0.1 * (i % 3)},{i % 5 + 0.2 * (i % 4)}" for i in range(400)]
    csv.write_text("\n".join(["length (cm),width (cm)", *rows]))
    page.locator("input[type=file]").set_input_files(csv)
    expect(canvas).not_to_have_attribute("aria-label", re.compile("thesis"))
    slider = page.get_by_role("slider", name="vigilance").filter(visible=True)
    slider.press("End")
    expect(canvas).to_have_attribute("aria-label", re.compile("at vigilance 0.2;"))
    n = int(canvas.get_attribute("aria-label").split()[0])
    with page.expect_download() as download:
        page.get_by_role("button", name="download the centers").click()
    lines = download.value.path().read_text().splitlines()
    assert lines[0] == "length (cm),width (cm)" and len(lines) == n + 1
    bad = tmp_path / "words.csv"
    bad.write_text("one\ntwo\n")
    page.locator("input[type=file]").set_input_files(bad)
    expect(page.get_by_role("alert")).to_contain_text("must be two columns of numbers")

    canvas = visit(page, server, "?explorer=kalman")
    page.get_by_role("slider", name="dropout").press("PageUp")
    expect(page).to_have_url(re.compile("dropout=0.[1-9]"))
    fact, link = canvas.get_attribute("aria-label"), page.url
    page.goto("about:blank")
    page.goto(link)
    expect(page.locator(".arkaq-canvas canvas")).to_have_attribute("aria-label", fact)
    assert page.problems == []


def test_every_explorer_opens_by_name(page, server):
    for name in EXPLORERS:
        visit(page, server, f"?explorer={name}")
        assert BROKEN.search(page.inner_text("body")) is None
        assert page.locator("nav [aria-current]").inner_text() == name
    assert page.problems == []


def test_the_robot_goes_and_its_kernel_goes_too(page, server):
    canvas = visit(page, server, "?explorer=robot&speed=4.0")
    canvas.press("Space")
    expect(canvas).to_have_attribute("aria-label", re.compile("cycle [1-9]"))
    page.goto("about:blank")
    deadline = time.monotonic() + 30
    while kernels(server) and time.monotonic() < deadline:
        time.sleep(0.2)
    assert not kernels(server) and page.problems == []


def test_fifty_visits_leave_no_kernel(page, server, capsys):
    memory = []
    for _ in range(VISITS):
        visit(page, server, "?explorer=value")
        page.goto("about:blank")
        memory.append(psutil.Process(server.pid).memory_info().rss / 1e6)
    deadline = time.monotonic() + 30
    while kernels(server) and time.monotonic() < deadline:
        time.sleep(0.2)
    with capsys.disabled():
        told = " ".join(f"{memory[i]:.0f}" for i in (0, 9, VISITS // 2, VISITS - 1))
        print(f"\nserver's memory after visit 1, 10, 25, 50: {told} MB; kernels left: ", end="")
        print(len(kernels(server)))
    assert not kernels(server)
    assert memory[-1] - memory[9] < GROWTH

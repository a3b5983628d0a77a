"""Ctrl-C at every moment of the command: one line and status 130."""

import pytest

from tests.soak.command import stopped, without_bars

INTERRUPTED = (130, ["arkaq: interrupted"])


@pytest.mark.parametrize("seconds", [0.05, 0.1, 0.4, 1.0])
def test_ctrl_c_in_the_first_moments(tmp_path, seconds):
    ended = stopped(["train"], tmp_path, seconds)
    assert (ended.status, without_bars(ended.said)) == INTERRUPTED


def test_ctrl_c_while_a_kernel_is_compiled(tmp_path):
    ended = stopped(["train"], tmp_path, 2.5, NUMBA_CACHE_DIR=str(tmp_path / "cache"))
    assert (ended.status, without_bars(ended.said)) == INTERRUPTED
    # The system lets a lock go with its process, so its empty file may stay.
    left = [p.name for p in tmp_path.iterdir() if p.name.startswith(".") and p.suffix != ".lock"]
    assert left == []


PROGRAM = """
import os, signal, sys, time
import click
from arkaq_edu import _interrupts, cli

_interrupts.SECONDS_TO_CLEAN_UP = 0.3

def ctrl_c():
    signal.raise_signal(signal.SIGINT)

class Finalized:
    def __del__(self):
        ctrl_c()

@click.group(cls=cli.OneLineErrors)
def main():
    pass

@main.command()
def plain():
    ctrl_c()

@main.command()
def swallowed():
    try:
        ctrl_c()
    except BaseException:
        time.sleep(60)

@main.command()
def altered():
    try:
        ctrl_c()
    except BaseException:
        raise ImportError("initialization failed") from None

@main.command()
def finalized():
    Finalized()
    time.sleep(60)

@main.command()
def imported():
    sys.path.insert(0, os.getcwd())
    import careless

os.write(1, b"x")
main()
"""


@pytest.mark.parametrize("case", ["plain", "swallowed", "altered", "finalized", "imported"])
def test_ctrl_c_is_not_swallowed(tmp_path, case):
    (tmp_path / "careless.py").write_text(
        "import signal, time\ntry:\n    signal.raise_signal(signal.SIGINT)\n"
        "except BaseException:\n    time.sleep(60)\n"
    )
    ended = stopped([case], tmp_path, 0, None, program=PROGRAM)
    assert (ended.status, without_bars(ended.said)) == INTERRUPTED


def test_without_an_interrupt_what_complains_is_heard(tmp_path):
    program = PROGRAM.replace("        ctrl_c()\n\n@click.group", "        1 / 0\n\n@click.group")
    ended = stopped(
        ["finalized"], tmp_path, 0, None, program=program.replace("sleep(60)", "sleep(0)")
    )
    assert ended.status == 0 and "ZeroDivisionError" in ended.said

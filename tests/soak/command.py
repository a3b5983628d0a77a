"""The arkaq command in a process of its own, stopped at a moment."""

import os
import signal
import subprocess
import sys
import time
from pathlib import Path
from typing import NamedTuple

ROOT = Path(__file__).parents[2]
#: How much of the long runs: SOAK=0.05 makes a twentieth of the steps, kills and interrupts.
SHARE = float(os.environ.get("SOAK", "1"))
#: The command says when it is there: what happens before is Python's own.
PROGRAM = """
import os, sys
from arkaq_command import main
os.write(1, b"x")
main()
"""


class Ended(NamedTuple):
    """How a command ended: its status (None: it had to be killed), and what it said."""

    status: int | None
    said: str


def stopped(words, cwd, seconds, how=signal.SIGINT, patience=30, program=PROGRAM, **environment):
    """Run the command in a group of its own and send the whole group a signal, as a terminal does.

    With `how` None it is left to end by itself.
    """
    process = subprocess.Popen(
        [sys.executable, "-c", program, *(str(word) for word in words)],
        cwd=cwd,
        env={**os.environ, "PYTHONPATH": str(ROOT), **environment},
        stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
        start_new_session=True,
    )  # fmt: skip
    process.stdout.read(1)
    if how is not None:
        time.sleep(seconds)
        os.killpg(process.pid, how)
    try:
        said = process.communicate(timeout=patience)[1].decode()
    except subprocess.TimeoutExpired:
        os.killpg(process.pid, signal.SIGKILL)
        return Ended(None, process.communicate()[1].decode())
    return Ended(process.returncode, said)


def without_bars(said):
    """The lines on standard error that are not progress bars."""
    return [
        line for line in said.replace("\r", "\n").splitlines() if line.strip() and "|" not in line
    ]

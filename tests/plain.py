"""A pytest plugin, ``-p tests.plain``, that skips what takes long without compiled kernels."""

import signal
from pathlib import Path

import pytest

LONG = 5.0  # seconds of work


@pytest.hookimpl(wrapper=True)
def pytest_runtest_call():
    def late(_, frame):
        if "coverage" in Path(frame.f_code.co_filename).parts:
            signal.setitimer(signal.ITIMER_VIRTUAL, 0.01)  # it may hold a lock just now
        else:
            pytest.skip("takes long as plain Python")

    before = signal.signal(signal.SIGVTALRM, late)
    signal.setitimer(signal.ITIMER_VIRTUAL, LONG)
    try:
        return (yield)
    finally:
        signal.setitimer(signal.ITIMER_VIRTUAL, 0)
        signal.signal(signal.SIGVTALRM, before)

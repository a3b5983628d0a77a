"""Where the ``arkaq`` command starts: it minds Ctrl-C before anything slow is imported."""

import os
import signal


def _leave(*_: object) -> None:
    """End the process: nothing has begun yet, and an import may swallow an exception."""
    os.write(2, b"\narkaq: interrupted\n")
    os._exit(130)


def main() -> None:
    """Run the command line."""
    signal.signal(signal.SIGINT, _leave)
    from arkaq_edu.cli import main

    main()

"""Run every benchmark: ``python -m benchmarks`` (or ``make bench``)."""

import subprocess
import sys
from pathlib import Path

scripts = sorted(Path(__file__).parent.glob("bench_*.py"))
failed = [script.name for script in scripts if subprocess.call([sys.executable, str(script)])]
sys.exit(f"failed: {', '.join(failed)}" if failed else 0)

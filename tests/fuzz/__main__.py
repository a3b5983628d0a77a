"""Fuzz the readers, guided by what their code does with each input.

``python -m tests.fuzz [SECONDS [TARGET ...]]`` needs atheris; ``make fuzz`` gets it. What fails
is kept in ``build/fuzz`` under a name with "crash", "timeout" or "oom"; turn it into a test.
"""

import importlib
import os
import subprocess
import sys
import tempfile
from pathlib import Path

FOLDER = Path("build/fuzz")
READERS = [
    "arkaq_edu.pomdp.cassandra", "arkaq_edu.pomdp.tables", "arkaq_edu.pomdp.files",
    "arkaq_edu.arkaq.storage", "arkaq_edu.experiments.studies",
]  # fmt: skip
MEGABYTES = 1024  # more memory than this for one small file is a fault


def fuzz(name: str, seconds: str) -> None:
    """Fuzz one target in this process."""
    import atheris

    modules = [
        ".".join(path.with_suffix("").parts).removesuffix(".__init__")
        for path in Path("arkaq_edu").rglob("*.py")
    ]
    others = [name for name in modules if name not in READERS]  # numba knows no probes
    with atheris.instrument_imports(include=["arkaq_edu"], exclude=others):
        for reader in READERS:
            importlib.import_module(reader)
    from tests.fuzz import targets

    corpus, words = FOLDER / name, FOLDER / f"{name}.words"
    corpus.mkdir(parents=True, exist_ok=True)
    for i, seed in enumerate(targets.SEEDS[name]()):
        (corpus / f"seed-{i}").write_bytes(seed)
    coded = ["".join(f"\\x{byte:02x}" for byte in word.encode("latin-1"))
             for word in targets.WORDS[name]]  # fmt: skip
    words.write_text("".join(f'"{word}"\n' for word in coded))
    with tempfile.TemporaryDirectory() as folder:
        target, place = targets.TARGETS[name], Path(folder)
        options = [
            f"-max_total_time={seconds}", f"-dict={words}", f"-artifact_prefix={FOLDER}/{name}-",
            f"-rss_limit_mb={MEGABYTES}", "-timeout=20", "-max_len=20000", "-print_final_stats=1",
        ]  # fmt: skip
        atheris.Setup([name, str(corpus), *options], lambda data: target(data, place))
        atheris.Fuzz()


def main(seconds: str = "180", *names: str) -> int:
    """Fuzz each target in a process of its own; return how many failed."""
    if os.environ.get("FUZZ_TARGET"):
        fuzz(os.environ["FUZZ_TARGET"], seconds)
    from tests.fuzz.targets import TARGETS  # only now: what is loaded already gets no probes

    failed = 0
    for name in names or TARGETS:
        command = [sys.executable, "-m", "tests.fuzz", seconds]
        failed += subprocess.run(command, env={**os.environ, "FUZZ_TARGET": name}).returncode != 0
    return failed


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))

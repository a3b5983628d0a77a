"""Kill a command at random moments until it is done; what is whole stays whole."""

import hashlib
import random
import signal
import zipfile
from pathlib import Path

from arkaq_edu.arkaq import Arkaq
from tests.soak.command import stopped


def contents(folder: Path) -> dict[str, str]:
    """The digest of each file that a command leaves, without hidden ones: those of the killed."""
    return {
        path.relative_to(folder).as_posix(): hashlib.sha256(path.read_bytes()).hexdigest()
        for path in sorted(folder.rglob("*"))
        if path.is_file() and not path.name.startswith(".")
    }


def broken(folder: Path) -> list[str]:
    """The files that are not whole."""
    found = []
    for name in contents(folder):
        path = folder / name
        try:
            if path.suffix == ".npz":
                Arkaq.load(path)
            assert path.stat().st_size > 0
            assert path.suffix != ".html" or path.read_text().rstrip().endswith("</html>")
        except (ValueError, AssertionError, zipfile.BadZipFile) as error:
            found.append(f"{name}: {error}")
    return found


def killed_until_done(words, folder, *, kills, longest, seed=0, **options):
    """Run a command, kill it so many times, then let it end; return how many it was hit."""
    moments, hits = random.Random(seed), 0
    folder.mkdir(exist_ok=True)
    for _ in range(kills):
        ended = stopped(words, folder, moments.uniform(0.5, longest), signal.SIGKILL, **options)
        hits += ended.status == -signal.SIGKILL
        assert broken(folder) == []
    ended = stopped(words, folder, 0, None, patience=3600, **options)
    assert ended.status == 0, ended.said
    return hits

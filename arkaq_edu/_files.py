"""The one way to write a file: whole or not at all."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path


@contextmanager
def replacing(path: str | os.PathLike[str]) -> Iterator[Path]:
    """Yield the name of a new file, which takes the place of `path` when the block has ended.

    If the block fails, or is interrupted, the new file is removed and `path` is as it was. The new
    file has a name of its own, so two writers never share one. It ends like `path`, since many
    libraries choose the format by the ending.

    Parameters
    ----------
    path : path
        The file to write. Its folder is made if it does not exist.

    Raises
    ------
    OSError
        If the folder cannot be written to, or the disk is full.

    Examples
    --------
    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     file = Path(folder) / "facts.txt"
    ...     with replacing(file) as fresh:
    ...         _ = fresh.write_text("old")
    ...     try:
    ...         with replacing(file) as fresh:
    ...             _ = fresh.write_text("half of the new")
    ...             raise KeyboardInterrupt
    ...     except KeyboardInterrupt:
    ...         print(file.read_text(), len(os.listdir(folder)))
    old 1
    """
    path = Path(path)
    path.parent.mkdir(parents=True, exist_ok=True)
    handle, name = tempfile.mkstemp(path.suffix, f".{path.stem}-", path.parent)
    fresh = Path(name)
    try:
        os.close(handle)
        fresh.chmod(path.stat().st_mode & 0o777 if path.exists() else 0o666 & ~_umask())
        yield fresh
        with open(fresh, "rb+") as file:
            os.fsync(file.fileno())  # else a power cut could leave an empty file under `path`
        fresh.replace(path)
    finally:
        fresh.unlink(missing_ok=True)


def _umask() -> int:
    """Return the user's mask for new files, which mkstemp leaves out of account."""
    mask = os.umask(0)
    os.umask(mask)
    return mask

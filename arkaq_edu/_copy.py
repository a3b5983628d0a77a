"""A student's own copy of the course, in which nothing of theirs is ever written over."""

from __future__ import annotations

import hashlib
import json
from dataclasses import dataclass, field
from pathlib import Path

from arkaq_edu import __version__
from arkaq_edu._files import replacing
from arkaq_edu._paths import HANDED_OUT, course_files, course_folder
from arkaq_edu._student import students_page


@dataclass
class Copied:
    """What a call of `copy_course` has done, by the names of the files.

    Attributes
    ----------
    new : list of str
        Files that were not there.
    renewed : list of str
        Files that were as handed out, and are now as the course has them.
    beside : dict of str to str
        Files that the student has changed and the course has changed too: they stay, and the
        course's new ones have these names.
    own : list of str
        Files that only the student has changed.
    same : list of str
        Files that are as the course has them.
    """

    new: list[str] = field(default_factory=list)
    renewed: list[str] = field(default_factory=list)
    beside: dict[str, str] = field(default_factory=dict)
    own: list[str] = field(default_factory=list)
    same: list[str] = field(default_factory=list)

    def __str__(self) -> str:
        kept = [*self.own, *self.beside]
        there = len(self.renewed) + len(kept) + len(self.same)
        if not there:
            return f"{_files(len(self.new))} copied; what you write in them is never written over"
        facts = [f"{_files(len(self.new))} copied"] if self.new else []
        facts += [f"{_files(len(self.renewed))} brought up to date"] if self.renewed else []
        if not facts and not self.beside:
            facts = [f"nothing new: {_files(there)} {'is' if there == 1 else 'are'} there"]
        facts += [f"{_files(len(kept))} changed by you and kept"] if kept else []
        news = [
            f"\n  {name} has a new version. Yours stays as it is; the new one is {fresh}"
            for name, fresh in self.beside.items()
        ]
        return ", ".join(facts) + "".join(news)


def _files(n: int) -> str:
    return f"{n} file{'s' * (n != 1)}"


def course_pages() -> dict[str, bytes]:
    """Return the files of the course as a student gets them, by their names."""
    source = course_folder()
    return {
        file.relative_to(source).as_posix(): (
            students_page(file.read_text("utf-8")).encode()
            if file.suffix == ".ipynb"
            else file.read_bytes()
        )
        for part in ("notebooks", "data")
        for file in course_files(source / part)
    }


def copy_course(folder: Path | str) -> Copied:
    """Bring a student's copy of the course up to date without losing anything of theirs.

    Parameters
    ----------
    folder : path
        It is created if it does not exist. A file in it remembers what was handed out.

    Examples
    --------
    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     first = copy_course(folder)
    ...     page = Path(folder, "notebooks", "00_start_here.ipynb")
    ...     _ = page.write_text("my answer")
    ...     again = copy_course(folder)
    >>> "notebooks/00_start_here.ipynb" in first.new, again.new, again.own
    (True, [], ['notebooks/00_start_here.ipynb'])
    """
    folder, done = Path(folder), Copied()
    before = _handed_out(folder)
    pages = course_pages()
    for name, content in pages.items():
        target, hash_ = folder / name, _hash(content)
        if not target.exists():
            done.new.append(name)
        elif (there := _hash(target.read_bytes())) == hash_:
            done.same.append(name)
            continue
        elif there == before.get(name):
            done.renewed.append(name)
        elif hash_ == before.get(name):
            done.own.append(name)
            continue
        else:
            target = _free(target)
            done.beside[name] = target.relative_to(folder).as_posix()
        with replacing(target) as fresh:
            fresh.write_bytes(content)
    now = {name: _hash(content) for name, content in pages.items()}
    with replacing(folder / HANDED_OUT) as fresh:
        fresh.write_text(json.dumps({"version": __version__, "files": now}, indent=1), "utf-8")
    return done


def _handed_out(folder: Path) -> dict[str, str]:
    """Return the hashes of the files as they were handed out last."""
    try:
        return json.loads((folder / HANDED_OUT).read_text("utf-8"))["files"]
    except FileNotFoundError:
        return {}
    except (ValueError, LookupError, TypeError):
        raise ValueError(
            f"{folder / HANDED_OUT} cannot be read; delete it, and each page that you have "
            "changed gets the course's own beside it"
        ) from None


def _free(target: Path) -> Path:
    """Return a name beside `target` that is not taken."""
    names = (f"{target.stem}_new{n or ''}{target.suffix}" for n in range(1000))
    return next(path for path in map(target.with_name, names) if not path.exists())


def _hash(content: bytes) -> str:
    return hashlib.sha256(content).hexdigest()

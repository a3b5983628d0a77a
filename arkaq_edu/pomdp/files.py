"""Models from files in Cassandra's .POMDP format, models into such files, and the course's own."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from arkaq_edu._paths import course_folder, write_whole
from arkaq_edu.pomdp.cassandra import (
    MOST_BYTES,
    PREAMBLE,
    RESERVED,
    WORD,
    PomdpFormatError,
    Reader,
)
from arkaq_edu.pomdp.model import POMDP


def read_pomdp(path: Path | str) -> POMDP:
    """Read a POMDP from a file in Cassandra's format.

    Parameters
    ----------
    path : path
        The file.

    Returns
    -------
    POMDP
        Costs (``values: cost``) become rewards below zero. A reward that depends on the next state
        and on the observation becomes the one expected: R(s, a) = sum_t T(a, s, t) sum_z O(a, t, z)
        R(a, s, t, z). A file without observations, an MDP, becomes a POMDP that sees its state.

    Raises
    ------
    PomdpFormatError
        If the file is not as the format has it, a row of probabilities does not sum to 1, or the
        discount is outside [0, 1); with the line and the column, and what was expected there.
    OSError
        If there is no such file, or it may not be read.

    Notes
    -----
    The format: a file begins, in any order, with ``discount: 0.95``, ``values: reward`` (or
    ``cost``), and ``states:``, ``actions:`` and ``observations:``, each followed by names or by a
    count. Then, if not uniform, comes the belief at the start: ``start:`` with one probability per
    state, with ``uniform`` or with one state; ``start include:`` or ``start exclude:`` with states.
    The rest are entries of T(a, s, t), O(a, t, z) and R(a, s, t, z), such as

    =============================  ===========================================================
    ``T: listen : left : left 1``  one entry
    ``T: listen : left``           a row: as many numbers, ``uniform`` or ``reset`` (the start)
    ``T: listen``                  a matrix: its numbers row by row, ``uniform`` or ``identity``
    =============================  ===========================================================

    Likewise ``O`` (with ``uniform`` only) and ``R`` (numbers only; from one entry to a matrix over
    the next state and the observation). States, actions and observations go by name or by number,
    from 0; ``*`` is all of them. What is not given is 0; what is given twice, the later counts. A
    ``#`` begins a comment. Blanks and the ends of lines only separate.

    Rows whose sum is within 1e-4 of 1, as printed decimals leave them, are divided by it. Refused
    because no table for them would fit: a file above 128 MiB, more than 65,536 states, actions or
    observations, and a table of more than 2^24 entries (R grows to four dimensions only where it
    depends on all four).

    A discount of 1 is in the format, but has no finite value over a future without end: it is
    refused. Put one below 1, such as 0.999, in its place.

    References
    ----------
    A. Cassandra, "POMDP file format", pomdp.org; its grammar is that of pomdp-solve.

    Examples
    --------
    >>> from arkaq_edu._paths import data_file
    >>> pomdp = read_pomdp(data_file("pomdp/tiger.pomdp"))
    >>> pomdp
    POMDP(2 states, 3 actions, 2 observations, gamma=0.95)
    >>> pomdp.R
    array([[  -1., -100.,   10.],
           [  -1.,   10., -100.]])
    """
    if (size := Path(path).stat().st_size) > MOST_BYTES:
        raise PomdpFormatError(f"expected at most {MOST_BYTES} bytes, got {size}", str(path), 1, 1)
    # What is no UTF-8 can stand in comments alone, and nobody reads those here.
    text = Path(path).read_text(encoding="utf-8-sig", errors="replace")
    return Reader(str(path), text).model()


def problem(name: str) -> POMDP:
    """Return one of the course's own POMDPs, read from its file in ``data/pomdp``.

    Parameters
    ----------
    name : str
        The name of the file, without its ending.

    Returns
    -------
    POMDP

    Raises
    ------
    ValueError
        If there is none of that name; the message names those there are.

    Examples
    --------
    >>> problem("corridor").states
    ('first', 'second', 'goal', 'fourth')
    >>> problem("chess")  # doctest: +ELLIPSIS
    Traceback (most recent call last):
    ValueError: name must be one of ball_side, corridor, ..., got 'chess'
    """
    files = {path.stem: path for path in sorted(course_folder().glob("data/pomdp/*.pomdp"))}
    if name not in files:
        raise ValueError(f"name must be one of {', '.join(files)}, got {name!r}")
    return read_pomdp(files[name])


def write_pomdp(pomdp: POMDP, path: Path | str) -> None:
    """Write a POMDP to a file in Cassandra's format; `read_pomdp` gives the same model, to the bit.

    Parameters
    ----------
    pomdp : POMDP
        The model.
    path : path
        The file. It is written whole or not at all.

    Raises
    ------
    ValueError
        If a name is none in this format: letters, digits, ``_`` and ``-``, a letter first, and no
        word of the format's own. Names that are the numbers from 0 are written as a count.
    OSError
        If the file cannot be written.

    Examples
    --------
    >>> import tempfile
    >>> tiger = problem("tiger")
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = Path(folder) / "again.pomdp"
    ...     write_pomdp(tiger, path)
    ...     again = read_pomdp(path)
    ...     path.read_text().splitlines()[:4]
    ['discount: 0.95', 'values: reward', 'states: tiger-left tiger-right',
     'actions: listen open-left open-right']
    >>> bool((again.T == tiger.T).all())
    True
    """
    lines = [f"discount: {pomdp.gamma!r}", "values: reward"]
    lines += [f"{kind}: {_declared(kind, getattr(pomdp, kind))}" for kind in PREAMBLE[2:]]
    lines += ["start:", _row(pomdp.start), ""]
    for a in range(pomdp.n_actions):
        lines += [f"T: {a}", *map(_row, pomdp.T[a]), "", f"O: {a}", *map(_row, pomdp.O[a]), ""]
        lines += [f"R: {a} : {s} : * : * {float(r)!r}" for s, r in enumerate(pomdp.R[:, a])]
        lines += [""]
    write_whole("\n".join(lines).encode(), Path(path))


def _declared(kind: str, names: tuple[str, ...]) -> str:
    if names == tuple(map(str, range(len(names)))):
        return str(len(names))
    for name in names:
        if name in RESERVED or not WORD.fullmatch(name):
            raise ValueError(f"{kind} must be words that the file format can hold, got {name!r}")
    return " ".join(names)


def _row(values: NDArray[np.float64]) -> str:
    return " ".join(map(repr, values.tolist()))

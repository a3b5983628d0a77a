"""Read and write models in Cassandra's .POMDP format; the course's own problems."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from arkaq_edu._files import replacing
from arkaq_edu._paths import course_folder
from arkaq_edu.pomdp.cassandra import KINDS, MOST_BYTES, RESERVED, WORD, PomdpFormatError, parse
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
        Costs (``values: cost``) become negative rewards. A reward that depends on the next state or
        the observation becomes its expectation: R(s, a) = sum_t T(a, s, t) sum_z O(a, t, z)
        R(a, s, t, z). A file without observations, an MDP, becomes a POMDP whose state is seen.

    Raises
    ------
    PomdpFormatError
        If the file does not follow the format, a row of probabilities does not sum to 1, or the
        discount is outside [0, 1]. It names the line, the column, and what was expected there.
    OSError
        If the file does not exist or cannot be read.

    Notes
    -----
    A file begins, in any order, with ``discount: 0.95``, ``values: reward`` (or ``cost``), and
    ``states:``, ``actions:`` and ``observations:``, each followed by names or by a count. Then
    comes the belief at the start, if it is not uniform: ``start:`` with one probability for each
    state, with ``uniform`` or with one state; ``start include:`` or ``start exclude:`` with states.
    The rest are entries of T(a, s, t), O(a, t, z) and R(a, s, t, z), such as

    =============================  ===========================================================
    ``T: listen : left : left 1``  one entry
    ``T: listen : left``           a row: its numbers, ``uniform`` or ``reset`` (the start)
    ``T: listen``                  a matrix: its numbers row by row, ``uniform`` or ``identity``
    =============================  ===========================================================

    ``O`` is written likewise, with ``uniform`` only, and ``R`` with numbers only, from one entry to
    a matrix over the next state and the observation. States, actions and observations go by name or
    by number, from 0; ``*`` stands for all of them. What is not given is 0. What is given twice
    takes its last value. A ``#`` begins a comment. Blanks and line ends only separate.

    Rows whose sum is within 1e-4 of 1, as rounded decimals leave them, are divided by it. `T` and
    `O` become arrays if they have at most 2^20 entries, and else sparse matrices, for which no
    dense table is made. Files that would take too much memory or time are refused: more than
    128 MiB, more than 65,536 states, actions or observations, or entries of a table that set more
    than 2^24 numbers in all. A progress bar shows after two seconds.

    With a discount of 1 the values are finite only up to a horizon (`solve_pomdp`).

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
    # Bytes that are not UTF-8 can only occur in comments, which are skipped.
    text = Path(path).read_text(encoding="utf-8-sig", errors="replace")
    return parse(str(path), text)


def problem(name: str) -> POMDP:
    """Return one of the course's own POMDPs, read from its file in ``data/pomdp``.

    Parameters
    ----------
    name : str
        The name of the file, without its extension.

    Returns
    -------
    POMDP

    Raises
    ------
    ValueError
        If there is no such problem. The message lists all of them.

    Examples
    --------
    >>> problem("corridor").states
    ('first', 'second', 'goal', 'fourth')
    >>> problem("chess")  # doctest: +ELLIPSIS
    Traceback (most recent call last):
    ValueError: name must be one of ball_side, cheese, corridor, ..., got 'chess'
    """
    files = {path.stem: path for path in sorted(course_folder().glob("data/pomdp/*.pomdp"))}
    if name not in files:
        raise ValueError(f"name must be one of {', '.join(files)}, got {name!r}")
    return read_pomdp(files[name])


def write_pomdp(pomdp: POMDP, path: Path | str) -> None:
    """Write a POMDP to a file in Cassandra's format.

    `read_pomdp` reads the same model back, to the last bit.

    Parameters
    ----------
    pomdp : POMDP
        The model.
    path : path
        The file. If writing fails, it is left as it was.

    Raises
    ------
    ValueError
        If the format does not allow a name. A name is a letter, then letters, digits, ``_`` and
        ``-``, and not a word of the format. Names that are the numbers from 0 become a count.
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
    lines += [f"{kind}: {_declared(kind, getattr(pomdp, kind))}" for kind in KINDS]
    lines += ["start:", _row(pomdp.start), ""]
    for a in range(pomdp.n_actions):
        lines += [*_matrix(f"T: {a}", pomdp.T[a]), "", *_matrix(f"O: {a}", pomdp.O[a]), ""]
        lines += [f"R: {a} : {s} : * : * {float(r)!r}" for s, r in enumerate(pomdp.R[:, a])]
        lines += [""]
    with replacing(path) as fresh:
        fresh.write_text("\n".join(lines), encoding="utf-8")


def _declared(kind: str, names: tuple[str, ...]) -> str:
    if names == tuple(map(str, range(len(names)))):
        return str(len(names))
    for name in names:
        if name in RESERVED or not WORD.fullmatch(name):
            raise ValueError(f"{kind} must be words that the file format can hold, got {name!r}")
    return " ".join(names)


def _matrix(key: str, matrix: Any) -> list[str]:
    """Return the rows of a matrix, or the entries of a sparse one."""
    if isinstance(matrix, np.ndarray):
        return [key, *map(_row, matrix)]
    entries = matrix.tocoo()
    places = zip(entries.row.tolist(), entries.col.tolist(), entries.data.tolist(), strict=True)
    return [f"{key} : {s} : {n} {p!r}" for s, n, p in places]


def _row(values: NDArray[np.float64]) -> str:
    return " ".join(map(repr, values.tolist()))

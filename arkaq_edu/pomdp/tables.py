"""The tables of a .POMDP file: T, O and R as its entries fill them, without the zeros."""

from __future__ import annotations

import math
from array import array
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy import sparse

Floats = NDArray[np.float64]
Key = list[Any]  # for each axis an index, or slice(None) for all

# T and O of at most this many entries become arrays, larger ones sparse matrices.
MOST_DENSE = 2**20


class Rows:
    """The rows of T or O, one distribution for each action and state.

    What is set is put down in the order of the file: the place and the value of every number that
    is not 0. A row or a matrix also clears what its rows held before.

    Parameters
    ----------
    shape : tuple of int
        The numbers of actions, of states, and of entries in a row.
    """

    def __init__(self, shape: tuple[int, int, int]) -> None:
        self.shape = shape
        self.rows, self.columns, self.values = array("i"), array("i"), array("d")
        self.cleared = np.zeros(math.prod(shape[:2]), np.int32)  # what was put down before is void
        self.given: list[tuple[Key, int]] = []

    def cost(self, key: Key, block: Any) -> int:
        """Return how many numbers `set` would put down."""
        places = math.prod(
            n if isinstance(k, slice) else 1 for k, n in zip(key, self.shape, strict=False)
        )
        if isinstance(block, float):
            return places * math.prod(self.shape[len(key) :])
        numbers = block.nnz if sparse.issparse(block) else np.count_nonzero(block)
        return places * (1 + int(numbers))

    def set(self, key: Key, block: Any, at: int) -> None:
        """Set the entries at a key: one number for all of them, or a row, or a matrix."""
        S = self.shape[1]
        self.given.append((key[:2], at))
        if len(key) == 3 and not any(isinstance(k, slice) for k in key):
            a, s, n = key
            self.rows.append(a * S + s)
            self.columns.append(n)
            self.values.append(block)
            return
        whole = [*key, slice(None), slice(None)][:3]
        a, s, columns = (
            np.atleast_1d(np.arange(n)[k]) for k, n in zip(whole, self.shape, strict=True)
        )
        rows = (a[:, np.newaxis] * S + s).ravel()
        if len(key) < 3:
            self.cleared[rows] = len(self.values)
        if len(key) == 1 and not isinstance(block, float):  # a matrix
            matrix = sparse.coo_array(block)
            for first in a * S:
                self._put(first + matrix.row, matrix.col, matrix.data)
            return
        if not isinstance(block, float):  # a row
            columns = np.flatnonzero(block)
            block = np.tile(block[columns], len(rows))
        self._put(np.repeat(rows, len(columns)), np.tile(columns, len(rows)), block)

    def _put(self, rows: Any, columns: Any, values: Any) -> None:
        self.rows.frombytes(rows.astype(np.int32).tobytes())
        self.columns.frombytes(columns.astype(np.int32).tobytes())
        self.values.frombytes(np.full(rows.shape, values, np.float64).tobytes())

    def table(self) -> Any:
        """Return the rows: an array of shape (A, S, N), or a list of A sparse matrices (S, N)."""
        A, S, N = self.shape
        row, column = (
            np.frombuffer(x, np.int32).astype(np.int64) for x in (self.rows, self.columns)
        )
        value = np.frombuffer(self.values, np.float64)
        holds = np.arange(len(row)) >= self.cleared[row]
        row, column, value = row[holds], column[holds], value[holds]
        # What is given twice takes its last value.
        _, last = np.unique((row * N + column)[::-1], return_index=True)
        last = len(row) - 1 - last
        row, column, value = row[last], column[last], value[last]
        if A * S * N <= MOST_DENSE:
            dense = np.zeros((A * S, N))
            dense[row, column] = value
            return dense.reshape(A, S, N)
        ends = np.searchsorted(row, np.arange(A * S + 1))
        rows = sparse.csr_array((value, column, ends), (A * S, N))
        rows.eliminate_zeros()
        return [rows[k : k + S] for k in range(0, A * S, S)]

    def place(self, a: int, s: int) -> int | None:
        """Return where in the file a row was set last, or None if it was not."""
        for key, at in reversed(self.given):
            if all(isinstance(k, slice) or k == i for k, i in zip(key, (a, s), strict=False)):
                return at
        return None


class Reward(NamedTuple):
    """An entry of R: where it is set, to what, and where it stands in the file."""

    key: Key
    block: Any
    at: int


def expected_rewards(
    T: Any,
    O: Any,  # noqa: E741
    entries: list[Reward],
    charge: Callable[[int, int], None],
) -> Floats:
    """Return R(s, a) = sum_t T(a, s, t) sum_z O(a, t, z) R(a, s, t, z), shape (S, A).

    R is needed only where T is not 0, so no table over all next states is made.

    Parameters
    ----------
    T, O : ndarray, or list of sparse matrices
        The rows of the file.
    entries : list of Reward
        The entries in the order of the file.
    charge : callable
        It is told how many numbers an entry sets, and the place of the entry; it may refuse.
    """
    S, Z = O[0].shape
    on_next = any(not _all(key, 2) for key, _, _ in entries)
    on_seen = any(len(key) + np.ndim(block) == 4 and not _all(key, 3) for key, block, _ in entries)
    R = np.zeros((S, len(T)))
    entries_of: list[list[Reward]] = [[] for _ in T]
    for entry in entries:
        a = entry.key[0]
        chosen = entries_of if _all(entry.key, 0) else entries_of[a : a + 1]
        charge(len(chosen), entry.at)
        for of_action in chosen:
            of_action.append(entry)
    for a, here in enumerate(entries_of):
        if not on_next and not on_seen:
            for key, value, at in here:
                charge(S if isinstance(key[1], slice) else 1, at)
                R[key[1], a] = value
            continue
        steps = sparse.csr_array(T[a])
        s, t = np.repeat(np.arange(S), np.diff(steps.indptr)), steps.indices
        charge(steps.nnz * (Z if on_seen else 1), here[0].at if here else -1)
        table = np.zeros((steps.nnz, Z if on_seen else 1))
        for key, block, at in here:
            charge(_fill(table, steps.indptr, s, t, key, block), at)
        if on_seen:
            chances = O[a][t] if isinstance(O[a], np.ndarray) else O[a][t].toarray()
            table = (chances * table).sum(axis=1, keepdims=True)
        R[:, a] = np.bincount(s, steps.data * table[:, 0], S)
    return R


def _all(key: Key, axis: int) -> bool:
    return axis < len(key) and isinstance(key[axis], slice)


def _fill(table: Floats, ends: Any, s: Any, t: Any, key: Key, block: Any) -> int:
    """Set the entries at a key in a table over the steps (s, t) that can happen.

    Return how many numbers were looked at.
    """
    one = len(key) > 1 and not _all(key, 1)
    rows: Any = slice(ends[key[1]], ends[key[1] + 1]) if one else slice(None)
    t, s = t[rows], s[rows]
    part = table[rows]
    if len(key) == 1:  # a matrix over state and next state, of a file without observations
        part[:, 0] = block[s, t]
    elif len(key) == 2:
        part[...] = block[t] if block.ndim == 2 else block[t, np.newaxis]
    else:
        which = slice(None) if _all(key, 2) else t == key[2]
        part[which, key[3] if len(key) == 4 and table.shape[1] > 1 else slice(None)] = block
    return part.size

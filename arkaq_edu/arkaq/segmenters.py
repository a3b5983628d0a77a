"""What cuts the world into states: the protocol of a segmenter, and a uniform grid."""

from __future__ import annotations

import math
from typing import Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray
from sklearn.base import BaseEstimator

from arkaq_edu import _checks

#: With a table of values for eight actions, so many cells take half a gigabyte.
MOST_CELLS = 2**22


class Segmenter(Protocol):
    """What `Arkaq` needs of a segmenter, which every network of `arkaq_edu.art` provides.

    Patterns have shape (m,) and entries in [-1, 1]. Categories are counted from 0. The agent
    calls `learn_one` while it segments the world, and only `category` afterwards.

    Attributes
    ----------
    n_clusters_ : int
        Number of categories: the number of states the learner gets. It is read after `learn_one`.

    Examples
    --------
    A segmenter with two states: the ball is near, or it is far.

    >>> import gymnasium
    >>> from arkaq_edu.arkaq import Arkaq, TrainingSettings
    >>> class NearOrFar:
    ...     n_clusters_ = 2
    ...
    ...     def category(self, x):
    ...         return int(x[0] > 0)
    ...
    ...     def learn_one(self, x):
    ...         return self.category(x)  # nothing to learn
    >>> short = TrainingSettings(patterns=100, exploration=200, exploitation=200)
    >>> env = gymnasium.make("arkaq_edu:BallApproach-v0")
    >>> agent = Arkaq(segmenter=NearOrFar(), learning=short, rng=0).learn(env, progress=False)
    >>> agent.q.Q.shape
    (2, 3)
    """

    @property
    def n_clusters_(self) -> int:
        """Number of categories."""

    def learn_one(self, x: NDArray[np.float64], /) -> int:
        """Learn one pattern and return its category."""

    def category(self, x: NDArray[np.float64], /) -> int:
        """Return the category of a pattern, and learn nothing."""


class UniformGrid(BaseEstimator):
    """Equal cells over [-1, 1]^m, the same however the patterns lie.

    The usual alternative to categories that are learned: there are as many states from the start
    as there are cells, also where no pattern ever comes.

    Parameters
    ----------
    cells : sequence of int, length m
        The number of cells along each feature, each at least 1, and 2**22 in all at the most.

    Attributes
    ----------
    counts_ : ndarray of shape (n_clusters,)
        How many patterns each cell has been given to learn.

    Raises
    ------
    ValueError
        If a number of cells is not an integer of at least 1, or there are too many in all.

    Examples
    --------
    >>> grid = UniformGrid(cells=(4, 2))
    >>> grid.n_clusters_, grid.category([-0.9, 0.5]), grid.category([1.0, 1.0])
    (8, 1, 7)
    >>> grid.cluster_centers_[1]
    array([-0.75,  0.5 ])
    """

    def __init__(self, cells: tuple[int, ...] = (10, 10)) -> None:
        numbers = _checks.integers("cells", cells, 1)
        if numbers.ndim != 1 or not len(numbers):
            raise ValueError(f"cells must be a sequence of integers, got {_checks.shown(cells)}")
        self.cells = tuple(int(n) for n in numbers)
        _checks.integer("cells (their product)", math.prod(self.cells), 1, MOST_CELLS)
        self.counts_ = np.zeros(math.prod(self.cells), dtype=np.int64)

    @property
    def n_clusters_(self) -> int:
        """Number of cells."""
        return len(self.counts_)

    @property
    def cluster_centers_(self) -> NDArray[np.float64]:
        """The middle of each cell, shape (n_clusters, m)."""
        places = np.stack(np.unravel_index(np.arange(self.n_clusters_), self.cells), axis=-1)
        return (2 * places + 1) / np.array(self.cells) - 1

    def predict(self, X: ArrayLike) -> NDArray[np.intp]:
        """Return the cell of each pattern; patterns beyond the border belong to a border cell.

        Parameters
        ----------
        X : array_like, shape (..., m)

        Returns
        -------
        ndarray of int, shape (...)

        Raises
        ------
        ValueError
            If the patterns have another number of features than the grid.
        """
        X = _checks.array("X", X, None).clip(-1.0, 1.0)
        if X.shape[-1:] != (len(self.cells),):
            raise ValueError(f"X must have {len(self.cells)} features, got shape {X.shape}")
        places = np.floor((X + 1) / 2 * self.cells).astype(np.intp)
        return np.ravel_multi_index(tuple(np.moveaxis(places, -1, 0)), self.cells, mode="clip")

    def category(self, x: ArrayLike) -> int:
        """Return the cell of one pattern of shape (m,)."""
        return int(self.predict(x))

    def learn_one(self, x: ArrayLike) -> int:
        """Count one pattern of shape (m,) and return its cell."""
        cell = self.category(x)
        self.counts_[cell] += 1
        return cell

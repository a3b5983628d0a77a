"""ART1: categories of binary patterns (section 2.4.1)."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike
from sklearn.utils.validation import check_is_fitted

from arkaq_edu._checks import number
from arkaq_edu._compiled import kernel
from arkaq_edu.art._estimator import Categories, Floats, Labels

if TYPE_CHECKING:
    import pandas as pd


@kernel
def overlap(pattern, template):
    """Return how many active components the two share, and how many the template has."""
    shared, size = 0.0, 0.0
    for i in range(len(pattern)):
        shared += pattern[i] * template[i]
        size += template[i]
    return shared, size


@kernel
def search(pattern, templates, n, vigilance, L, tried):
    """Write the nodes that F2 chooses, in order, into `tried`; return how many there were.

    All but the last were reset. The last is in resonance; `n` stands for an uncommitted node, -1
    for none, where the pattern is silent.
    """
    active = 0.0
    for i in range(len(pattern)):
        active += pattern[i]
    if active == 0.0:
        tried[0] = -1
        return 1
    signal, match = np.empty(n), np.empty(n)
    for j in range(n):
        shared, size = overlap(pattern, templates[j])
        signal[j] = L * shared / (L - 1.0 + size)
        match[j] = shared / active
    for k in range(n):
        best = 0
        for j in range(1, n):
            if signal[j] > signal[best]:
                best = j
        if signal[best] <= 0.0:  # only nodes are left that were reset or share nothing
            tried[k] = n
            return k + 1
        tried[k] = best
        if match[best] >= vigilance:
            return k + 1
        signal[best] = -1.0  # reset: blocked for as long as this pattern lasts
    tried[n] = n
    return n + 1


@kernel
def learn(X, start, labels, templates, counts, n, vigilance, L):
    """Present the patterns ``X[start:]`` in order; return where it stopped and how many templates.

    It stops early when a category is to be founded and ``len(templates)`` leaves no room for it.
    """
    tried = np.empty(len(templates) + 1, np.int64)
    for t in range(start, len(X)):
        j = tried[search(X[t], templates, n, vigilance, L, tried) - 1]
        if j == n:
            if n == len(templates):
                return t, n
            n += 1
            templates[j] = 1.0  # what an uncommitted node expects: anything
            counts[j] = 0
        if j >= 0:
            templates[j] *= X[t]  # both traces follow the active nodes of F1 (fast learning)
            counts[j] += 1
        labels[t] = j
    return len(X), n


@kernel
def recall(X, labels, templates, n, vigilance, L):
    """Write the category in resonance with each pattern of `X` into `labels`, or -1."""
    tried = np.empty(len(templates) + 1, np.int64)
    for t in range(len(X)):
        j = tried[search(X[t], templates, n, vigilance, L, tried) - 1]
        labels[t] = j if j < n else -1


class ART1(Categories):
    """Categories of binary patterns: a template is what its patterns have in common.

    F1 follows the 2/3 rule: a node is active where two of three are, the input, the expectation
    that F2 sends down, and gain 1, which is on while there is an input and F2 is silent. So F1
    first shows the pattern `I`; F2 chooses the node of largest signal
    ``L |I and z_j| / (L - 1 + |z_j|)``; its expectation `z_j` leaves ``I and z_j`` active in F1. If
    this is less than the part `vigilance` of the active inputs, ``|I and z_j| / |I| < vigilance``,
    the node is reset and stays blocked while the pattern lasts, and F2 chooses again; else the
    template becomes ``I and z_j`` at once (fast learning). An uncommitted node expects anything,
    is chosen when no committed node is left that shares anything with the pattern, and is never
    reset. Of equal signals the category founded first is chosen.

    Here vigilance is a similarity: the larger, the more categories. It refers to the active inputs,
    not to all inputs, and a match of exactly `vigilance` is enough: with 1, a category holds only
    patterns that contain its template and add nothing to it.

    `predict` and `category` search as learning does, and give -1 where they end at an uncommitted
    node: the pattern is new. A pattern without an active input belongs to category -1 too.

    Parameters
    ----------
    vigilance : float in [0, 1], default=0.7
        Part of a pattern's active inputs that must be found in the template.
    L : float > 1, default=2
        Preference in the choice: the larger, the more F2 is drawn to templates with few active
        components. Near 1, it prefers any template that is contained in the pattern.
    binarize : float or None, default=None
        An input is active where it is larger. None: patterns are binary already, and other numbers
        than 0 and 1 are refused.

    Attributes
    ----------
    cluster_centers_ : ndarray of shape (n_clusters, n_features)
        The templates (top-down traces) of zeros and ones, in the order of founding (a copy).
    bottom_up_ : ndarray of shape (n_clusters, n_features)
        The bottom-up traces ``L z / (L - 1 + |z|)``.
    counts_ : ndarray of shape (n_clusters,)
        How many patterns each category has learned (a copy).
    n_clusters_ : int
        Number of categories.
    labels_ : ndarray of shape (n_samples,)
        The category of each pattern of the last `fit` or `partial_fit`, as it was decided when
        the pattern was presented. Templates shrink on, so `predict` may differ until learning is
        stable: until a pass through the patterns by `partial_fit` changes no template.
    n_features_in_ : int
        Number of features.
    feature_names_in_ : ndarray of shape (n_features_in_,)
        Names of the features, if the patterns came as a table with names.

    Notes
    -----
    With `binarize` the class passes all of scikit-learn's estimator checks. Without, it refuses
    their patterns, which are not binary.

    References
    ----------
    Thesis sections 2.4 and 2.4.1, figure 2.19.
    G. A. Carpenter, S. Grossberg, A massively parallel architecture for a self-organizing neural
    pattern recognition machine, Computer Vision, Graphics, and Image Processing 37 (1987) 54-115.

    Examples
    --------
    >>> patterns = [[1, 1, 0, 0], [1, 1, 1, 0], [0, 0, 1, 1]]
    >>> ART1(vigilance=0.6).fit(patterns).cluster_centers_
    array([[1., 1., 0., 0.],
           [0., 0., 1., 1.]])
    >>> ART1(vigilance=0.7).fit_predict(patterns)
    array([0, 1, 2])
    """

    def __init__(
        self, vigilance: float = 0.7, L: float = 2.0, binarize: float | None = None
    ) -> None:
        self.vigilance = vigilance
        self.L = L
        self.binarize = binarize

    def trace(self, x: ArrayLike) -> pd.DataFrame:
        """Return the search for the category of one pattern as a table; nothing is learned.

        Parameters
        ----------
        x : array-like of shape (n_features,)
            The pattern.

        Returns
        -------
        DataFrame
            One row for each step and each node of F1. Step 0 is the pattern alone, each further
            step a choice of F2. Columns: `step`; `node`, the chosen one (-1: none; `n_clusters_`:
            an uncommitted one); `feature`; `input`, `gain1`, `gain2` and `expectation`, 0 or 1;
            `activity` of F1 by the 2/3 rule; `signal` that the node received; `match`, the active
            part of the input; whether the step ended in `reset`, or the node is the `winner`.

        Raises
        ------
        sklearn.exceptions.NotFittedError
            If nothing has been learned yet.
        ValueError
            For an `x` of the wrong shape, or not binary.

        Examples
        --------
        >>> art = ART1(0.7).fit([[1, 1, 0, 0], [0, 0, 1, 1]])
        >>> table = art.trace([1, 1, 1, 0])
        >>> table.groupby("step")[["node", "activity", "match", "reset", "winner"]].agg(
        ...     {"node": "first", "activity": list, "match": "first", "reset": "first",
        ...      "winner": "first"}).round(2)
              node      activity  match  reset  winner
        step
        0       -1  [1, 1, 1, 0]    NaN  False   False
        1        0  [1, 1, 0, 0]   0.67   True   False
        2        1  [0, 0, 1, 0]   0.33   True   False
        3        2  [1, 1, 1, 0]   1.00  False    True
        """
        import pandas as pd

        check_is_fitted(self)
        self._heed()
        pattern = self._pattern(x)[0]
        vigilance, L = self._settings
        tried = np.empty(self._n + 1, np.int64)
        steps = search(pattern, self._centers, self._n, vigilance, L, tried)
        on = bool(pattern.any())
        tables = [self._step(0, -1, pattern, gain1=on)]
        if on:
            tables += [self._step(k + 1, int(tried[k]), pattern, gain1=False) for k in range(steps)]
        table = pd.concat(tables, ignore_index=True)
        table["reset"] = table["match"] < vigilance
        table["winner"] = table["match"] >= vigilance
        return table

    def _step(self, step: int, node: int, pattern: Floats, gain1: bool) -> pd.DataFrame:
        """Return the rows of one step of a trace."""
        import pandas as pd

        expectation, signal, match = np.zeros(len(pattern)), np.nan, np.nan
        if node == self._n:
            expectation[:] = 1
        elif node >= 0:
            expectation[:] = self._centers[node]
            signal = float(self.bottom_up_[node] @ pattern)
        activity = pattern + gain1 + expectation >= 2
        if node >= 0:
            match = activity.sum() / pattern.sum()
        return pd.DataFrame(
            {
                "step": step,
                "node": node,
                "feature": np.arange(len(pattern)),
                "input": pattern.astype(int),
                "gain1": int(gain1),
                "gain2": int(pattern.any()),
                "expectation": expectation.astype(int),
                "activity": activity.astype(int),
                "signal": signal,
                "match": match,
            }
        )

    @property
    def bottom_up_(self) -> Floats:
        """The bottom-up traces, shape (n_clusters, n_features)."""
        templates, L = self.cluster_centers_, self._settings[1]
        return L * templates / (L - 1 + templates.sum(axis=1, keepdims=True))

    def _admit(self, X: Floats) -> Floats:
        if self.binarize is not None:
            return (number("binarize", self.binarize) < X).astype(np.float64)
        strange = (X != 0) & (X != 1)
        if strange.any():
            value = X[strange][0]
            raise ValueError(
                f"patterns must be binary (0 or 1), got {value:g}; set binarize to cut them"
            )
        return X

    def _wishes(self) -> tuple:
        return self.vigilance, self.L

    def _parameters(self) -> tuple[float, float]:
        vigilance = number("vigilance", self.vigilance, 0, 1)
        return vigilance, number("L", self.L, 1, open_low=True, open_high=True)

    def _learn_rows(self, X: Floats, done: int, labels: Labels) -> tuple[int, int]:
        return learn(X, done, labels, self._centers, self._counts, self._n, *self._settings)

    def _recall_rows(self, X: Floats, labels: Labels) -> None:
        recall(X, labels, self._centers, self._n, *self._settings)

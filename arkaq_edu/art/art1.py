"""ART1: categories of binary patterns (section 2.4.1)."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from arkaq_edu._checks import number
from arkaq_edu._compiled import kernel
from arkaq_edu.art._estimator import Categories, Floats, Labels
from arkaq_edu.art._scikit import check_is_fitted

if TYPE_CHECKING:
    import pandas as pd


class Parameters(NamedTuple):
    """The parameters of the network."""

    vigilance: float
    L: float


@kernel
def search(I, templates, n, parameters, tried=None):
    """Return the node in resonance with pattern `I`: `n` if uncommitted, -1 if `I` is silent.

    `tried`, a list, takes the nodes that F2 chooses. Compiled code runs without one.
    """
    vigilance, L = parameters
    active = I.sum()
    if active == 0.0:
        return -1
    T, match = np.zeros(n + 1), np.ones(n + 1)
    for j in range(n):
        shared = (I * templates[j]).sum()  # |I and z_j|, what the 2/3 rule leaves active in F1
        T[j] = L * shared / (L - 1.0 + templates[j].sum())
        match[j] = shared / active
    while True:
        J = T.argmax()  # of equals the first
        if T[J] == 0.0:  # no node is left that shares anything
            J = n
        if tried is not None:
            tried.append(J)
        if match[J] >= vigilance:
            return J
        T[J] = 0.0  # reset: blocked while this pattern lasts


@kernel
def learn(X, templates, counts, n, parameters):
    """Present the patterns in order; return their categories and the number of templates."""
    labels = np.empty(len(X), np.int64)
    for t in range(len(X)):
        J = search(X[t], templates, n, parameters)
        if J == n:
            n += 1
            templates[J] = 1.0  # an uncommitted node expects anything
            counts[J] = 0
        if J >= 0:
            templates[J] *= X[t]  # fast learning: both traces follow the active nodes of F1
            counts[J] += 1
        labels[t] = J
    return labels, n


@kernel
def recall(X, templates, n, parameters):
    """Return the committed node in resonance with each pattern, or -1."""
    labels = np.empty(len(X), np.int64)
    for t in range(len(X)):
        J = search(X[t], templates, n, parameters)
        labels[t] = J if J < n else -1
    return labels


class ART1(Categories):
    """Categories of binary patterns: a template is what its patterns have in common.

    F1 follows the 2/3 rule: a node is active if two of three are: the input, the expectation that
    F2 sends down, and gain 1, which is on while there is an input and F2 is silent. So F1 first
    shows the pattern `I`, and F2 chooses the node of largest signal
    ``L |I and z_j| / (L - 1 + |z_j|)``. Its expectation `z_j` leaves ``I and z_j`` active in F1.

    If that is too small a part of the active inputs, ``|I and z_j| / |I| < vigilance``, the node is
    reset. It stays blocked while the pattern lasts, and F2 chooses again. Otherwise the template
    becomes ``I and z_j`` at once (fast learning). An uncommitted node expects anything. It is
    chosen when no committed node is left that shares anything with the pattern, and it is never
    reset. Of equal signals, the category founded first is chosen.

    Vigilance is a similarity here: the larger, the more categories. It refers to the active inputs,
    not to all inputs, and a match of exactly `vigilance` is enough. With vigilance 1, a category
    holds only patterns that are contained in its template.

    `predict` and `category` search as learning does. They return -1 if the search ends at an
    uncommitted node: the pattern is new. A pattern without an active input also belongs to
    category -1.

    Parameters
    ----------
    vigilance : float in [0, 1], default=0.7
        Part of a pattern's active inputs that must be found in the template.
    L : float > 1, default=2
        Preference of the choice. The larger it is, the more F2 prefers templates with few active
        components. Near 1, it prefers any template that is contained in the pattern.
    binarize : float or None, default=None
        An input is active if it is larger than this. None means that patterns are binary already;
        numbers other than 0 and 1 are then refused.

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
        The category of each pattern of the last `fit` or `partial_fit`, decided when the pattern
        was presented. Templates keep shrinking, so `predict` may differ until learning is stable,
        that is, until a pass through the patterns by `partial_fit` changes no template.
    n_features_in_ : int
        Number of features.
    feature_names_in_ : ndarray of shape (n_features_in_,)
        Names of the features, if the patterns came as a table with names.

    Notes
    -----
    With `binarize` the class passes all of scikit-learn's estimator checks. Without it, the class
    refuses their patterns, which are not binary.

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
            uncommitted); `feature`; `input`, `gain1`, `gain2` and `expectation`, 0 or 1; `activity`
            of F1 by the 2/3 rule; the `signal` that the node received; `match`, the active part of
            the input; `reset`, whether the step ended in one; `winner`, whether the node won.

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
        I = self._pattern(x)[0]
        nodes: list[int] = []
        plain = getattr(search, "py_func", search)
        winner = plain(I, self._centers, self._n, self._valid(), nodes)
        expected = np.vstack([self.cluster_centers_, np.ones(len(I)), np.zeros(len(I))])
        received = np.append(self.bottom_up_ @ I, [np.nan, np.nan])
        steps = []
        for step, node in enumerate([-1, *nodes]):
            table = pd.DataFrame({"step": step, "node": int(node), "feature": range(len(I))})
            table["input"] = I.astype(int)
            table["gain1"] = int(step == 0 and I.any())
            table["gain2"] = int(I.any())
            table["expectation"] = expected[node].astype(int)
            table["activity"] = (table.input + table.gain1 + table.expectation >= 2).astype(int)
            table["signal"] = received[node]
            table["match"] = table.activity.sum() / I.sum() if step else np.nan
            table["winner"] = step > 0 and node == winner
            table.insert(10, "reset", step > 0 and node != winner)
            steps.append(table)
        return pd.concat(steps, ignore_index=True)

    @property
    def bottom_up_(self) -> Floats:
        """The bottom-up traces, shape (n_clusters, n_features)."""
        templates, L = self.cluster_centers_, self._valid().L
        return L * templates / (L - 1 + templates.sum(axis=1, keepdims=True))

    def _admit(self, X: Floats) -> Floats:
        if self.binarize is not None:
            return (number("binarize", self.binarize) < X).astype(np.float64)
        strange = (X != 0) & (X != 1)
        if strange.any():
            value = X[strange][0]
            raise ValueError(
                f"patterns must be binary (0 or 1), got {value:g}; set binarize to threshold them"
            )
        return X

    def _parameters(self, n_features: int) -> Parameters:
        vigilance = number("vigilance", self.vigilance, 0, 1)
        return Parameters(vigilance, number("L", self.L, 1, open_low=True, open_high=True))

    def _learn_rows(self, X: Floats, parameters: Parameters) -> tuple[Labels, int]:
        return learn(X, self._centers, self._counts, self._n, parameters)

    def _recall_rows(self, X: Floats, parameters: Parameters) -> Labels:
        return recall(X, self._centers, self._n, parameters)

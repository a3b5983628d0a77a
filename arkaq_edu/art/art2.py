"""ART2: categories of analog patterns, by the whole network of section 2.4.2."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from arkaq_edu._checks import number, shown
from arkaq_edu._compiled import kernel
from arkaq_edu.art._estimator import Categories, Floats, Labels
from arkaq_edu.art._scikit import check_is_fitted
from arkaq_edu.art.vectors import change, dot, norm, unit

if TYPE_CHECKING:
    import pandas as pd

MOST_CYCLES = 10_000  # F1 settles long before; without a bound a tiny `tol` could loop forever


TINY = 2.0**-1000  # the least e: it turns 0 / 0 into 0 and changes nothing else


class Parameters(NamedTuple):
    """The parameters of the network, in the notation of the thesis."""

    vigilance: float
    a: float
    b: float
    c: float
    d: float
    theta: float
    e: float
    smooth: bool  # whether f damps noise (2.32) or cuts it (2.34)
    rate: float
    start: float  # of the bottom-up traces
    tol: float


class F1(NamedTuple):
    """The activities of F1, an array each with a value for each feature."""

    w: Floats
    x: Floats
    v: Floats
    u: Floats
    p: Floats
    q: Floats


@kernel
def f(x, k):
    """Return the signal of activities: below theta, noise is damped or cut."""
    signal = x.copy()
    for i in range(len(x)):
        if x[i] < k.theta:
            damped = 2.0 * k.theta * x[i] * x[i] / (x[i] * x[i] + k.theta * k.theta)
            signal[i] = damped if k.smooth else 0.0  # eq 2.32 or 2.34; else eq 2.33 or 2.35
    return signal


@kernel
def cycle(I, z, u, q, k):
    """Go once around the loops of F1, from `u` and `q`; `z` is what F2 expects.

    Each level is at rest with its inputs (eq 2.25, the limit of eq 2.24). The thesis lists the
    levels from the top; the order here is that in which activity flows, from the input up.
    """
    a, b, d, e = k.a, k.b, k.d, k.e
    w = I + a * u  # eq 2.30
    x = w / (e + norm(w))  # eq 2.31
    v = f(x, k) + b * f(q, k)  # eq 2.29
    u = v / (e + norm(v))  # eq 2.28
    p = u + d * z  # eq 2.26, which is eq 2.38 when F2 has chosen
    q = p / (e + norm(p))  # eq 2.27
    return F1(w, x, v, u, p, q)


@kernel
def present(I, top_down, bottom_up, n, k, trace=None):
    """Return the node in resonance with the unit pattern `I`, and `u` as it then is.

    Node `n` is uncommitted; -1 means that nothing of `I` is above the noise. `trace`, a list,
    takes every state of the network. Compiled code runs without one.
    """
    silent = np.zeros(len(I))
    u, q = silent, silent
    for _ in range(MOST_CYCLES):  # F1 by itself
        before = u
        w, x, v, u, p, q = cycle(I, silent, u, q, k)
        if trace is not None:
            trace.append((-1, np.nan, np.nan, False, F1(w, x, v, u, p, q), silent))
        if change(u, before) <= k.tol:
            break
    if u.max() == 0.0:
        return -1, u

    seen = u
    T = np.empty(n + 1)
    for j in range(n):
        T[j] = dot(p, bottom_up[j])  # eq 2.36
    T[n] = dot(p, np.full(len(I), k.start))
    while True:
        J = T.argmax()  # eq 2.37: among the nodes not reset; of equals the first
        z = top_down[J] if J < n else silent
        u = seen
        p = u + k.d * z  # eq 2.38
        q = p / (k.e + norm(p))
        settled = False
        for _ in range(MOST_CYCLES):
            r = (u + k.c * p) / (k.e + norm(u) + k.c * norm(p))  # eq 2.43
            norm_r = norm(r)
            reset = k.vigilance > k.e + norm_r and J < n  # eq 2.44
            if trace is not None:
                trace.append((J, T[J], norm_r, reset, F1(w, x, v, u, p, q), r))
            if reset or settled:
                break
            before = u
            w, x, v, u, p, q = cycle(I, z, u, q, k)
            settled = change(u, before) <= k.tol
        if not reset:
            return J, u
        T[J] = -1.0  # blocked while this pattern lasts


@kernel
def follow(I, u, k):
    """Return where `u` goes while the traces come to rest at ``u / (1 - d)`` (fast learning).

    There ``p = u / (1 - d)``, hence ``q = u``, as if F2 were silent. If everything active is above
    the noise, the loops only turn `u` slowly toward the active part of the pattern. Then that is
    where it is put at once.
    """
    active = u > 0.0
    if not k.smooth and (np.minimum(I, u)[active] >= k.theta).all():
        u = np.where(active, I, 0.0)
        u = u / norm(u)
    silent, q = np.zeros(len(I)), u / (k.e + norm(u))
    for _ in range(MOST_CYCLES):
        before = u
        _, _, _, u, _, q = cycle(I, silent, u, q, k)
        if change(u, before) <= k.tol:
            break
    return u


@kernel
def learn(X, top_down, bottom_up, counts, n, k):
    """Present the patterns in order; return their categories and the number of categories."""
    labels = np.empty(len(X), np.int64)
    for t in range(len(X)):
        I = unit(X[t])
        J, u = present(I, top_down, bottom_up, n, k)
        labels[t] = J
        if J < 0:
            continue
        if J == n:
            n += 1
            top_down[J] = 0.0  # eq 2.48
            bottom_up[J] = k.start
            counts[J] = 0
        u = follow(I, u, k) if k.rate == 1.0 else u
        top_down[J] += k.rate * (u / (1.0 - k.d) - top_down[J])  # eq 2.39, as eq 2.41 has it
        bottom_up[J] += k.rate * (u / (1.0 - k.d) - bottom_up[J])  # eq 2.40, as eq 2.42 has it
        counts[J] += 1
    return labels, n


@kernel
def recall(X, top_down, bottom_up, n, k):
    """Return the committed node in resonance with each pattern, or -1."""
    labels = np.empty(len(X), np.int64)
    for t in range(len(X)):
        J, _ = present(unit(X[t]), top_down, bottom_up, n, k)
        labels[t] = J if J < n else -1
    return labels


class ART2(Categories):
    """Categories of analog patterns by the whole network: loops in F1, search in F2, reset.

    A pattern enters with norm 1 (the stage F0), so its scale does not matter. F1 goes around its
    loops until `u` settles::

        w = I + a u         x = w / (e + |w|)       v = f(x) + b f(q)
        u = v / (e + |v|)   p = u + d z_J           q = p / (e + |p|)

    At first F2 is silent (``p = u``), which clears components below `theta` from the pattern. F2
    then chooses the node J of largest signal ``T_j = sum_i p_i z_ij`` and sends its expectation
    `z_J` down into `p`. While F1 settles again, the orienting subsystem watches
    ``r = (u + c p) / (e + |u| + |c p|)``. As soon as ``vigilance > e + |r|`` the node is reset. It
    stays blocked while the pattern lasts, F1 starts again from the pattern alone, and F2 chooses
    again. If F1 settles without a reset, the network is in resonance. Then the traces of J, up and
    down, follow ``dz/dt = d (p - z)``, which comes to rest at ``u / (1 - d)``. An uncommitted node
    expects nothing. There r has norm 1 and no reset is possible, so the search always ends.

    Vigilance is a similarity here: the larger, the more categories. With the default c and d it is
    compared with norms from about 0.75 to 1 only (`match_norm`, figure 2.21).

    `predict` and `category` search in the same way. They return -1 if the search ends at an
    uncommitted node: the pattern is new. A pattern of zeros, or with nothing above `theta`, also
    belongs to category -1. Features must not be negative, because activities are not. Shift them,
    or give each feature two inputs, one that rises with it and one that falls.

    With fast learning and without noise (``theta=0``) a pattern just learned is matched perfectly.
    With noise, a template can gain a component that F1 alone would have cut. With slow learning,
    the norm of `z_J` still grows. In both cases the next presentation may end elsewhere, and at a
    high vigilance it often does.

    The thesis defines this network but runs another (`EuclideanART`), so it gives no parameters.

    Parameters
    ----------
    vigilance : float in (0, 1), default=0.95
        Smallest norm of `r` that is a match.
    a, b : float > 0, default=10
        Strength of the feedback from `u` to `w` and from `q` to `v`; 10 is usual.
    c : float in (0, 1), default=0.1
        Share of `p` in `r`. ``c d / (1 - d)`` must not exceed 1: soon beyond it the norm of `r`
        rises again as a category learns, and a mismatch could become a match. The thesis prints
        c < 0, with which a perfect match does not give norm 1.
    d : float in (0, 1), default=0.9
        Activity of the chosen node of F2.
    theta : float in [0, 1) or None, default=None
        Activities of `x` and `q` below `theta` are noise. A `theta` above ``1 / sqrt(n_features)``
        would silence a pattern of equal features. None means half of that.
    learning_rate : float in (0, 1], default=1
        Fraction of the distance to their rest that traces move in one presentation:
        ``1 - exp(-d (1 - d) t)`` for a presentation of duration t, in units of the traces' time
        constant. With 1 (fast learning) `u` follows the traces to the end; less is slow learning.
    signal : {"linear", "smooth"}, default="linear"
        The function f below `theta`: 0 (equations 2.34, 2.35) or ``2 theta x**2 / (x**2 +
        theta**2)`` (2.32, 2.33). At `theta` itself both give `theta`.
    start : float in (0, 1], default=0.5
        Start of the bottom-up traces, as a fraction of ``1 / ((1 - d) sqrt(n_features))``. Above
        this bound an uncommitted node could beat the node that has learned this very pattern. At
        the bound, uncommitted nodes win often, whatever the vigilance. Top-down traces start at 0.
    e : float in [0, 1), default=0
        Keeps divisors from being 0. With ``e=0``, 0 / 0 is 0.
    tol : float in (0, 1), default=1e-6
        F1 has settled when no component of `u` changes by more than this in one cycle.

    Attributes
    ----------
    cluster_centers_ : ndarray of shape (n_clusters, n_features)
        ``(1 - d) z_J``: the expected directions, of norm 1 once learning is complete (a copy).
    top_down_, bottom_up_ : ndarray of shape (n_clusters, n_features)
        The traces (copies).
    counts_ : ndarray of shape (n_clusters,)
        How many patterns each category has learned (a copy).
    n_clusters_ : int
        Number of categories.
    labels_ : ndarray of shape (n_samples,)
        The category of each pattern of the last `fit` or `partial_fit`, decided when the pattern
        was presented. Traces move on, so `predict` may differ.
    n_features_in_ : int
        Number of features.
    feature_names_in_ : ndarray of shape (n_features_in_,)
        Names of the features, if the patterns came as a table with names.

    Notes
    -----
    The class fails one of scikit-learn's estimator checks: ``check_clustering`` feeds standardized
    patterns, some of them negative, although the class is tagged as for positive patterns only.

    References
    ----------
    Thesis sections 2.4.2, 2.4.3 and 2.4.3.1 to 2.4.3.4, equations 2.24-2.48, figures 2.20 and
    2.21.
    G. A. Carpenter, S. Grossberg, ART 2: self-organization of stable category recognition codes
    for analog input patterns, Applied Optics 26 (1987) 4919-4930.

    Examples
    --------
    >>> patterns = [[9.0, 1.0, 0.0], [8.0, 2.0, 0.0], [0.0, 1.0, 5.0], [900.0, 100.0, 0.0]]
    >>> art = ART2(vigilance=0.9).fit(patterns)
    >>> art.labels_
    array([0, 0, 1, 0])
    >>> art.cluster_centers_.round(2)
    array([[1., 0., 0.],
           [0., 0., 1.]])

    A pattern that no category expects is new:

    >>> art.predict([[0.0, 3.0, 0.0]])
    array([-1])
    """

    _rows = ("_centers", "_bottom_up", "_counts")
    _bottom_up: Floats

    def __init__(
        self,
        vigilance: float = 0.95,
        a: float = 10.0,
        b: float = 10.0,
        c: float = 0.1,
        d: float = 0.9,
        theta: float | None = None,
        learning_rate: float = 1.0,
        signal: str = "linear",
        start: float = 0.5,
        e: float = 0.0,
        tol: float = 1e-6,
    ) -> None:
        self.vigilance = vigilance
        self.a = a
        self.b = b
        self.c = c
        self.d = d
        self.theta = theta
        self.learning_rate = learning_rate
        self.signal = signal
        self.start = start
        self.e = e
        self.tol = tol

    def trace(self, x: ArrayLike) -> pd.DataFrame:
        """Return the presentation of one pattern as a table; nothing is learned.

        Parameters
        ----------
        x : array-like of shape (n_features,)
            The pattern.

        Returns
        -------
        DataFrame
            One row for each step and each feature; a step is one cycle of F1. Columns: `step`;
            `node` of F2 (-1: silent; `n_clusters_`: uncommitted); `feature`; `input`, of norm 1;
            the activities `w`, `x`, `v`, `u`, `p`, `q`; `r`; the `signal` that the node received;
            `norm_r` (NaN while F2 is silent); `reset`, whether the step ended in one; `winner`,
            true in the last step only, if a node won.

        Raises
        ------
        sklearn.exceptions.NotFittedError
            If nothing has been learned yet.
        ValueError
            For an `x` of the wrong shape, not finite or negative.

        Examples
        --------
        >>> art = ART2(0.97).fit([[9.0, 1.0, 0.0], [0.0, 1.0, 5.0]])
        >>> table = art.trace([1.0, 0.0, 1.2])
        >>> ends = table[(table.reset | table.winner) & (table.feature == 0)]
        >>> ends[["step", "node", "norm_r", "reset", "winner"]].round(3)
            step  node  norm_r  reset  winner
        6      2     1   0.951   True   False
        9      3     0   0.922   True   False
        15     5     2   1.000  False    True
        """
        import pandas as pd

        check_is_fitted(self)
        k, states = self._valid(), list[tuple]()
        I = unit(self._pattern(x)[0])
        plain = getattr(present, "py_func", present)
        winner, _ = plain(I, self._centers, self._bottom_up, self._n, k, states)
        steps = [
            pd.DataFrame(
                {"step": step, "node": int(node), "feature": range(len(I)), "input": I}
                | now._asdict()
                | {"r": r, "signal": signal, "norm_r": norm_r, "reset": bool(reset)}
            )
            for step, (node, signal, norm_r, reset, now, r) in enumerate(states)
        ]
        table = pd.concat(steps, ignore_index=True)
        table["winner"] = (table.step == len(states) - 1) & (winner >= 0)
        return table

    @property
    def cluster_centers_(self) -> Floats:
        """The expected directions, ``(1 - d) z_J``, shape (n_clusters, n_features)."""
        return (1.0 - self._valid().d) * self._centers[: self._n]

    @property
    def top_down_(self) -> Floats:
        """The traces from F2 to F1, shape (n_clusters, n_features) (a copy)."""
        return self._centers[: self._n].copy()

    @property
    def bottom_up_(self) -> Floats:
        """The traces from F1 to F2, shape (n_clusters, n_features) (a copy)."""
        return self._bottom_up[: self._n].copy()

    def __sklearn_tags__(self) -> Any:
        tags = super().__sklearn_tags__()
        tags.input_tags.positive_only = True
        return tags

    def _admit(self, X: Floats) -> Floats:
        if X.min() < 0:
            raise ValueError(
                f"Negative values in data passed to ART2: features must be >= 0, got {X.min():g}"
            )
        return X

    def _parameters(self, n_features: int) -> Parameters:
        inside = {"open_low": True, "open_high": True}
        c, d = number("c", self.c, 0, 1, **inside), number("d", self.d, 0, 1, **inside)
        if c * d / (1 - d) > 1 + 1e-12:
            raise ValueError(f"c * d / (1 - d) must be <= 1, got {c * d / (1 - d):g}")
        if not isinstance(self.signal, str) or self.signal not in ("linear", "smooth"):
            raise ValueError(f"signal must be 'linear' or 'smooth', got {shown(self.signal)}")
        even = 1 / math.sqrt(n_features)  # a feature's activity where all are equal
        theta = even / 2
        if self.theta is not None:
            theta = number("theta", self.theta, 0, 1, open_high=True)
        return Parameters(
            vigilance=number("vigilance", self.vigilance, 0, 1, **inside),
            a=number("a", self.a, 0, **inside),
            b=number("b", self.b, 0, **inside),
            c=c,
            d=d,
            theta=theta,
            e=max(number("e", self.e, 0, 1, open_high=True), TINY),
            smooth=self.signal == "smooth" and theta > 0,
            rate=number("learning_rate", self.learning_rate, 0, 1, open_low=True),
            start=number("start", self.start, 0, 1, open_low=True) * even / (1 - d),
            tol=number("tol", self.tol, 0, 1, **inside),
        )

    def _learn_rows(self, X: Floats, parameters: Parameters) -> tuple[Labels, int]:
        traces = self._centers, self._bottom_up
        return learn(X, *traces, self._counts, self._n, parameters)

    def _recall_rows(self, X: Floats, parameters: Parameters) -> Labels:
        return recall(X, self._centers, self._bottom_up, self._n, parameters)

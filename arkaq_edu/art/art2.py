"""ART2: categories of analog patterns, by the whole network of section 2.4.2."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from sklearn.utils.validation import check_is_fitted

from arkaq_edu._checks import number
from arkaq_edu._compiled import kernel
from arkaq_edu.art._estimator import Categories, Floats, Labels
from arkaq_edu.art._inlined import inlined

if TYPE_CHECKING:
    import pandas as pd

MOST_CYCLES = 10_000  # F1 settles long before; this only bounds a pathological case
LEVELS = ("w", "x", "v", "u", "p", "q", "r")


def match_norm(cosine: ArrayLike, cdz: ArrayLike, c: float) -> NDArray[np.float64]:
    """Return norm r, which vigilance is compared with, in closed form: the surface of figure 2.21.

    Parameters
    ----------
    cosine : array-like
        Cosine of the angle between `u` and the expectation `z_J`.
    cdz : array-like
        Norm of ``c d z_J``. It is 0 for an uncommitted node and ``c d / (1 - d)`` at the end of
        learning.
    c : float
        As in `ART2`.

    References
    ----------
    Thesis equation 2.47.

    Examples
    --------
    >>> match_norm([1.0, 0.5, 0.0], 0.9, c=0.1).round(3)
    array([1.   , 0.888, 0.746])
    """
    cosine, cdz = np.asarray(cosine, dtype=np.float64), np.asarray(cdz, dtype=np.float64)
    above = np.sqrt((1 + c) ** 2 + 2 * (1 + c) * cdz * cosine + cdz**2)
    return above / (1 + np.sqrt(c**2 + 2 * c * cdz * cosine + cdz**2))


@kernel
def f(x, theta, smooth):
    """Return the signal of an activity: noise below `theta` is damped or, if not `smooth`, cut."""
    if x >= theta:
        return x
    if smooth and x > 0.0:
        return 2.0 * theta * x * x / (x * x + theta * theta)
    return 0.0


@inlined
def divide_by_norm(source, e, target):
    """Write ``source / (e + norm(source))`` into `target`; return the largest change there."""
    total = 0.0
    for i in range(len(source)):
        total += source[i] * source[i]
    divisor = e + math.sqrt(total)
    change = 0.0
    for i in range(len(source)):
        value = source[i] / divisor if divisor > 0.0 else 0.0
        change = max(change, abs(value - target[i]))
        target[i] = value
    return change


@kernel
def enter(x, pattern):
    """Write `x` scaled to norm 1 into `pattern` (the F0 stage); return false if all is silent."""
    peak = 0.0
    for i in range(len(x)):
        peak = max(peak, x[i])
    if peak == 0.0:
        return False
    for i in range(len(x)):
        pattern[i] = x[i] / peak  # so that no square leaves the range of a float
    divide_by_norm(pattern, 0.0, pattern)
    return True


@kernel
def expect(z, F1, d, e):
    """Let `p` and `q` of F1 follow `u` and the expectation `z` of F2 (zeros: F2 is silent)."""
    u, p, q = F1[3], F1[4], F1[5]
    for i in range(len(z)):
        p[i] = u[i] + d * z[i]
    divide_by_norm(p, e, q)


@kernel
def cycle(pattern, z, F1, a, b, d, theta, e, smooth):
    """Go once round the loops of F1; return the largest change in `u`."""
    w, x, v, u, q = F1[0], F1[1], F1[2], F1[3], F1[5]
    for i in range(len(pattern)):
        w[i] = pattern[i] + a * u[i]
    divide_by_norm(w, e, x)
    for i in range(len(pattern)):
        v[i] = f(x[i], theta, smooth) + b * f(q[i], theta, smooth)
    change = divide_by_norm(v, e, u)
    expect(z, F1, d, e)
    return change


@kernel
def compare(F1, c, e):
    """Let `r`, the orienting subsystem's view of F1, follow `u` and `p`; return its norm."""
    u, p, r = F1[3], F1[4], F1[6]
    uu, pp, rr = 0.0, 0.0, 0.0
    for i in range(len(u)):
        uu += u[i] * u[i]
        pp += p[i] * p[i]
    divisor = e + math.sqrt(uu) + c * math.sqrt(pp)
    for i in range(len(u)):
        r[i] = (u[i] + c * p[i]) / divisor
        rr += r[i] * r[i]
    return math.sqrt(rr)


@kernel
def record(F1, node, signal, norm_r, reset, row, steps, activity):
    """Note one state of the network in a trace, if one is kept; return the next row."""
    if row < len(steps):
        steps[row, 0], steps[row, 1], steps[row, 2], steps[row, 3] = node, signal, norm_r, reset
        activity[row] = F1
    return row + 1


@kernel
def present(pattern, F1, top_down, bottom_up, n, vigilance, knobs, steps, activity):
    """Return the node in resonance with the unit `pattern`, and how many states there were.

    Node `n` is uncommitted; -1 stands for none, where nothing of the pattern is above the noise.
    F1 is left in resonance. The states are recorded as far as `steps` and `activity` have rows.
    """
    a, b, c, d, theta, e, smooth, tol, bottom_up_start = knobs
    silence = np.zeros(len(pattern))
    F1[:] = 0.0
    row = 0
    for _ in range(MOST_CYCLES):  # F1 by itself
        change = cycle(pattern, silence, F1, a, b, d, theta, e, smooth)
        row = record(F1, -1, np.nan, np.nan, False, row, steps, activity)
        if change <= tol:
            break
    seen = F1[3].copy()
    if seen.max() == 0.0:
        return -1, row
    signal = np.zeros(n + 1)
    for j in range(n):
        for i in range(len(seen)):
            signal[j] += seen[i] * bottom_up[j, i]
    for i in range(len(seen)):
        signal[n] += seen[i] * bottom_up_start
    while True:
        node = int(signal.argmax())  # of equals the first; uncommitted nodes come last
        expectation = top_down[node] if node < n else silence
        F1[3] = seen
        expect(expectation, F1, d, e)
        reset = settled = False
        for _ in range(MOST_CYCLES):
            norm_r = compare(F1, c, e)
            # Nothing is expected of an uncommitted node, so r has norm 1 there, rounding apart.
            reset = node < n and vigilance > e + norm_r
            row = record(F1, node, signal[node], norm_r, reset, row, steps, activity)
            if reset or settled:
                break
            settled = cycle(pattern, expectation, F1, a, b, d, theta, e, smooth) <= tol
        if not reset:
            return node, row
        signal[node] = -1.0  # blocked for as long as this pattern lasts


@kernel
def follow(pattern, F1, knobs):
    """Let `u` of F1 go where it goes when the traces have come to rest at ``u / (1 - d)``.

    There ``p = u / (1 - d)`` and hence ``q = u``, as with F2 silent, only that F1 starts from the
    resonance. If all active components are above the noise, the loops just turn `u` to these
    components of the pattern; as they do so slowly, they are spared the way.
    """
    a, b, _, d, theta, e, smooth, tol, _ = knobs
    u = F1[3]
    silence = np.zeros(len(pattern))
    total = 0.0
    clear = not smooth
    for i in range(len(u)):
        if u[i] > 0.0:
            clear = clear and u[i] >= theta and pattern[i] >= theta
            total += pattern[i] * pattern[i]
    if clear:
        for i in range(len(u)):
            u[i] = pattern[i] / math.sqrt(total) if u[i] > 0.0 else 0.0
    expect(silence, F1, d, e)
    for _ in range(MOST_CYCLES):
        if cycle(pattern, silence, F1, a, b, d, theta, e, smooth) <= tol:
            break


@kernel
def learn(X, start, labels, top_down, bottom_up, counts, n, vigilance, rate, knobs):
    """Present the patterns ``X[start:]`` in order; return where it stopped and how many categories.

    It stops early when a category is to be founded and ``len(top_down)`` leaves no room for it.
    """
    d, bottom_up_start = knobs[3], knobs[8]
    pattern, F1 = np.empty(X.shape[1]), np.empty((7, X.shape[1]))
    steps, activity = np.empty((0, 4)), np.empty((0, 7, X.shape[1]))
    for t in range(start, len(X)):
        labels[t] = -1
        if not enter(X[t], pattern):
            continue
        node, _ = present(pattern, F1, top_down, bottom_up, n, vigilance, knobs, steps, activity)
        if node < 0:
            continue
        if node == n:
            if n == len(top_down):
                return t, n
            n += 1
            top_down[node] = 0.0
            bottom_up[node] = bottom_up_start
            counts[node] = 0
        if rate == 1.0:
            follow(pattern, F1, knobs)
        for i in range(len(pattern)):
            rest = F1[3, i] / (1.0 - d)
            top_down[node, i] += rate * (rest - top_down[node, i])
            bottom_up[node, i] += rate * (rest - bottom_up[node, i])
        counts[node] += 1
        labels[t] = node
    return len(X), n


@kernel
def recall(X, labels, top_down, bottom_up, n, vigilance, knobs):
    """Write the category in resonance with each pattern of `X` into `labels`, or -1."""
    pattern, F1 = np.empty(X.shape[1]), np.empty((7, X.shape[1]))
    steps, activity = np.empty((0, 4)), np.empty((0, 7, X.shape[1]))
    for t in range(len(X)):
        node = -1
        if enter(X[t], pattern):
            node, _ = present(
                pattern, F1, top_down, bottom_up, n, vigilance, knobs, steps, activity
            )
        labels[t] = node if node < n else -1


class ART2(Categories):
    """Categories of analog patterns by the whole network: loops of F1, search in F2, reset.

    A pattern enters with unit norm (the stage F0), so its scale does not matter. F1 goes round its
    loops until `u` settles::

        w = I + a u         x = w / (e + |w|)       v = f(x) + b f(q)
        u = v / (e + |v|)   p = u + d z_J           q = p / (e + |p|)

    at first with F2 silent (``p = u``), which frees the pattern of components below `theta`. F2
    then chooses the node J of largest signal ``T_j = sum_i p_i z_ij``, whose expectation `z_J` is
    sent down into `p`. While F1 settles with it, the orienting subsystem watches
    ``r = (u + c p) / (e + |u| + |c p|)``: as soon as ``vigilance > e + |r|`` the node is reset and
    stays blocked while the pattern lasts, F1 starts again from the pattern alone, and F2 chooses
    again. If F1 settles, the network is in resonance, and the traces of J, up and down, follow
    ``dz/dt = d (p - z)``, whose rest is ``u / (1 - d)``. An uncommitted node expects nothing, so
    that r has norm 1 and it is never reset: the search ends there at the latest.

    Here vigilance is a similarity: the larger, the more categories. What it is compared with runs
    only from about 0.75 to 1 with the c and d given (`match_norm`, figure 2.21).

    `predict` and `category` search as learning does, and give -1 where they end at an uncommitted
    node: the pattern is new. A pattern of zeros, or with nothing above `theta`, belongs to
    category -1 too. Features must not be negative, for an activity cannot be: shift them, or give
    each feature two inputs, one that rises with it and one that falls.

    With fast learning and without noise (``theta=0``) a pattern just learned is matched perfectly.
    With noise, a template can gain a component that F1 by itself would have cut, and with slow
    learning the norm of `z_J` still grows: then the next presentation may end elsewhere, and at a
    high vigilance often does.

    The thesis defines this network and runs another (`EuclideanART`), so it gives no parameters.

    Parameters
    ----------
    vigilance : float in (0, 1), default=0.95
        Smallest norm of `r` that is a match.
    a, b : float > 0, default=10
        Strength of the feedback from `u` to `w` and from `q` to `v`; 10 is usual.
    c : float in (0, 1), default=0.1
        Share of `p` in `r`. ``c d / (1 - d)`` must not exceed 1: soon beyond it the norm
        of `r` rises again as a category learns, and a mismatch could become a match. The thesis
        prints c < 0, with which a perfect match does not give norm 1.
    d : float in (0, 1), default=0.9
        Activity of the chosen node of F2.
    theta : float in [0, 1) or None, default=None
        Activities of `x` and `q` below are noise. Above ``1 / sqrt(n_features)`` a pattern of equal
        features would be silenced; None is half of that.
    learning_rate : float in (0, 1], default=1
        Part of the way to their rest that traces go in one presentation, ``1 - exp(-d (1 - d) t)``
        for a presentation of duration t in units of the traces' own time. With 1 (fast learning)
        `u` has the time to follow the traces; less is slow learning.
    signal : {"linear", "smooth"}, default="linear"
        The function f: 0 below `theta` (equations 2.34, 2.35), or ``2 theta x**2 / (x**2 +
        theta**2)`` (2.32, 2.33). At `theta` itself both give `theta`.
    start : float in (0, 1], default=0.5
        Start of the bottom-up traces, as part of ``1 / ((1 - d) sqrt(n_features))``, above which
        an uncommitted node could win over the node that has learned this very pattern. At the
        bound, uncommitted nodes win often, whatever the vigilance. Top-down traces start at 0.
    e : float in [0, 1), default=0
        Keeps the divisions from failing; where all is silent, here 0 / 0 is 0.
    tol : float in (0, 1), default=1e-6
        F1 has settled when no component of `u` changes by more in one cycle.

    Attributes
    ----------
    cluster_centers_ : ndarray of shape (n_clusters, n_features)
        ``(1 - d) z_J``: the directions expected, of norm 1 once learning is complete (a copy).
    top_down_, bottom_up_ : ndarray of shape (n_clusters, n_features)
        The traces (copies).
    counts_ : ndarray of shape (n_clusters,)
        How many patterns each category has learned (a copy).
    n_clusters_ : int
        Number of categories.
    labels_ : ndarray of shape (n_samples,)
        The category of each pattern of the last `fit` or `partial_fit`, as it was decided when
        the pattern was presented. Traces move on, so `predict` may differ.
    n_features_in_ : int
        Number of features.
    feature_names_in_ : ndarray of shape (n_features_in_,)
        Names of the features, if the patterns came as a table with names.

    Notes
    -----
    Of scikit-learn's estimator checks one cannot pass: ``check_clustering`` feeds standardized
    patterns, hence negative ones, though the class is tagged as for positive patterns only.

    References
    ----------
    Thesis sections 2.4.2 and 2.4.3, equations 2.24-2.48, figures 2.20 and 2.21.
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

    What no category expects is new:

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
            `node` of F2 (-1: silent; `n_clusters_`: an uncommitted one); `feature`; `input`, of
            unit norm; the activities `w`, `x`, `v`, `u`, `p`, `q`; `r`; `signal` that the node
            received; `norm_r` (NaN while F2 is silent); whether the step ended in `reset`; whether
            the node is the `winner`, which it is in the last step only.

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
        self._heed()
        features = self._pattern(x)[0]
        m = len(features)
        pattern, F1 = np.zeros(m), np.empty((7, m))
        traces = self._centers, self._bottom_up, self._n, self._settings[0], self._knobs
        rows, room = 0, 64
        while rows == 0 or rows > room:
            room = max(room, rows)
            steps, activity = np.empty((room, 4)), np.empty((room, 7, m))
            winner = -1
            if enter(features, pattern):
                winner, rows = present(pattern, F1, *traces, steps, activity)
            else:
                rows, steps[0], activity[0] = 1, (-1, np.nan, np.nan, False), 0.0
        each: dict[str, NDArray] = {
            "step": np.arange(rows),
            "node": steps[:rows, 0].astype(np.int64),
        }
        each |= {"signal": steps[:rows, 1], "norm_r": steps[:rows, 2]}
        each |= {"reset": steps[:rows, 3] == 1, "winner": np.arange(rows) == rows - 1}
        each["winner"] &= winner >= 0
        table = pd.DataFrame({name: np.repeat(values, m) for name, values in each.items()})
        table.insert(2, "feature", np.tile(np.arange(m), rows))
        table.insert(3, "input", np.tile(pattern, rows))
        for k, level in enumerate(LEVELS):
            table.insert(4 + k, level, activity[:rows, k].ravel())
        return table

    @property
    def cluster_centers_(self) -> Floats:
        """The directions expected, ``(1 - d) z_J``, shape (n_clusters, n_features)."""
        return (1.0 - self._knobs[3]) * self._centers[: self._n]

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

    def _wishes(self) -> tuple:
        return (
            self.vigilance, self.a, self.b, self.c, self.d, self.theta, self.learning_rate,
            self.signal, self.start, self.e, self.tol,
        )  # fmt: skip

    def _parameters(self) -> tuple:
        inside = {"open_low": True, "open_high": True}
        c, d = number("c", self.c, 0, 1, **inside), number("d", self.d, 0, 1, **inside)
        if c * d / (1 - d) > 1 + 1e-12:
            raise ValueError(f"c * d / (1 - d) must be <= 1, got {c * d / (1 - d):g}")
        if self.signal not in ("linear", "smooth"):
            raise ValueError(f"signal must be 'linear' or 'smooth', got {self.signal!r}")
        return (
            number("vigilance", self.vigilance, 0, 1, **inside),
            number("learning_rate", self.learning_rate, 0, 1, open_low=True),
            number("a", self.a, 0, **inside),
            number("b", self.b, 0, **inside),
            c,
            d,
            None if self.theta is None else number("theta", self.theta, 0, 1, open_high=True),
            number("e", self.e, 0, 1, open_high=True),
            self.signal == "smooth",
            number("tol", self.tol, 0, 1, **inside),
            number("start", self.start, 0, 1, open_low=True),
        )

    def _arrange(self, capacity: int) -> None:
        """Give the categories room for `capacity` of them, and relate parameters to their size."""
        super()._arrange(capacity)
        a, b, c, d, theta, e, smooth, tol, start = self._settings[2:]
        even_share = 1 / math.sqrt(self._centers.shape[1])
        theta = even_share / 2 if theta is None else theta
        self._knobs = a, b, c, d, theta, e, smooth, tol, start * even_share / (1 - d)

    def _learn_rows(self, X: Floats, done: int, labels: Labels) -> tuple[int, int]:
        traces = self._centers, self._bottom_up, self._counts, self._n
        return learn(X, done, labels, *traces, *self._settings[:2], self._knobs)

    def _recall_rows(self, X: Floats, labels: Labels) -> None:
        traces = self._centers, self._bottom_up, self._n
        recall(X, labels, *traces, self._settings[0], self._knobs)

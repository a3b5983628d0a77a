"""The Kalman filter: the equations of thesis 2.5.1 and 2.5.2, and the class that runs them."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
from numpy.typing import ArrayLike

from arkaq_edu._checks import LARGEST, array, covariance, number, shown
from arkaq_edu._compiled import kernel
from arkaq_edu.kalman.consistency import chi_square_quantile
from arkaq_edu.kalman.matrices import (
    HALF_LOST,
    LOG_2PI,
    NEGLIGIBLE,
    inverse,
    mul,
    outer,
    quadratic,
    symmetric,
    transpose,
    vec,
    without_missing,
)
from arkaq_edu.kalman.trace import Array, KalmanTrace


@kernel
def time_update(A, B, Q, x, P, u):
    """Predict: return the state and its covariance one step ahead."""
    x = vec(A, x) + vec(B, u)  # eq 2.55: x = A x + B u
    P = symmetric(mul(mul(A, P), transpose(A)) + Q)  # eq 2.56: P = A P A' + Q
    return x, P


@kernel
def gain(H, R, P, HP, S, seen):
    """Return the gain K, S^-1, the number of entries used and the log determinant of 2 pi S."""
    S_inverse, used, log_det = inverse(S, seen, HALF_LOST)
    if used < seen.sum():
        return gain_by_rows(H, R, P, seen)
    K = mul(transpose(HP), S_inverse)  # eq 2.54, 2.57: K = P H' (H P H' + R)^-1
    return K, S_inverse, used, log_det


@kernel
def gain_by_rows(H, R, P, seen):
    """Return what `gain` returns, where P is so much wider than R that S loses R by rounding.

    The entries of the sighting are used one after the other. Their noises v count as states, so
    that each entry is an exact sum of states, h (x, v), and nothing is added to a large S. Then
    ``F = I - K H`` is the part of the states that the entries so far leave unknown, and
    ``g = h F`` is what the next entry shows of it. An entry is skipped if g is zero but for
    rounding: the entries before it determine it, its noise included.
    """
    m, n = H.shape
    V, F = np.zeros((n + m, n + m)), np.eye(n + m)  # V: the covariance of (x, v)
    V[:n, :n], V[n:, n:] = P, R
    K, S_inverse, used, log_det = np.zeros((n, m)), np.zeros((m, m)), 0, 0.0
    for k in range(m):
        h = np.zeros(n + m)
        h[:n], h[n + k] = H[k], 1.0
        g = vec(transpose(F), h)
        variance = quadratic(V, g)
        own_noise = quadratic(R, g[n:]) > NEGLIGIBLE * R[k, k]
        if seen[k] and (own_noise or variance > NEGLIGIBLE**2 * quadratic(V, h)):
            k_row = vec(F, vec(V, g)) / variance
            F = F - outer(k_row, g)
            K += outer(k_row[:n], g[n:])
            S_inverse += outer(g[n:], g[n:]) / variance
            log_det += LOG_2PI + math.log(variance)
            used += 1
    return K, S_inverse, used, log_det


@kernel
def bounded(x, P):
    """Tell whether an estimate is made of numbers that the package allows."""
    fine = True
    for i in range(len(x)):
        fine = fine and abs(x[i]) <= LARGEST and P[i, i] <= LARGEST
    return fine


@kernel
def measurement_update(H, R, x, P, z, gates):
    """Correct a predicted x and P by a sighting z; NaN marks the entries that are missing.

    `gates` holds the largest NIS accepted, by the number of entries used. Returns x, P, K,
    innovation, S, NIS, log-likelihood, accepted.
    """
    innovation = z - vec(H, x)
    y, seen = without_missing(innovation)
    HP = mul(H, P)
    S = symmetric(mul(HP, transpose(H)) + R)
    K, S_inverse, used, log_det = gain(H, R, P, HP, S, seen)
    nis = quadratic(S_inverse, y) if used > 0 else np.nan
    accepted = nis <= gates[used]
    log_likelihood = -0.5 * (log_det + nis) if accepted else 0.0

    if not accepted:
        K = np.zeros_like(K)
    x = x + vec(K, y)  # eq 2.53, 2.58: x = x + K (z - H x)
    P = P - mul(K, HP)  # eq 2.59: P = (I - K H) P
    # For this K, P H' = K R. Removing what rounding leaves of the difference gives Joseph's form.
    P = symmetric(P - mul(mul(P, transpose(H)) - mul(K, R), transpose(K)))
    return x, P, K, innovation, S, nis, log_likelihood, accepted


# Smaller entries of a row of H A^p, beside its largest, are rounding errors.
FAINT = 1e-12


def _copied(values: Array) -> Array:
    """Return a writable copy in C order: the one kind of array that kernels are compiled for."""
    return np.array(values, order="C")


def _stack(name: str, value: ArrayLike, *shape: int | None) -> Array:
    """Return a matrix, or one for each row of a track."""
    x = array(name, value, None)
    x = array(name, x, (None, *shape) if x.ndim == 3 else shape)
    if x.ndim == 3 and len(x) == 0:
        raise ValueError(f"{name} must have at least one row, got shape {x.shape}")
    return _copied(x)


def _covariances(name: str, value: ArrayLike, n: int) -> Array:
    """Return a covariance, or one for each row of a track."""
    x = _stack(name, value, n, n)
    return _copied(covariance(name, x, n, stack=x.ndim == 3))


def check_growth(rows: bool = False, **arrays: Array) -> None:
    """Refuse estimates that are larger than any number allowed."""
    for name, values in arrays.items():
        if not -LARGEST <= values.min(initial=0) <= values.max(initial=0) <= LARGEST:  # or NaN
            beyond = ~(np.abs(values) <= LARGEST)
            where = f" in row {np.argwhere(beyond)[0, 0]}" if rows else ""
            raise ValueError(f"{name} has grown beyond {LARGEST:g}{where}: the filter diverges")


def _attribute(
    name: str, doc: str, check: Callable[[KalmanFilter, ArrayLike], Array] | None = None
) -> property:
    """Return a property whose array is read-only, and which can be assigned if there is a `check`.

    An edit in place is an error, since it would pass by the check.
    """

    def read(self: KalmanFilter) -> Array:
        view: Array = getattr(self, "_" + name).view()
        view.setflags(write=False)
        return view

    def assign(self: KalmanFilter, value: ArrayLike) -> None:
        if check is None:
            raise AttributeError(f"{name} is fixed; make a new KalmanFilter to change it")
        setattr(self, "_" + name, _copied(check(self, value)))

    return property(read, assign, doc=doc)


class KalmanFilter:
    """Estimate the state x of a linear system from noisy, incomplete sightings z.

    The system (thesis eq 2.49 to 2.52) has n states, m measurements and k control inputs::

        x_k = A x_{k-1} + B u_{k-1} + w,   w ~ N(0, Q)
        z_k = H x_k + v,                   v ~ N(0, R)

    A, H, Q, R and B may change along a track, for example where the time steps are uneven. Then
    they have one more axis, the first, with a matrix for each of the T rows of the track: A, B
    and Q of the step that leads to the row, H and R of its sighting. `filter` and `smooth` use
    such matrices; `predict` and `update`, which know no row, refuse them.

    Parameters
    ----------
    A : array_like, shape (n, n) or (T, n, n)
        State transition model.
    H : array_like, shape (m, n) or (T, m, n)
        Observation model.
    Q : array_like, shape (n, n) or (T, n, n)
        Covariance of the process noise w of one step: symmetric, positive semi-definite.
    R : array_like, shape (m, m) or (T, m, m)
        Covariance of the measurement noise v: symmetric, positive semi-definite.
    B : array_like, shape (n, k) or (T, n, k), optional
        Control-input model.
    x0 : array_like, shape (n,), optional
        Estimate before the first predict; zeros by default.
    P0 : array_like, shape (n, n), optional
        Covariance of `x0`. The default says that nothing is known, in any units: the variance of
        a state is 1e6 times what one sighting alone would leave, R_ii / H_ij**2. So the first
        sighting overrules `x0`. A state that is seen p steps later has ``H A**p`` in place of H.
        One that is never seen has the variance 1e6.
    gate : float, optional
        Probability in (0, 1) that a true sighting is accepted. A sighting whose NIS exceeds this
        quantile of the chi-square distribution is an outlier and is treated as missing. By
        default every sighting is accepted.

    Attributes
    ----------
    x, P : ndarray, shapes (n,) and (n, n)
        The current estimate and its covariance. Can be assigned.
    R : ndarray, shape (m, m) or (T, m, m)
        Can be assigned.
    K, innovation, S : ndarray, shapes (n, m), (m,) and (m, m)
        Gain (eq 2.57), z - H x, and its covariance H P H' + R at the last update.
    nis, log_likelihood, accepted : float, float and bool
        Of the last update: innovation' S^-1 innovation (NaN if nothing was seen), the log density
        of the sighting (0 if it was not used), and whether it was used.
    gate : float or None
        Can be assigned.
    A, H, Q, B, x0, P0 : ndarray
        As given. All arrays are read-only: assign a new one to change the filter.

    Raises
    ------
    ValueError
        If a matrix has the wrong shape or holds NaN, or a covariance is asymmetric or has a
        negative eigenvalue. Also in every step that takes x or P beyond 1e100, as where an
        unstable system is long unseen: the filter diverges.

    Notes
    -----
    A NaN or masked entry of z is missing. The other entries are used as they are; if all are
    missing, x and P stay as predicted. An entry that is already known exactly (R = 0 twice) adds
    nothing and is skipped, so that no singular matrix is inverted. However wide P is beside R,
    each entry with a noise of its own counts. P is updated in Joseph's form: it equals eq 2.59 and
    stays symmetric and positive after a million steps.

    Where the thesis misleads:

    - After eq 2.54 it says that K goes to H^-1 as R goes to 0. With fewer measurements than
      states H has no inverse: K becomes a right inverse, H K = I.
    - Section 5.2 sets R to the swings seen at far distances, 100 mm and .05 rad. R holds
      variances: as printed they mean sigma = 10 mm and .22 rad. A swing of 3 sigma gives
      R = diag(1111, .00028), one of 1 sigma diag(10^4, .0025).
    - Its Q = diag(.001, .0001, .0001, .000001) is very small beside that R. With dt = 1 the filter
      needs 30 updates to cover 90 % of a jump of the distance, as after a footstep or a reset.
      Footsteps are known: pass them as ``B u``. After a reset, call `reset`.

    References
    ----------
    Thesis section 2.5, eq 2.49 to 2.59. R. E. Kalman, "A new approach to linear filtering and
    prediction problems", Journal of Basic Engineering 82 (1960).

    Examples
    --------
    Two rulers that are equally good: the estimate is their mean, with half the variance.

    >>> ruler = KalmanFilter(A=[[1.0]], H=[[1.0]], Q=[[0.0]], R=[[4.0]], x0=[10.0], P0=[[4.0]])
    >>> ruler.predict()
    array([10.])
    >>> ruler.update([12.0])
    array([11.])
    >>> ruler.P
    array([[2.]])

    A ball seen through a gap:

    >>> from arkaq_edu import constant_velocity
    >>> A, H = constant_velocity(1.0, 1)
    >>> ball = KalmanFilter(A, H, Q=np.zeros((2, 2)), R=[[1.0]])
    >>> trace = ball.filter([[100.0], [200.0], [np.nan], [np.nan], [500.0]])
    >>> trace.x[:, 0].round()
    array([100., 200., 300., 400., 500.])

    The same ball seen at uneven times, with a matrix A for each step:

    >>> A = [constant_velocity(dt, 1)[0] for dt in (1.0, 1.0, 3.0)]
    >>> ball = KalmanFilter(A, H, Q=np.zeros((2, 2)), R=[[1.0]])
    >>> ball.filter([[100.0], [200.0], [500.0]]).x[-1].round()
    array([500., 100.])
    """

    def __init__(
        self,
        A: ArrayLike,
        H: ArrayLike,
        Q: ArrayLike,
        R: ArrayLike,
        B: ArrayLike | None = None,
        x0: ArrayLike | None = None,
        P0: ArrayLike | None = None,
        *,
        gate: float | None = None,
    ) -> None:
        self._A = _stack("A", A, None, None)
        n = self._A.shape[-2]
        self._A = _stack("A", self._A, n, n)
        self._H = _stack("H", H, None, n)
        self._Q = _covariances("Q", Q, n)
        self._B = np.zeros((n, 0)) if B is None else _stack("B", B, n, None)
        self._R = self._checked_R(R)
        self._x0 = np.zeros(n) if x0 is None else _copied(array("x0", x0, (n,)))
        self._P0 = self._unknown() if P0 is None else _copied(covariance("P0", P0, n))
        self.gate = gate
        self.reset()

    A = _attribute("A", "The state transition model.")
    H = _attribute("H", "The observation model.")
    Q = _attribute("Q", "The covariance of the process noise.")
    R = _attribute(
        "R", "The covariance of the measurement noise.", lambda self, value: self._checked_R(value)
    )
    B = _attribute("B", "The control-input model; it has no columns if none was given.")
    x0 = _attribute("x0", "The estimate before the first step.")
    P0 = _attribute("P0", "The covariance of `x0`.")
    x = _attribute("x", "The estimate.", lambda self, value: array("x", value, self._x0.shape))
    P = _attribute(
        "P", "The covariance of the estimate.",
        lambda self, value: covariance("P", value, len(self._x0)),
    )  # fmt: skip
    K = _attribute("K", "The gain of the last update.")
    innovation = _attribute("innovation", "The last z - H x.")
    S = _attribute("S", "The covariance of the last innovation.")

    @property
    def gate(self) -> float | None:
        """The probability that a true sighting is accepted, or None: all are."""
        return self._gate

    @gate.setter
    def gate(self, value: float | None) -> None:
        if value is not None:
            value = number("gate", value, 0, 1, open_low=True, open_high=True)
        self._gate = value
        m = self._H.shape[-2]
        self._gates = np.full(m + 1, np.inf)  # by the number of entries used
        if value is not None:
            self._gates[1:] = [chi_square_quantile(value, k + 1) for k in range(m)]

    def __repr__(self) -> str:
        (m, n), k = self._H.shape[-2:], self._B.shape[-1]
        return f"KalmanFilter({n} states, {m} measurements, {k} inputs)"

    def reset(self) -> None:
        """Forget all sightings: x and P go back to `x0` and `P0`."""
        m, n = self._H.shape[-2:]
        self._x, self._P = self._x0, self._P0
        self._K = np.zeros((n, m))
        self._S, self._innovation = np.full((m, m), np.nan), np.full(m, np.nan)
        self.nis, self.log_likelihood, self.accepted = np.nan, 0.0, False

    def predict(self, u: ArrayLike | None = None) -> Array:
        """Move the estimate one step ahead (time update, eq 2.55 and 2.56).

        Parameters
        ----------
        u : array_like, shape (k,), optional
            Control input of this step; zero by default.

        Returns
        -------
        ndarray, shape (n,)
            The predicted state.

        Raises
        ------
        ValueError
            If `u` has the wrong shape or is not finite, if the filter has no B, if A, B or Q
            changes along a track, or if the filter diverges.

        Examples
        --------
        >>> kf = KalmanFilter([[1]], [[1]], [[1]], [[1]], B=[[-100]], x0=[1500], P0=[[0]])
        >>> kf.predict([1.5])
        array([1350.])
        """
        if self._T is not None:
            self._need_one("predict", A=self._A, B=self._B, Q=self._Q)
        u = self._inputs("u", u, ())
        x, P = time_update(self._A, self._B, self._Q, self._x, self._P, u)
        if not bounded(x, P):
            check_growth(P=P, x=x)
        self._x, self._P = x, P
        return x.copy()

    def update(self, z: ArrayLike, R: ArrayLike | None = None) -> Array:
        """Correct the prediction by a sighting (measurement update, eq 2.57 to 2.59).

        Parameters
        ----------
        z : array_like, shape (m,)
            The measurements; NaN or masked where an entry is missing.
        R : array_like, shape (m, m), optional
            Noise covariance of this sighting alone; by default the filter's own.

        Returns
        -------
        ndarray, shape (n,)
            The corrected state.

        Raises
        ------
        ValueError
            If `z` has the wrong shape or is infinite, if `R` is not a covariance, if H or R
            changes along a track, or if the filter diverges.

        Examples
        --------
        >>> kf = KalmanFilter([[1]], [[1]], [[0]], [[1]], x0=[0], P0=[[1]])
        >>> kf.update([4.0], R=[[3.0]])
        array([1.])
        >>> kf.update([float("nan")])
        array([1.])
        """
        m = self._H.shape[-2]
        z = _copied(array("z", z, (m,), allow_nan=True))
        R = self._R if R is None else _copied(covariance("R", R, m))
        if self._T is not None:
            self._need_one("update", H=self._H, R=R)
        x, P, K, innovation, S, nis, log_likelihood, accepted = measurement_update(
            self._H, R, self._x, self._P, z, self._gates
        )
        if not bounded(x, P):
            check_growth(P=P, x=x)
        self._x, self._P, self._K, self._innovation, self._S = x, P, K, innovation, S
        self.nis, self.log_likelihood, self.accepted = nis, log_likelihood, accepted
        return x.copy()

    def filter(
        self, Z: ArrayLike, U: ArrayLike | None = None, R: ArrayLike | None = None
    ) -> KalmanTrace:
        """Filter a whole track from `x0` and `P0`: for each row one predict, then one update.

        The filter itself does not change. `compiled.track` computes all rows in one call.

        Parameters
        ----------
        Z : array_like, shape (T, m)
            Sightings; NaN or masked where an entry is missing.
        U : array_like, shape (T, k), optional
            Control input of the step that leads to each row; zero by default.
        R : array_like, shape (T, m, m), optional
            Noise covariance of each row; by default the filter's own.

        Returns
        -------
        KalmanTrace
            Every prior, posterior, gain and innovation.

        Raises
        ------
        ValueError
            If a shape is wrong, Z is infinite, U is not finite, R does not hold covariances, or
            the filter diverges.

        Examples
        --------
        >>> kf = KalmanFilter([[1]], [[1]], [[0]], [[1]], x0=[0], P0=[[1]])
        >>> trace = kf.filter([[3.0], [np.nan], [2.0]])
        >>> trace.x[:, 0]
        array([1.5 , 1.5 , 1.66666667])
        >>> trace.P[:, 0, 0]
        array([0.5 , 0.5 , 0.33333333])
        """
        from arkaq_edu.kalman.compiled import track  # it imports the equations above

        m, n = self._H.shape[-2:]
        Z = _copied(array("Z", Z, (self._T, m), allow_nan=True))
        T = len(Z)
        U = self._inputs("U", U, (T,)) if U is not None else np.zeros((1, self._B.shape[-1]))
        Rs = self._R
        if R is not None:
            Rs = _copied(covariance("R", array("R", R, (T, m, m)), m, stack=True))
        stacks = [M if M.ndim == 3 else M[None] for M in (self._A, self._B, self._H, self._Q, Rs)]
        shapes: dict[str, tuple[int, ...]] = {
            "x": (n,), "P": (n, n), "x_prior": (n,), "P_prior": (n, n),
            "innovation": (m,), "S": (m, m), "K": (n, m), "nis": (),
        }  # fmt: skip
        rows = {name: np.empty((T, *shape)) for name, shape in shapes.items()}
        accepted = np.empty(T, np.bool_)
        with np.errstate(all="ignore"):  # without numba an overflow warns before it is named below
            log_likelihood = track(
                *stacks, self._gates, self._x0, self._P0, Z, U, *rows.values(), accepted
            )
        check_growth(True, P=rows["P_prior"], x=rows["x_prior"])
        check_growth(True, P=rows["P"], x=rows["x"])
        return KalmanTrace(
            **rows, accepted=accepted, log_likelihood=log_likelihood, A=self.A, Q=self.Q
        )

    def smooth(self, trace: KalmanTrace) -> tuple[Array, Array]:
        """Estimate each row of a filtered track from all sightings, later ones included.

        The smoother of Rauch, Tung and Striebel.

        Parameters
        ----------
        trace : KalmanTrace
            What `filter` returned. It holds the A and Q of its own filter, which are used here.

        Returns
        -------
        x, P : ndarray, shapes (T, n) and (T, n, n)
            The smoothed estimates and their covariances.

        Raises
        ------
        ValueError
            If `trace` is not a trace, or has another number of states.

        References
        ----------
        H. E. Rauch, F. Tung and C. T. Striebel, "Maximum likelihood estimates of linear dynamic
        systems", AIAA Journal 3 (1965). Not in the thesis.

        Examples
        --------
        For an object at rest every row ends at the mean.

        >>> kf = KalmanFilter([[1]], [[1]], [[0]], [[1]], P0=[[1e9]])
        >>> x, P = kf.smooth(kf.filter([[1.0], [2.0], [6.0]]))
        >>> x[:, 0].round(6)
        array([3., 3., 3.])
        """
        from arkaq_edu.kalman.compiled import smoothed

        if not isinstance(trace, KalmanTrace):
            raise ValueError(f"trace must be a KalmanTrace, got {shown(trace)}")
        x = _copied(array("trace.x", trace.x, (None, len(self._x0))))
        A, Q = (_copied(M if M.ndim == 3 else M[None]) for M in (trace.A, trace.Q))
        P = trace.P.copy()
        smoothed(A, Q, x, P, trace.x_prior, trace.P_prior)
        return x, P

    def _unknown(self) -> Array:
        """Return a P0 beside which one sighting is a million times more certain."""
        A, H, Q, R = (M if M.ndim == 3 else M[None] for M in (self._A, self._H, self._Q, self._R))
        variances = np.zeros(H.shape[-1])
        with np.errstate(all="ignore"):
            noise = R.diagonal(axis1=1, axis2=2)
            for instead in ((H @ Q @ H.swapaxes(1, 2)).diagonal(axis1=1, axis2=2), 1.0):
                noise = np.where(noise > 0, noise, instead)
            for _ in variances:  # at the latest after n steps, H A^p shows what it can
                size = np.abs(H)
                sees = size > FAINT * size.max(axis=-1, keepdims=True)
                found = np.where(sees, noise[..., None] / H**2, 0).max(axis=(0, 1), initial=0)
                variances = np.where(variances > 0, variances, found)
                H = H @ A[0]
        variances[variances == 0] = 1.0
        return np.diag(np.minimum(1e6 * variances, LARGEST))

    def _checked_R(self, value: ArrayLike) -> Array:
        """Return a new R; note for how many rows there are matrices, or None if none changes."""
        R = _covariances("R", value, self._H.shape[-2])
        matrices = {"A": self._A, "H": self._H, "Q": self._Q, "B": self._B, "R": R}
        lengths = {name: len(M) for name, M in matrices.items() if M.ndim == 3}
        for name, rows in lengths.items():
            first, T = next(iter(lengths.items()))
            if rows != T:
                raise ValueError(f"{name} must have {T} rows, as {first} has, got {rows}")
        self._T = next(iter(lengths.values()), None)
        return R

    def _need_one(self, method: str, **matrices: Array) -> None:
        """Refuse matrices that change along a track."""
        for name, M in matrices.items():
            if M.ndim == 3:
                raise ValueError(
                    f"{name} must be one matrix for {method}, got one for each of {len(M)} rows; "
                    "only filter and smooth can use these"
                )

    def _inputs(self, name: str, u: ArrayLike | None, rows: tuple[int, ...]) -> Array:
        """Return checked control inputs, zeros if there are none."""
        k = self._B.shape[-1]
        if u is None:
            return np.zeros((*rows, k))
        if k == 0:
            raise ValueError(f"{name} must be None for a filter without B, got {shown(u)}")
        return _copied(array(name, u, (*rows, k)))

"""The Kalman filter, step by step and over a whole track."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from arkaq_edu._checks import array, covariance, number
from arkaq_edu.kalman import compiled
from arkaq_edu.kalman.consistency import chi_square_band, chi_square_quantile

Array = NDArray[np.float64]

# Which plane of the memory a matrix lives in, and its shape.
_PLANES = {
    "A": (compiled.A, "nn"),
    "Q": (compiled.Q, "nn"),
    "P": (compiled.P, "nn"),
    "H": (compiled.H, "mn"),
    "R": (compiled.R, "mm"),
    "K": (compiled.K, "nm"),
    "S": (compiled.S, "mm"),
}
_NOT_A_SIGHTING = (-1.0, 0.0, False)


@dataclass(frozen=True)
class KalmanTrace:
    """Everything a filter knew along a track of T rows, with n states and m measurements.

    Attributes
    ----------
    x, P : ndarray, shapes (T, n) and (T, n, n)
        Estimate and its covariance after each row (posterior).
    x_prior, P_prior : ndarray, shapes (T, n) and (T, n, n)
        The same before the row's sighting was used (prediction).
    innovation : ndarray, shape (T, m)
        z - H x_prior; NaN where an entry of z was missing.
    S : ndarray, shape (T, m, m)
        Covariance the innovation should have, H P_prior H' + R.
    K : ndarray, shape (T, n, m)
        Gain as it was used: a missing entry has a column of zeros.
    nis : ndarray, shape (T,)
        Normalized innovation squared, innovation' S^-1 innovation; NaN for a missing sighting.
    accepted : ndarray of bool, shape (T,)
        Whether the row's sighting was used: False when it was missing or failed the gate.
    log_likelihood : float
        Logarithm of the probability density of all sightings that were used.
    """

    x: Array
    P: Array
    x_prior: Array
    P_prior: Array
    innovation: Array
    S: Array
    K: Array
    nis: Array
    accepted: NDArray[np.bool_]
    log_likelihood: float

    def nis_band(self, probability: float = 0.95) -> tuple[float, float, float]:
        """Return the mean NIS of the track and the band in which a right filter keeps it.

        If A, H, Q and R are right, innovations are independent and their NIS sum to a chi-square
        variable. A mean above the band says that the filter is too sure of itself (Q or R too
        small), a mean below it that it is too modest. A gate keeps the largest NIS out of the mean.

        Parameters
        ----------
        probability : float, default 0.95
            With which the mean of a right filter falls inside, in (0, 1).

        Returns
        -------
        mean, low, high : float
            Over the rows whose sighting was used. NaN if there are none.

        Raises
        ------
        ValueError
            If `probability` is not in (0, 1).

        References
        ----------
        Y. Bar-Shalom, X. R. Li and T. Kirubarajan, Estimation with Applications to Tracking and
        Navigation (2001), section 5.4.

        Examples
        --------
        A filter told that sigma is 10 mm where it is 30:

        >>> seen = np.random.default_rng(0).normal(0.0, 30.0, (200, 1))
        >>> kf = KalmanFilter([[1]], [[1]], [[0]], [[10.0**2]])
        >>> mean, low, high = kf.filter(seen).nis_band()
        >>> print(f"{mean:.1f}, but a right filter stays in [{low:.2f}, {high:.2f}]")
        8.3, but a right filter stays in [0.81, 1.21]
        """
        rows = int(self.accepted.sum())
        entries = int((~np.isnan(self.innovation[self.accepted])).sum())
        if rows == 0:
            return np.nan, np.nan, np.nan
        low, high = chi_square_band(entries / rows, rows, probability)
        return float(self.nis[self.accepted].mean()), low, high


def _numbers(value: ArrayLike) -> Array:
    """Return `value` as the one kind of array that kernels are compiled for, or an empty one."""
    try:
        numbers = np.asarray(value, np.float64)
    except (TypeError, ValueError):
        return np.empty(0)
    return numbers if numbers.flags.carray else numbers.copy()


def _snapshot(
    name: str, doc: str, check: Callable[[KalmanFilter, ArrayLike], Array] | None = None
) -> property:
    """Return a property that reads a read-only copy of `name` and, given `check`, assigns it.

    Read-only, so that an edit in place, which would change only the copy, is not lost in silence.
    """

    def read(self: KalmanFilter) -> Array:
        copy = self._own(name).copy()
        copy.setflags(write=False)
        return copy

    def assign(self: KalmanFilter, value: ArrayLike) -> None:
        if check is None:
            raise AttributeError(f"{name} is fixed; make a new KalmanFilter to change it")
        self._own(name)[:] = check(self, value)

    return property(read, assign, doc=doc)


class KalmanFilter:
    """Estimate the state x of a linear system from noisy, incomplete sightings z.

    The system (thesis eq 2.49 to 2.52) has n states, m measurements and k control inputs::

        x_k = A x_{k-1} + B u_{k-1} + w,   w ~ N(0, Q)
        z_k = H x_k + v,                   v ~ N(0, R)

    Parameters
    ----------
    A : array_like, shape (n, n)
        State transition model.
    H : array_like, shape (m, n)
        Observation model.
    Q : array_like, shape (n, n)
        Covariance of the process noise w of one step: symmetric, positive semi-definite.
    R : array_like, shape (m, m)
        Covariance of the measurement noise v: symmetric, positive semi-definite.
    B : array_like, shape (n, k), optional
        Control-input model.
    x0 : array_like, shape (n,), optional
        Estimate before the first predict; zeros by default.
    P0 : array_like, shape (n, n), optional
        Its covariance. By default nothing is known: every state has the variance 1e6, or 1e6 times
        the largest R_ii / (H H')_ii if that is more. So the first sighting is a million times
        surer than `x0` and overrules it, and nothing is known of the states it does not show.
    gate : float, optional
        Probability in (0, 1) with which a true sighting shall pass. A sighting whose NIS exceeds
        this quantile of the chi-square distribution is an outlier and is treated as missing.
        By default everything passes.

    Attributes
    ----------
    x, P : ndarray, shapes (n,) and (n, n)
        The estimate now and its covariance. May be assigned.
    R : ndarray, shape (m, m)
        May be assigned, where the noise changes between sightings.
    K, innovation, S : ndarray, shapes (n, m), (m,) and (m, m)
        Gain (eq 2.57), z - H x and its covariance H P H' + R at the last update.
    nis, log_likelihood, accepted : float, float and bool
        Of the last update: innovation' S^-1 innovation (NaN if nothing was seen), the log density
        of the sighting (0 if it was not used), and whether it was used.
    gate : float or None
        May be assigned.
    A, H, Q, B, x0, P0 : ndarray
        As given. Arrays read from the filter are read-only copies: later steps do not change
        them, and to change the filter one assigns, which is checked.

    Raises
    ------
    ValueError
        If a matrix has the wrong shape or holds NaN, or a covariance is asymmetric or has a
        negative eigenvalue.

    Notes
    -----
    A NaN in z is a missing entry: the others are used as they are, and if all are missing x and P
    stay as predicted. A sighting, or an entry of one, that is already known exactly (R = 0 twice)
    says nothing new and is passed over, so no matrix is ever singular. P is updated in Joseph's
    form: equal to eq 2.59, and still symmetric and positive after a million steps.

    Where the thesis misleads:

    - After eq 2.54 it says that K goes to H^-1 as R goes to 0. With fewer measurements than
      states H has no inverse: K becomes a right inverse, H K = I.
    - Section 5.2 sets R to the swings seen at far distances, 100 mm and .05 rad. R holds
      variances: as printed they mean sigma = 10 mm and .22 rad. A swing of 3 sigma gives
      R = diag(1111, .00028), one of 1 sigma diag(10^4, .0025).
    - Its Q = diag(.001, .0001, .0001, .000001) is so small beside that R that with dt = 1 a jump of
      the distance, as after a footstep or a reset, takes 30 updates to be believed to 90 %.
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
        n = len(array("A", A, (None, None)))
        A = array("A", A, (n, n))
        m = len(array("H", H, (None, n)))
        self._memory = np.zeros((len(compiled.PLANES), max(n, m), max(n, m)))
        self._x, self._innovation, self._no_push = np.zeros(n), np.zeros(m), np.zeros(n)
        self._z_shape = (m,)
        self._own("A")[:], self._own("H")[:] = A, H
        self._own("Q")[:] = covariance("Q", Q, n)
        self._own("R")[:] = covariance("R", R, m)
        self._B = np.zeros((n, 0)) if B is None else np.array(array("B", B, (n, None)))
        self._x0 = np.zeros(n) if x0 is None else np.array(array("x0", x0, (n,)))
        self._P0 = self._wide() if P0 is None else np.array(covariance("P0", P0, n), order="C")
        self.gate = gate
        self.reset()

    x = _snapshot("x", "The estimate.", lambda self, value: array("x", value, self._x.shape))
    P = _snapshot(
        "P",
        "The covariance of the estimate.",
        lambda self, value: covariance("P", value, self._x.size),
    )
    R = _snapshot(
        "R", "The covariance of the measurement noise.", lambda self, value: self._noise(value)
    )
    A = _snapshot("A", "The state transition model.")
    H = _snapshot("H", "The observation model.")
    Q = _snapshot("Q", "The covariance of the process noise.")
    B = _snapshot("B", "The control-input model; without one it has no columns.")
    x0 = _snapshot("x0", "The estimate before the first step.")
    P0 = _snapshot("P0", "The covariance of `x0`.")
    K = _snapshot("K", "The gain of the last update.")
    S = _snapshot("S", "The covariance of the last innovation.")
    innovation = _snapshot("innovation", "The last z - H x.")

    @property
    def gate(self) -> float | None:
        """The probability with which a true sighting passes, or None: all do."""
        return self._gate

    @gate.setter
    def gate(self, value: float | None) -> None:
        self._gates = np.full(self._innovation.size + 1, np.inf)  # by the number of entries seen
        self._gate = value
        if value is not None:
            self._gate = number("gate", value, 0, 1, open_low=True, open_high=True)
            for seen in range(1, len(self._gates)):
                self._gates[seen] = chi_square_quantile(self._gate, seen)

    def __repr__(self) -> str:
        sizes = f"{self._x.size} states, {self._innovation.size} measurements"
        return f"KalmanFilter({sizes}, {self._B.shape[1]} inputs)"

    def reset(self) -> None:
        """Forget everything seen: x and P go back to `x0` and `P0`."""
        self._x[:] = self._x0
        self._own("P")[:] = self._P0
        self._own("K")[:] = 0
        self._own("S")[:] = np.nan
        self._innovation[:] = np.nan
        self.nis, self.log_likelihood, self.accepted = np.nan, 0.0, False

    def predict(self, u: ArrayLike | None = None) -> Array:
        """Move one step ahead without looking (time update, eq 2.55 and 2.56).

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
            If `u` has the wrong shape, is not finite, or comes to a filter without B.

        Examples
        --------
        >>> kf = KalmanFilter([[1]], [[1]], [[1]], [[1]], B=[[-100]], x0=[1500], P0=[[0]])
        >>> kf.predict([1.5])
        array([1350.])
        """
        push = self._no_push if u is None else self._pushes("u", u, ())
        compiled.predict(self._memory, push, self._x)
        return self._x.copy()

    def update(self, z: ArrayLike, R: ArrayLike | None = None) -> Array:
        """Correct the prediction by a sighting (measurement update, eq 2.57 to 2.59).

        Parameters
        ----------
        z : array_like, shape (m,)
            What was measured; NaN where an entry is missing.
        R : array_like, shape (m, m), optional
            Noise of this sighting alone, as when far ones are noisier; else the filter's own.

        Returns
        -------
        ndarray, shape (n,)
            The corrected state.

        Raises
        ------
        ValueError
            If `z` has the wrong shape or is infinite, or `R` is no covariance.

        Examples
        --------
        >>> kf = KalmanFilter([[1]], [[1]], [[0]], [[1]], x0=[0], P0=[[1]])
        >>> kf.update([4.0], R=[[3.0]])
        array([1.])
        >>> kf.update([float("nan")])
        array([1.])
        """
        if R is not None:
            own = self._own("R")
            usual, own[:] = own.copy(), self._noise(R)
            try:
                return self.update(z)
            finally:
                own[:] = usual
        sighting = _numbers(z)
        scores = _NOT_A_SIGHTING
        if sighting.shape == self._z_shape:
            scores = compiled.update(self._memory, self._gates, sighting, self._x, self._innovation)
        if scores[0] == -1.0:
            array("z", z, self._z_shape, allow_nan=True)
        self.nis, self.log_likelihood, self.accepted = scores
        return self._x.copy()

    def filter(
        self, Z: ArrayLike, U: ArrayLike | None = None, R: ArrayLike | None = None
    ) -> KalmanTrace:
        """Filter a whole track from `x0` and `P0`: each row is one predict, then one update.

        The filter itself is not changed, so the same call gives the same trace.

        Parameters
        ----------
        Z : array_like, shape (T, m)
            Sightings; NaN where an entry is missing.
        U : array_like, shape (T, k), optional
            Control input of the step that leads to each row; zero by default.
        R : array_like, shape (T, m, m), optional
            Noise of each row, where it changes along the track; else the filter's own.

        Returns
        -------
        KalmanTrace
            Every prior, posterior, gain and innovation.

        Raises
        ------
        ValueError
            If a shape is wrong, Z holds an infinity, U is not finite or R holds no covariances.

        Examples
        --------
        >>> kf = KalmanFilter([[1]], [[1]], [[0]], [[1]], x0=[0], P0=[[1]])
        >>> trace = kf.filter([[3.0], [np.nan], [2.0]])
        >>> trace.x[:, 0]
        array([1.5 , 1.5 , 1.66666667])
        >>> trace.P[:, 0, 0]
        array([0.5 , 0.5 , 0.33333333])
        """
        n, m = self._x.size, self._innovation.size
        Z = np.array(array("Z", Z, (None, m), allow_nan=True), order="C")
        T = len(Z)
        pushes = self._no_push[np.newaxis] if U is None else self._pushes("U", U, (T,))
        noise = np.empty((0, m, m))
        if R is not None:
            noise = np.array(array("R", R, (T, m, m)), order="C")
            for t in range(T):
                noise[t] = self._noise(noise[t])
        shapes: dict[str, tuple[int, ...]] = {
            "x": (n,), "P": (n, n), "x_prior": (n,), "P_prior": (n, n),
            "innovation": (m,), "S": (m, m), "K": (n, m), "nis": (),
        }  # fmt: skip
        rows = {name: np.empty((T, *shape)) for name, shape in shapes.items()}
        accepted = np.empty(T, np.bool_)
        memory = self._memory.copy()
        memory[compiled.P, :n, :n] = self._P0
        log_likelihood = compiled.track(
            memory, noise, pushes, self._gates, self._x0.copy(), Z, *rows.values(), accepted
        )
        return KalmanTrace(**rows, accepted=accepted, log_likelihood=log_likelihood)

    def smooth(self, trace: KalmanTrace) -> tuple[Array, Array]:
        """Look back along a filtered track: estimate each row from all sightings, later ones too.

        The smoother of Rauch, Tung and Striebel. The next state is a sighting of this one, with A
        for H and Q for R, so a row is smoothed by one more measurement update.

        Parameters
        ----------
        trace : KalmanTrace
            What `filter` returned, of this filter.

        Returns
        -------
        x, P : ndarray, shapes (T, n) and (T, n, n)
            The smoothed estimates and their covariances.

        Raises
        ------
        ValueError
            If the trace has another number of states.

        References
        ----------
        H. E. Rauch, F. Tung and C. T. Striebel, "Maximum likelihood estimates of linear dynamic
        systems", AIAA Journal 3 (1965). Not in the thesis.

        Examples
        --------
        A standing thing: in the end all rows agree on the mean.

        >>> kf = KalmanFilter([[1]], [[1]], [[0]], [[1]], P0=[[1e9]])
        >>> x, P = kf.smooth(kf.filter([[1.0], [2.0], [6.0]]))
        >>> x[:, 0].round(6)
        array([3., 3., 3.])
        """
        n = self._x.size
        x, P = np.array(array("trace.x", trace.x, (None, n))), trace.P.copy()
        memory = np.zeros((len(compiled.PLANES), n, n))
        memory[compiled.H], memory[compiled.R] = self._own("A"), self._own("Q")
        compiled.smooth(memory, x, P, trace.x_prior)
        return x, P

    def _own(self, name: str) -> Array:
        """Return the filter's own array of that name, to read or to fill."""
        if name not in _PLANES:
            vector: Array = getattr(self, "_" + name)
            return vector
        plane, shape = _PLANES[name]
        rows, columns = (self._x.size if axis == "n" else self._innovation.size for axis in shape)
        return self._memory[plane, :rows, :columns]

    def _wide(self) -> Array:
        """Return a P0 beside which one sighting is a million times surer."""
        reach = (self._own("H") ** 2).sum(axis=1)
        variances = np.diag(self._own("R"))[reach > 0] / reach[reach > 0]
        return 1e6 * float(variances.max(initial=1.0)) * np.eye(self._x.size)

    def _noise(self, R: ArrayLike) -> Array:
        """Return R as a covariance, checked by a quick look where that is enough."""
        m = self._innovation.size
        own = _numbers(R)
        quick = own.shape == (m, m) and compiled.is_covariance(own)
        return own if quick else covariance("R", R, m)

    def _pushes(self, name: str, u: ArrayLike, rows: tuple[int, ...]) -> Array:
        """Return B u for each row of u."""
        if self._B.shape[1] == 0:
            raise ValueError(f"{name} must be None for a filter without B, got {u!r}")
        return np.ascontiguousarray(array(name, u, (*rows, self._B.shape[1])) @ self._B.T)

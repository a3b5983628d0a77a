"""The Kalman filter: four states, two measurements, a ball that rolls away."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial

import numpy as np

from arkaq_edu.kalman import KalmanFilter, constant_velocity, kalman_batch
from benchmarks.case import Case, Growth, Run, installed

A, H = constant_velocity(0.64, 2)
Q, R = np.diag([1.0, 1e-5, 100.0, 1e-3]), np.diag([1111.0, 2.8e-4])
P0 = np.diag([1e6, 1.0, 1e4, 1.0])


def sightings(*shape: int, gaps: float = 0.0) -> np.ndarray:
    """Return what is seen of balls that roll away at 100 mm/s, shape (..., T, 2)."""
    rng = np.random.default_rng(0)
    noise = rng.normal(size=(*shape, 2)) * [100 / 3, 0.05 / 3]
    Z = noise + np.stack([64.0 * np.arange(shape[-1]), np.zeros(shape[-1])], axis=-1)
    return np.where(rng.random(Z.shape) < gaps, np.nan, Z)


def filterpy():
    from filterpy.kalman import KalmanFilter as Peer

    peer = Peer(dim_x=4, dim_z=2)
    peer.F, peer.H, peer.Q, peer.R, peer.x, peer.P = A, H, Q, R, np.zeros(4), P0.copy()
    return peer


def fast_kalman():
    import kalman

    peer = kalman.LinearKalmanFilter(4, 2)
    peer.x, peer.P = [0.0] * 4, P0.ravel().tolist()
    peer.F, peer.H, peer.Q, peer.R = (matrix.ravel().tolist() for matrix in (A, H, Q, R))
    return peer


def stepped(kf, Z: np.ndarray, predicts: bool = True) -> Run:
    """Return a run that takes a filter through Z from Python."""

    def run() -> None:
        for z in Z:
            if predicts:
                kf.predict()
            kf.update(z)

    return run


def whole_track_peers(Z: np.ndarray) -> dict[str, tuple[float, Run]]:
    """Filter and smooth a whole track."""
    peers: dict[str, tuple[float, Run]] = {}
    if installed("pykalman"):
        from pykalman import KalmanFilter as Peer

        peer = Peer(A, H, Q, R, initial_state_mean=np.zeros(4), initial_state_covariance=P0)
        peers["pykalman"] = len(Z), lambda: peer.smooth(Z)
    if installed("filterpy"):

        def smooth() -> None:
            kf = filterpy()
            x, P, _, _ = kf.batch_filter(Z)
            kf.rts_smoother(x, P)

        peers["filterpy"] = len(Z), smooth
    if installed("statsmodels"):
        from statsmodels.tsa.statespace.mlemodel import MLEModel

        model = MLEModel(Z, k_states=4, initialization="known", initial_state=np.zeros(4),
                         initial_state_cov=P0)  # fmt: skip
        model["design"], model["transition"], model["selection"] = H, A, np.eye(4)
        model["state_cov"], model["obs_cov"] = Q, R
        peers["statsmodels"] = len(Z), lambda: model.ssm.smooth()
    return peers


def batch_peers(Z: np.ndarray) -> dict[str, tuple[float, Run]]:
    if not installed("simdkalman"):
        return {}
    import simdkalman

    peer = simdkalman.KalmanFilter(A, Q, H, R)
    options = {"initial_value": np.zeros(4), "initial_covariance": P0}
    run = lambda: peer.compute(Z, 0, filtered=True, smoothed=False, **options)  # noqa: E731
    return {"simdkalman": (Z[..., 0].size, run)}


def cases() -> Iterator[Case | Growth]:
    kf = KalmanFilter(A, H, Q, R, P0=P0)
    short, long = sightings(200), sightings(20_000)
    peers: dict[str, tuple[float, Run]] = {}
    if installed("filterpy"):
        peers["filterpy"] = len(short), stepped(filterpy(), short)
    if installed("kalman"):
        peers["fast-kalman"] = len(short), stepped(fast_kalman(), short, predicts=False)
    yield Case("predict and update, from Python", "step", 200, stepped(kf, short), peers)
    peers = {}
    if installed("kalman"):
        peers["fast-kalman (last state)"] = len(long), lambda: fast_kalman().update_many(long)
    yield Case("a track in one call", "row", len(long), lambda: kf.filter(long), peers)
    ours = lambda: kf.smooth(kf.filter(short))  # noqa: E731
    yield Case("filter and smooth", "row", len(short), ours, whole_track_peers(short))
    for title, gaps, wanted in (
        ("300 tracks of 500 rows", 0.0, {}),
        ("the same, a tenth missing", 0.1, {"simdkalman": 8.0}),
    ):
        many = sightings(300, 500, gaps=gaps)
        ours = lambda many=many: kalman_batch(A, H, Q, R, many, P0=P0)  # noqa: E731
        yield Case(title, "row", many[..., 0].size, ours, batch_peers(many), wanted)
    yield Growth(
        "kalman_batch, 200 rows with gaps", "tracks", [64, 256, 1024, 4096],
        lambda n: partial(kalman_batch, A, H, Q, R, sightings(n, 200, gaps=0.1), P0=P0),
    )  # fmt: skip

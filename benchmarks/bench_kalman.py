"""The Kalman filter against other libraries, run in turn in one process.

    python benchmarks/bench_kalman.py

Four states, two measurements: a ball seen by its distance and orientation. A peer that is not
installed (filterpy, fast-kalman, simdkalman) is left out, with a word. A round runs ourselves and
every peer once, so that a busy machine slows all of them alike; times are the medians of the
rounds, the ratio is the median of the ratios of the rounds. All times are per predict and update.
"""

from __future__ import annotations

import importlib.util
import statistics
import time
from collections.abc import Callable

import numpy as np

from arkaq_edu.kalman import KalmanFilter, constant_velocity, kalman_batch

A, H = constant_velocity(0.64, 2)
Q, R = np.diag([1.0, 1e-5, 100.0, 1e-3]), np.diag([1111.0, 2.8e-4])
P0 = np.diag([1e6, 1.0, 1e4, 1.0])
Run = Callable[[], object]


def sightings(*shape: int) -> np.ndarray:
    """Return what is seen of balls that roll away at 100 mm/s, shape (..., T, 2)."""
    rng = np.random.default_rng(0)
    noise = rng.normal(size=(*shape, 2)) * [100 / 3, 0.05 / 3]
    return noise + np.stack([64.0 * np.arange(shape[-1]), np.zeros(shape[-1])], axis=-1)


def seconds(run: Run) -> float:
    start = time.perf_counter()
    run()
    return time.perf_counter() - start


def compare(
    title: str, steps: int, ours: Run, peers: dict[str, tuple[int, Run]], rounds: int
) -> None:
    """Time `ours` (of so many steps) and each peer (of its own number of steps) in turn."""
    ours()
    times = []
    for _ in range(rounds):
        mine = seconds(ours) / steps
        times.append((mine, {name: seconds(run) / n for name, (n, run) in peers.items()}))
    mine = statistics.median(t[0] for t in times)
    print(f"{title:50} {mine * 1e9:10,.1f} ns")
    for name in peers:
        peer = statistics.median(t[1][name] for t in times)
        ratio = statistics.median(t[1][name] / t[0] for t in times)
        print(f"    {name:46} {peer * 1e9:10,.1f} ns   we: {ratio:,.1f} times")


def installed(name: str, package: str) -> bool:
    if importlib.util.find_spec(name) is None:
        print(f"({package} is not installed: left out)")
        return False
    return True


def filterpy_filter():
    from filterpy.kalman import KalmanFilter as Peer

    peer = Peer(dim_x=4, dim_z=2)
    peer.F, peer.H, peer.Q, peer.R, peer.x, peer.P = A, H, Q, R, np.zeros(4), P0.copy()
    return peer


def fast_kalman_filter():
    import kalman

    peer = kalman.LinearKalmanFilter(4, 2)
    peer.x, peer.P = [0.0] * 4, P0.ravel().tolist()
    peer.F, peer.H, peer.Q, peer.R = (matrix.ravel().tolist() for matrix in (A, H, Q, R))
    return peer


def stepped(kf, Z: np.ndarray) -> Run:
    """Return a run that takes a filter through Z from Python, as filterpy and we do it."""

    def run() -> None:
        for z in Z:
            kf.predict()
            kf.update(z)

    return run


def updated(peer, Z: np.ndarray) -> Run:
    """Return a run of a filter whose update predicts first."""

    def run() -> None:
        for z in Z:
            peer.update(z)

    return run


def main() -> None:
    """Print all comparisons."""
    start = time.perf_counter()
    kf = KalmanFilter(A, H, Q, R, P0=P0)
    kf.filter(sightings(3))
    kf.predict()
    kf.update([0.0, 0.0])
    print(f"first calls, compiled or loaded from the cache: {time.perf_counter() - start:.2f} s")

    has = {
        "filterpy": installed("filterpy", "filterpy"),
        "fast": installed("kalman", "fast-kalman"),
        "simd": installed("simdkalman", "simdkalman"),
    }
    short, long, many = sightings(500), sightings(100_000), sightings(1000, 1000)

    gappy = np.where(np.random.default_rng(1).random(many.shape) < 0.1, np.nan, many)
    stepping, track, batch, gappy_batch = {}, {}, {}, {}
    if has["filterpy"]:
        stepping["filterpy"] = len(short), stepped(filterpy_filter(), short)
        track["filterpy, 500 rows"] = len(short), lambda: filterpy_filter().batch_filter(short)
    if has["fast"]:
        run = updated(fast_kalman_filter(), short)
        stepping["fast-kalman (C++), predict and update in one call"] = len(short), run
        run = lambda: fast_kalman_filter().update_many(long)  # noqa: E731
        track["fast-kalman (C++), keeps the last state only"] = len(long), run
    if has["simd"]:
        import simdkalman

        peer = simdkalman.KalmanFilter(A, Q, H, R)
        start_at = {"initial_value": np.zeros(4), "initial_covariance": P0}
        options = {"filtered": True, "smoothed": False} | start_at
        batch["simdkalman"] = many[..., 0].size, lambda: peer.compute(many, 0, **options)
        gappy_batch["simdkalman"] = many[..., 0].size, lambda: peer.compute(gappy, 0, **options)

    ours = stepped(kf, short)
    compare("predict and update called from Python", len(short), ours, stepping, rounds=41)
    compare("a track of 100,000 rows, all kept", len(long), lambda: kf.filter(long), track, 9)
    gaps = long.copy()
    gaps[::10] = np.nan
    compare("the same, every tenth sighting missing", len(gaps), lambda: kf.filter(gaps), {}, 9)
    ours = lambda: kalman_batch(A, H, Q, R, many, P0=P0)  # noqa: E731
    compare("1,000 tracks of 1,000 rows", many[..., 0].size, ours, batch, rounds=5)
    ours = lambda: kalman_batch(A, H, Q, R, gappy, P0=P0)  # noqa: E731
    title = "the same, a tenth of the entries missing"
    compare(title, gappy[..., 0].size, ours, gappy_batch, rounds=5)


if __name__ == "__main__":
    main()

"""The ART room against other libraries, run in turn in one process.

    python benchmarks/bench_art.py

A peer that is not installed (artlib) is left out, with a word. A round runs ourselves and every
peer once, so that a busy machine slows all of them alike; times are the medians of the rounds,
the ratio is the median of the ratios of the rounds. All times are per pattern. A slow peer gets the
beginning of the stream only, which flatters it: it has fewer categories to search then.
"""

from __future__ import annotations

import contextlib
import importlib
import importlib.util
import io
import statistics
import time
import warnings
from collections.abc import Callable
from functools import partial

import numpy as np
from scipy.spatial import cKDTree
from sklearn.cluster import Birch

from arkaq_edu.art import ART1, ART2, ART2A, EuclideanART

ROUNDS = 5
Run = Callable[[], object]


def seconds(run: Run, patterns: int) -> float:
    start = time.perf_counter()
    run()
    return (time.perf_counter() - start) / patterns


def compare(title: str, patterns: int, ours: Run, **peers: tuple[int, Run]) -> None:
    """Time `ours` and each peer, with its own number of patterns, in turn."""
    ours()
    for _, run in peers.values():
        run()
    rounds = []
    for _ in range(ROUNDS):
        mine = seconds(ours, patterns)
        rounds.append((mine, {name: seconds(run, n) for name, (n, run) in peers.items()}))
    mine = statistics.median(r[0] for r in rounds)
    print(f"{title:44} {mine * 1e6:11.3f} us {1 / mine:13,.0f} /s")
    for name in peers:
        peer = statistics.median(r[1][name] for r in rounds)
        ratio = statistics.median(r[1][name] / r[0] for r in rounds)
        label = f"    {name.replace('_', ' ')}"
        print(f"{label:44} {peer * 1e6:11.3f} us {1 / peer:13,.0f} /s   we: {ratio:,.1f} times")


def quiet(run: Run) -> Run:
    """Return `run` without what it prints and warns."""

    def silently() -> object:
        with warnings.catch_warnings(), contextlib.redirect_stdout(io.StringIO()):
            warnings.simplefilter("ignore")
            return run()

    return silently


def artlib(path: str, *parameters: float) -> Callable[[np.ndarray], Run] | None:
    """Return what fits an artlib network to patterns in [0, 1], or None without artlib."""
    try:
        module, name = path.rsplit(".", 1)
        network = getattr(importlib.import_module(f"artlib.{module}"), name)
    except ImportError:
        return None

    def fitting(X: np.ndarray) -> Run:
        def run() -> object:
            model = network(*parameters)
            return model.fit(model.prepare_data(X))

        return quiet(run)

    return fitting


def brute_force(X: np.ndarray, vigilance: float, eta: float = 0.5) -> np.ndarray:
    """Return the centers, found by comparing every pattern with every center, in numpy."""
    centers, n = np.empty_like(X), 0
    for x in X:
        d2 = ((centers[:n] - x) ** 2).sum(axis=1)
        j = d2.argmin() if n else -1
        if n and d2[j] < vigilance**2:
            centers[j] += eta * (x - centers[j])
        else:
            centers[n] = x
            n += 1
    return centers[:n]


def euclidean() -> None:
    """Segmentation: the same at every vigilance, so flat in the number of centers."""
    X = np.random.default_rng(0).uniform(-1, 1, (20_000, 2))
    unit_square = (X + 1) / 2
    for vigilance in (0.15, 0.05, 0.025):
        n = EuclideanART(vigilance).fit(X).n_clusters_
        peers = {
            "numpy, every center": (len(X), partial(brute_force, X, vigilance)),
            "scikit-learn Birch": (
                len(X),
                quiet(partial(Birch(threshold=vigilance, n_clusters=None).fit, X)),
            ),
        }
        # A category of radius r there is half a vigilance in the unit square.
        if ball := artlib(
            "elementary.HypersphereART.HypersphereART", 0.0, 1e-7, 1.0, vigilance / 2
        ):
            peers["artlib HypersphereART, first 300"] = (300, ball(unit_square[:300]))
        if box := artlib("optimized.backends.cpp.FuzzyART.FuzzyART", 1 - vigilance / 2, 1e-7, 1.0):
            peers["artlib FuzzyART, compiled, first 5000"] = (5000, box(unit_square[:5000]))
        title = f"EuclideanART.fit, vigilance {vigilance}, {n} centers"
        compare(title, len(X), partial(EuclideanART(vigilance).fit, X), **peers)
    wide, fine = (partial(EuclideanART(v).fit, X) for v in (0.15, 0.025))
    compare("EuclideanART.fit, 174 centers", len(X), wide, **{"3390 centers": (len(X), fine)})
    art = EuclideanART(0.025).fit(X)
    tree = cKDTree(art.cluster_centers_)
    fresh = np.random.default_rng(1).uniform(-1, 1, X.shape)
    compare(
        "EuclideanART.predict", len(X), partial(art.predict, fresh),
        **{"scipy cKDTree.query": (len(X), partial(tree.query, fresh))},
    )  # fmt: skip
    compare(
        "EuclideanART.category, a call each", len(X), lambda: [art.category(x) for x in fresh],
        **{"scipy cKDTree.query": (len(X), lambda: [tree.query(x)[1] for x in fresh])},
    )  # fmt: skip
    compare("EuclideanART.learn_one, a call each", len(X), lambda: [art.learn_one(x) for x in X])
    print()


def analog(n: int, m: int, kinds: int) -> np.ndarray:
    """Return noisy patterns of some kinds, of unit norm, as artlib's ART2A needs them."""
    rng = np.random.default_rng(0)
    prototypes = rng.uniform(0, 1, (kinds, m)) ** 3
    X = np.abs(prototypes[rng.integers(0, kinds, n)] + 0.05 * rng.normal(size=(n, m)))
    return X / np.linalg.norm(X, axis=1, keepdims=True)


def networks() -> None:
    """ART1, ART2 and ART2A: presentations a second, learning and recalling."""
    theirs = artlib("elementary.ART2.ART2A", 0.95, 1e-7, 0.5)
    for m, kinds in ((4, 5), (10, 10), (25, 20)):
        X = analog(20_000, m, kinds)
        peers = {"artlib ART2A, first 1000": (1000, theirs(X[:1000]))} if theirs else {}
        fast, slow = ART2(0.95).fit(X), ART2(0.95, learning_rate=0.1)
        print(f"{m} features, {fast.n_clusters_} categories:")
        compare("ART2.fit, fast learning", len(X), partial(fast.fit, X), **peers)
        compare("ART2.fit, slow learning", len(X), partial(slow.fit, X))
        compare("ART2.predict", len(X), partial(fast.predict, X))
        compare("ART2A.fit", len(X), partial(ART2A(0.95).fit, X), **peers)
    bits = (analog(20_000, 25, 20) > 0.2).astype(float)
    theirs = artlib("elementary.ART1.ART1", 0.7, 2.0)
    peers = {"artlib ART1, first 1000": (1000, theirs(bits[:1000].astype(int)))} if theirs else {}
    print(f"25 features, {ART1(0.7).fit(bits).n_clusters_} categories:")
    compare("ART1.fit", len(bits), partial(ART1(0.7).fit, bits), **peers)


def main() -> None:
    if importlib.util.find_spec("artlib") is None:
        print("artlib is not installed: left out (pip install artlib)\n")
    euclidean()
    networks()


if __name__ == "__main__":
    main()

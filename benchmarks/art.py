"""The ART room: Euclidean segmentation, and the networks."""

from __future__ import annotations

import importlib
from collections.abc import Iterator
from functools import partial

import numpy as np
from scipy.spatial import cKDTree
from sklearn.cluster import Birch

from arkaq_edu._compiled import kernel
from arkaq_edu.art import ART1, ART2, ART2A, EuclideanART
from benchmarks.case import Case, Growth, Run, installed


@kernel
def limit(X, vigilance, eta, centers):
    """Compare every pattern with every center."""
    n = 0
    for x in X:
        best, j = vigilance**2, -1
        for k in range(n):
            d2 = 0.0
            for i in range(len(x)):
                d2 += (x[i] - centers[k, i]) ** 2
            if d2 < best:
                best, j = d2, k
        if j < 0:
            centers[n] = x
            n += 1
        else:
            centers[j] += eta * (x - centers[j])
    return n


def square(n: int, m: int = 2) -> np.ndarray:
    return np.random.default_rng(0).uniform(-1, 1, (n, m))


def artlib(path: str, X: np.ndarray, *parameters: float) -> dict[str, tuple[float, Run]]:
    """Return what fits an artlib network to the patterns, in [0, 1]."""
    if not installed("artlib"):
        return {}
    module, name = path.rsplit(".", 1)
    try:
        network = getattr(importlib.import_module(f"artlib.{module}"), name)
    except ImportError as error:
        print(f"    (artlib.{path} cannot be imported: {error})")
        return {}

    def run() -> None:
        model = network(*parameters)
        model.fit(model.prepare_data(X))

    return {f"artlib {name}, first {len(X)}": (len(X), run)}


def analog(n: int, m: int, kinds: int) -> np.ndarray:
    """Return noisy patterns of some kinds, of unit norm, as artlib's ART2A needs them."""
    rng = np.random.default_rng(0)
    prototypes = rng.uniform(0, 1, (kinds, m)) ** 3
    X = np.abs(prototypes[rng.integers(0, kinds, n)] + 0.05 * rng.normal(size=(n, m)))
    return X / np.linalg.norm(X, axis=1, keepdims=True)


def cases() -> Iterator[Case | Growth]:
    X = square(20_000)
    unit = (X + 1) / 2
    for vigilance in (0.15, 0.025):
        birch = Birch(threshold=vigilance, n_clusters=None)
        # A category of radius r there is half a vigilance in the unit square.
        others: dict[str, tuple[float, Run]] = {
            "limit": (len(X), lambda v=vigilance: limit(X, v, 0.5, np.empty_like(X))),
            "scikit-learn Birch, first 5000": (5000, lambda birch=birch: birch.fit(X[:5000])),
        }
        others |= artlib(
            "elementary.HypersphereART.HypersphereART", unit[:300], 0.0, 1e-7, 1.0, vigilance / 2
        )
        others |= artlib(
            "optimized.backends.cpp.FuzzyART.FuzzyART", unit[:5000], 1 - vigilance / 2, 1e-7, 1.0
        )
        ours = lambda v=vigilance: EuclideanART(v).fit(X)  # noqa: E731
        yield Case(f"EuclideanART.fit, vigilance {vigilance}", "pattern", len(X), ours, others)
    art, fresh = EuclideanART(0.025).fit(X), square(20_001)[1:]
    tree = cKDTree(art.cluster_centers_)
    others = {"scipy cKDTree.query": (len(X), lambda: tree.query(fresh))}
    yield Case("EuclideanART.predict", "pattern", len(X), lambda: art.predict(fresh), others)

    X = analog(5000, 10, 10)
    peer = artlib("elementary.ART2.ART2A", X[:500], 0.95, 1e-7, 0.5)
    yield Case("ART2A.fit, 10 features", "pattern", len(X), lambda: ART2A(0.95).fit(X), peer)
    yield Case("ART2.fit, 10 features", "pattern", len(X), lambda: ART2(0.95).fit(X), peer)
    bits = (analog(5000, 25, 20) > 0.2).astype(float)
    peer = artlib("elementary.ART1.ART1", bits[:500].astype(int), 0.7, 2.0)
    yield Case("ART1.fit, 25 features", "pattern", len(bits), lambda: ART1(0.7).fit(bits), peer)

    yield Growth(
        "EuclideanART.fit, vigilance 0.05", "patterns", [5000, 20_000, 80_000],
        lambda n: partial(EuclideanART(0.05).fit, square(n)), at_most=1.15,
    )  # fmt: skip
    X = square(20_000)
    vigilances = {EuclideanART(v).fit(X).n_clusters_: v for v in (0.15, 0.07, 0.025)}
    yield Growth(
        "EuclideanART.fit, 20,000 patterns", "centers", list(vigilances),
        lambda n: partial(EuclideanART(vigilances[n]).fit, X), at_most=0.3,
    )  # fmt: skip
    yield Growth(
        "ART2A.fit, 5,000 patterns", "dimensions", [8, 32, 128],
        lambda m: partial(ART2A(0.95).fit, analog(5000, m, 10)),
    )  # fmt: skip

"""ART2: against the equations written out in numpy, and what the theory promises."""

import os
import subprocess
import sys

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from sklearn.datasets import make_blobs
from sklearn.exceptions import NotFittedError
from sklearn.metrics import adjusted_rand_score
from sklearn.utils.estimator_checks import parametrize_with_checks

from arkaq_edu.art import ART2, match_norm

DEFAULTS = {"a": 10.0, "b": 10.0, "c": 0.1, "d": 0.9}


def unit(x):
    norm = np.linalg.norm(x)
    return x / norm if norm else 0 * x


def signal_function(form, theta):
    if form == "linear":
        return lambda x: np.where(x < theta, 0, x)
    return lambda x: np.where(x < theta, 2 * theta * x**2 / (x**2 + theta**2 + 1e-300), x)


class Written:
    """Equations 2.26-2.44 written out, in the order of the thesis, without a shortcut."""

    def __init__(self, m, vigilance, theta, rate=1.0, form="linear", start=0.5, **abcd):
        self.rho, self.theta, self.rate = vigilance, theta, rate
        self.a, self.b, self.c, self.d = (DEFAULTS | abcd).values()
        self.f = signal_function(form, theta)
        self.z0 = start / ((1 - self.d) * np.sqrt(m))
        self.up, self.down = np.empty((0, m)), np.empty((0, m))

    def settle(self, pattern, u, z, check=False):
        q = unit(u + self.d * z)
        while True:
            p = u + self.d * z
            r = (u + self.c * p) / (np.linalg.norm(u) + np.linalg.norm(self.c * p) + 1e-300)
            if check and self.rho > np.linalg.norm(r):
                return None
            x = unit(pattern + self.a * u)
            new = unit(self.f(x) + self.b * self.f(q))
            q = unit(new + self.d * z)
            if np.abs(new - u).max() < 1e-13:
                return new
            u = new

    def learn(self, x):
        pattern, nothing = unit(x), np.zeros(len(x))
        seen = self.settle(pattern, nothing, nothing)
        if not seen.any():
            return -1
        signal = np.append(self.up @ seen, self.z0 * seen.sum())
        for j in np.argsort(-signal, kind="stable"):
            if j == len(self.up):
                self.up = np.vstack([self.up, np.full(len(x), self.z0)])
                self.down = np.vstack([self.down, nothing])
                u = seen
                break
            u = self.settle(pattern, seen, self.down[j], check=True)
            if u is not None:
                break
        if self.rate == 1:
            u = self.settle(pattern, u, nothing)
        rest = u / (1 - self.d)
        self.up[j] += self.rate * (rest - self.up[j])
        self.down[j] += self.rate * (rest - self.down[j])
        return int(j)


def analog_patterns(rng, n, m, kinds=4):
    prototypes = rng.uniform(0, 1, (kinds, m)) ** 3
    return np.abs(prototypes[rng.integers(0, kinds, n)] + 0.05 * rng.normal(size=(n, m)))


@pytest.mark.thesis("eqs 2.25 to 2.31, 2.36, 2.38 to 2.40, 2.43 and 2.44")
@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize(
    "choice",
    [
        {"theta": 0.0},
        {"theta": 0.2},
        {"theta": 0.1, "rate": 0.3},
        {"theta": 0.2, "form": "smooth", "rate": 0.5, "a": 2.0, "b": 2.0},
        {"theta": 0.15, "a": 1.0, "b": 3.0, "c": 0.2, "d": 0.8, "start": 1.0},
    ],
)
def test_the_network_is_the_equations(seed, choice):
    rng = np.random.default_rng(seed)
    m = int(rng.integers(2, 7))
    X = analog_patterns(rng, 15, m)
    written = Written(m, vigilance=0.96, **choice)
    labels = [written.learn(x) for x in X]
    names = {"rate": "learning_rate", "form": "signal"}
    parameters = {names.get(k, k): v for k, v in choice.items()}
    art = ART2(0.96, tol=1e-12, **parameters).fit(X)
    assert art.labels_.tolist() == labels
    np.testing.assert_allclose(art.top_down_, written.down, atol=1e-7)
    np.testing.assert_allclose(art.bottom_up_, written.up, atol=1e-7)
    assert art.counts_.tolist() == [labels.count(j) for j in range(len(written.up))]


@pytest.mark.thesis("eq 2.47, errata row 24")
@settings(max_examples=40, deadline=None)
@given(
    seed=st.integers(0, 2**32 - 1),
    c=st.floats(0.02, 0.3),
    d=st.floats(0.3, 0.75),
    theta=st.sampled_from([None, 0.0, 0.1]),
    rate=st.sampled_from([0.2, 1.0]),
)
def test_norm_r_in_every_step_is_the_closed_form(seed, c, d, theta, rate):
    rng = np.random.default_rng(seed)
    X = analog_patterns(rng, 12, 5)
    art = ART2(0.97, c=c, d=d, theta=theta, learning_rate=rate).fit(X)
    table = art.trace(rng.uniform(0, 1, 5))
    templates = np.vstack([art.top_down_, np.zeros(5)])
    compared = 0
    for _, step in table[table.node >= 0].groupby("step"):
        z, u = templates[step.node.iloc[0]], step.u.to_numpy()
        cosine = u @ unit(z)
        expected = match_norm(cosine, np.linalg.norm(c * d * z), c)
        assert step.norm_r.iloc[0] == pytest.approx(float(expected), abs=1e-9)
        assert step.norm_r.iloc[0] == pytest.approx(np.linalg.norm(step.r), abs=1e-12)
        compared += 1
    assert compared > 0


@settings(max_examples=40, deadline=None)
@given(seed=st.integers(0, 2**32 - 1), smooth=st.booleans())
def test_a_trace_obeys_the_equations_and_ends_as_the_network_does(seed, smooth):
    rng = np.random.default_rng(seed)
    X = analog_patterns(rng, 15, 4)
    theta, form = 0.2, "smooth" if smooth else "linear"
    art = ART2(0.97, theta=theta, signal=form).fit(X)
    x = rng.uniform(0, 1, 4)
    table = art.trace(x)
    f = signal_function(form, theta)
    templates = np.vstack([art.top_down_, np.zeros((2, 4))])  # uncommitted; silent, at -1
    for _, s in table.groupby("step"):
        z = templates[s.node.iloc[0]]
        np.testing.assert_allclose(s.x, unit(s.w.to_numpy()), atol=1e-12)
        np.testing.assert_allclose(s.p, s.u + 0.9 * z, atol=1e-12)
        np.testing.assert_allclose(s.q, unit(s.p.to_numpy()), atol=1e-12)
    last = table[table.step == table.step.max()]
    np.testing.assert_allclose(last.w, last.input + 10 * last.u, atol=1e-3)  # settled
    np.testing.assert_allclose(last.u, unit(f(last.x) + 10 * f(last.q)), atol=1e-3)
    np.testing.assert_allclose(last.input, unit(x), atol=1e-12)
    winner = last.node.iloc[0]
    assert last.winner.all() and table[table.winner].step.nunique() == 1
    blocked = table[table.reset].node.unique().tolist()
    assert winner not in blocked and len(set(blocked)) == len(blocked)
    assert (table[table.reset].norm_r < 0.97).all()
    assert (table[~table.reset & (table.node >= 0)].norm_r >= 0.97 - 1e-12).all()
    assert art.category(x) == (winner if winner < art.n_clusters_ else -1)
    assert art.learn_one(x) == winner


@pytest.mark.thesis("eq 2.37, errata row 21")
def test_nodes_are_tried_in_the_order_of_their_signals():
    rng = np.random.default_rng(4)
    art = ART2(0.999).fit(rng.uniform(0, 1, (20, 5)))
    table = art.trace(rng.uniform(0, 1, 5))
    tried = table[table.node >= 0].groupby("node", sort=False).signal.first()
    assert len(tried) > 3 and tried.is_monotonic_decreasing


def test_a_perfect_match_gives_norm_one():
    cdz = np.linspace(0, 2, 21)
    np.testing.assert_allclose(match_norm(1.0, cdz, 0.1), 1, atol=1e-15)
    assert (match_norm(0.9, cdz[1:], 0.1) < 1).all()
    pattern = [3.0, 1.0, 2.0]
    art = ART2(0.999).fit([pattern])
    table = art.trace(pattern)
    assert table[table.winner].node.iloc[0] == 0
    np.testing.assert_allclose(table[table.node == 0].norm_r, 1, atol=1e-12)


@pytest.mark.thesis("eq 2.43, errata row 23")
def test_a_negative_c_breaks_the_perfect_match():
    """The thesis prints c < 0; right is 0 < c < 1."""
    u, p = unit(np.array([1.0, 2.0])), 10 * unit(np.array([1.0, 2.0]))
    for c, perfect in ((0.1, True), (-0.1, False)):
        r = (u + c * p) / (1 + np.linalg.norm(c * p))
        assert (abs(np.linalg.norm(r) - 1) < 1e-12) == perfect


@pytest.mark.thesis("eq 2.46, errata row 25")
def test_norm_of_p_is_not_the_cosine_alone():
    """The thesis prints norm p = cos(u, p); right is norm p times cos(u, p)."""
    art = ART2(0.8).fit([[1.0, 0.2], [0.2, 1.0]])
    table = art.trace([1.0, 0.9])
    first = table[(table.node == 0) | (table.node == 1)].groupby("step")
    for _, s in first:
        u, p, z = s.u.to_numpy(), s.p.to_numpy(), art.top_down_[s.node.iloc[0]]
        dz = 0.9 * z
        cosine = u @ p / np.linalg.norm(p)
        right = 1 + np.linalg.norm(dz) * (u @ unit(z))
        assert np.linalg.norm(p) * cosine == pytest.approx(right, abs=1e-9)
        assert cosine != pytest.approx(right, abs=0.1)


@pytest.mark.parametrize("rate", [0.02, 0.3, 1.0])
def test_no_reset_while_a_new_category_is_learned(rate):
    rng = np.random.default_rng(2)
    for pattern in rng.uniform(0, 1, (10, 6)):
        art = ART2(0.9999, learning_rate=rate)
        for _ in range(50):
            assert art.learn_one(pattern) == 0
            table = art.trace(pattern)
            assert not table.reset.any()
            np.testing.assert_allclose(table[table.node == 0].norm_r, 1, atol=1e-9)


@pytest.mark.thesis("eqs 2.39 to 2.42 and 2.48, errata rows 22 and 26")
def test_traces_start_as_they_should_and_rest_at_u_over_one_minus_d():
    m, d = 4, 0.8
    art = ART2(0.9, d=d, learning_rate=0.25, start=0.5, theta=0.0).fit([[1.0, 2.0, 3.0, 4.0]])
    u = unit(np.array([1.0, 2.0, 3.0, 4.0]))
    np.testing.assert_allclose(art.top_down_[0], 0.25 * u / (1 - d), atol=1e-9)
    z0 = 0.5 / ((1 - d) * np.sqrt(m))
    np.testing.assert_allclose(art.bottom_up_[0], z0 + 0.25 * (u / (1 - d) - z0), atol=1e-9)
    fast = ART2(0.9, d=d, theta=0.0).fit([[1.0, 2.0, 3.0, 4.0]])
    np.testing.assert_allclose(fast.cluster_centers_[0], u, atol=1e-9)
    np.testing.assert_allclose(fast.top_down_, fast.bottom_up_, atol=1e-12)


def test_slow_learning_ends_where_fast_learning_is_at_once():
    first, second = [5.0, 4.0, 1.0, 3.0], [4.0, 5.0, 1.5, 3.0]
    fast = ART2(0.9, theta=0.05, tol=1e-10).fit([first, second])
    slow = ART2(0.9, theta=0.05, tol=1e-10).fit([first])
    slow.set_params(learning_rate=0.5)
    for _ in range(2000):
        slow.learn_one(second)
    assert fast.n_clusters_ == slow.n_clusters_ == 1
    np.testing.assert_allclose(slow.cluster_centers_, fast.cluster_centers_, atol=1e-4)


@settings(max_examples=50, deadline=None)
@given(seed=st.integers(0, 2**32 - 1), vigilance=st.sampled_from([0.8, 0.95, 0.99, 0.999]))
def test_a_pattern_just_learned_keeps_its_category(seed, vigilance):
    rng = np.random.default_rng(seed)
    art = ART2(vigilance, theta=0.0)
    for x in rng.uniform(0, 1, (30, int(rng.integers(1, 8)))):
        label = art.learn_one(x)
        assert art.category(x) == label
        before = art.cluster_centers_
        assert art.learn_one(x) == label
        np.testing.assert_allclose(art.cluster_centers_, before, atol=1e-9)


def test_well_separated_patterns_are_stable_from_the_first_pass():
    X, _ = make_blobs(100, 3, centers=[[9, 1, 1], [1, 9, 1], [1, 1, 9]], random_state=0)
    X = np.abs(X)
    art = ART2(0.9).fit(X)
    labels, n = art.labels_, art.n_clusters_
    for _ in range(3):
        art.partial_fit(X)
        assert art.labels_.tolist() == labels.tolist() and art.n_clusters_ == n


@settings(max_examples=40, deadline=None)
@given(
    seed=st.integers(0, 2**32 - 1),
    form=st.sampled_from(["linear", "smooth"]),
    rate=st.sampled_from([0.2, 1.0]),
)
def test_scale_of_the_input_does_not_matter(seed, form, rate):
    rng = np.random.default_rng(seed)
    X = analog_patterns(rng, 40, 5)
    scale = 2.0 ** rng.integers(-500, 300, (40, 1))
    one, other = (ART2(0.97, signal=form, learning_rate=rate).fit(Z) for Z in (X, X * scale))
    assert one.labels_.tolist() == other.labels_.tolist()
    assert one.top_down_.tobytes() == other.top_down_.tobytes()


def test_contrast_below_theta_is_cut_or_damped():
    x = unit(np.array([0.9, 0.5, 0.1]))
    theta = 0.2
    for form in ("linear", "smooth"):
        table = ART2(0.9, theta=theta, signal=form).fit([[1.0, 1.0, 1.0]]).trace(x)
        silent = table[table.node == -1]
        u = silent[silent.step == silent.step.max()].u.to_numpy()
        assert u[0] / u[1] == pytest.approx(x[0] / x[1]) and u[0] > x[0]
        assert u[2] == 0 if form == "linear" else 0 <= u[2] < 0.5 * x[2]
    keep = ART2(0.9, theta=0.05).fit([[1.0, 1.0, 1.0]]).trace(x)
    np.testing.assert_allclose(keep[keep.step == 0].u, x, atol=1e-12)


@pytest.mark.thesis("eqs 2.32 to 2.35, errata row 20")
def test_both_forms_of_f_give_theta_at_theta():
    """The thesis prints <= and >= for the linear form, which is two-valued at theta."""
    pattern = [0.8, 0.6]
    theta = ART2(theta=0.0).fit([pattern]).trace(pattern).x[1]
    assert theta == pytest.approx(0.6)
    for form in ("linear", "smooth"):
        table = ART2(theta=theta, signal=form).fit([pattern]).trace(pattern)
        assert table.v[1] == pytest.approx(0.6)


def test_higher_vigilance_makes_more_categories():
    X = np.random.default_rng(0).uniform(0, 1, (400, 4)) ** 2
    counts = [ART2(v).fit(X).n_clusters_ for v in (0.9, 0.97, 0.99, 0.997)]
    assert counts == sorted(set(counts))


def test_silence_has_no_category():
    art = ART2(0.9, theta=0.8).fit([[1.0, 1.0], [0.0, 0.0], [1.0, 0.0]])
    assert art.labels_.tolist() == [-1, -1, 0]
    table = art.trace([0.0, 0.0])
    assert not table.winner.any() and (table.u == 0).all() and len(table) == 2


def test_blobs_are_found():
    X, y = make_blobs(100, 3, centers=[[9, 1, 1], [1, 9, 1], [1, 1, 9]], random_state=0)
    labels = ART2(0.9).fit_predict(np.abs(X))
    assert adjusted_rand_score(y, labels) > 0.9


@pytest.mark.parametrize(
    ("parameters", "message"),
    [
        ({"vigilance": 1}, r"vigilance must be a number in \(0, 1\), got 1"),
        ({"a": 0}, r"a must be a number in \(0, inf\), got 0"),
        ({"b": -1}, r"b must be a number in \(0, inf\), got -1"),
        ({"c": -0.1}, r"c must be a number in \(0, 1\), got -0.1"),
        ({"d": 1}, r"d must be a number in \(0, 1\), got 1"),
        ({"c": 0.2, "d": 0.9}, r"c \* d / \(1 - d\) must be <= 1, got 1.8"),
        ({"theta": -0.1}, r"theta must be a number in \[0, 1\), got -0.1"),
        ({"learning_rate": 0}, r"learning_rate must be a number in \(0, 1\], got 0"),
        ({"signal": "cubic"}, r"signal must be 'linear' or 'smooth', got 'cubic'"),
        ({"start": 1.1}, r"start must be a number in \(0, 1\], got 1.1"),
        ({"e": -1}, r"e must be a number in \[0, 1\), got -1"),
        ({"tol": 0}, r"tol must be a number in \(0, 1\), got 0"),
    ],
)
def test_bad_parameters_are_refused(parameters, message):
    with pytest.raises(ValueError, match=message):
        ART2(**parameters).fit([[0.0, 1.0]])


@pytest.mark.thesis("errata row 30")
def test_negative_patterns_are_refused():
    art = ART2().fit([[0.0, 1.0]])
    for method, x in ((art.fit, [[-1.0, 1.0]]), (art.trace, [-1.0, 1.0]), (art.category, [1, -1])):
        with pytest.raises(ValueError, match=r"Negative values .* got -1"):
            method(x)
    with pytest.raises(NotFittedError):
        ART2().trace([0.0, 1.0])


def test_a_refused_fit_leaves_what_was_learned():
    art = ART2().fit([[0.0, 1.0]])
    with pytest.raises(ValueError, match="Negative"):
        art.fit([[0.0, 1.0, -1.0]])
    assert art.n_features_in_ == 2 and art.predict([[0.0, 1.0]]).tolist() == [0]


def test_a_small_e_changes_little():
    X = analog_patterns(np.random.default_rng(0), 50, 5)
    exact, softened = ART2(0.95).fit(X), ART2(0.95, e=1e-9).fit(X)
    assert exact.labels_.tolist() == softened.labels_.tolist()
    np.testing.assert_allclose(exact.cluster_centers_, softened.cluster_centers_, atol=1e-4)


def not_for_negative_patterns(estimator):
    return {"check_clustering": "feeds negative patterns; an activity cannot be negative"}


@parametrize_with_checks([ART2()], expected_failed_checks=not_for_negative_patterns)
def test_scikit_learn_estimator_checks(estimator, check):
    check(estimator)


EVERY_KERNEL = """
import numpy as np
from arkaq_edu.art import ART1, ART2, ART2A, EuclideanART
X = np.random.default_rng(0).uniform(0, 1, (50, 3))
networks = [
    EuclideanART(0.1),
    EuclideanART(0.2, "count", max_clusters=5),
    ART1(0.8, binarize=0.5),
    ART2(0.97),
    ART2(0.97, learning_rate=0.3, signal="smooth"),
    ART2A(0.98, theta=0.1),
]
learned = [n.fit(X).cluster_centers_.tobytes() + n.predict(2 * X).tobytes() for n in networks]
result = b"".join(learned).hex()
"""


def test_without_numba_the_same_bytes():
    plain = subprocess.run(
        [sys.executable, "-W", "error::RuntimeWarning", "-c", EVERY_KERNEL + "print(result)"],
        env=os.environ | {"NUMBA_DISABLE_JIT": "1"}, capture_output=True, text=True, check=True,
    )  # fmt: skip
    here: dict = {}
    exec(EVERY_KERNEL, here)
    assert plain.stdout.strip() == here["result"]

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from arkaq_edu.mdp import (
    MDP,
    Episode,
    discounted_returns,
    monte_carlo,
    policy_evaluation,
    simulate,
    td0,
)
from tests.mdp.worlds import as_sparse, corridor, random_mdp


@pytest.mark.parametrize("learn", [monte_carlo, td0])
def test_values_of_the_corridor(learn):
    mdp = corridor()
    rng = np.random.default_rng(0)
    episodes = [simulate(mdp, [0] * 7, rng=rng) for _ in range(8000)]
    alpha = "1/visits" if learn is monte_carlo else lambda n: 20 / (19 + n)
    V = learn(episodes, 7, mdp.gamma, alpha=alpha)
    np.testing.assert_allclose(V[1:6], np.arange(1, 6) / 6, atol=0.03)
    np.testing.assert_allclose(policy_evaluation(mdp, [0] * 7)[1:6], np.arange(1, 6) / 6)


@settings(max_examples=5, deadline=None)
@given(st.integers(0, 2**32 - 1))
def test_both_agree_with_the_exact_values_of_any_policy(seed):
    rng = np.random.default_rng(seed)
    T = rng.dirichlet(np.ones(5), size=(2, 5))
    T[:, 4] = np.eye(5)[4]
    R = rng.normal(size=(5, 2))
    R[4] = 0
    mdp = MDP(T, R, 0.8)
    chances = rng.dirichlet(np.ones(2), size=5)
    exact = policy_evaluation(mdp, chances)
    episodes = [simulate(mdp, chances, start=s, rng=rng) for s in range(4) for _ in range(1000)]
    rng.shuffle(episodes)
    for V in (
        monte_carlo(episodes, 5, 0.8),
        td0(episodes, 5, 0.8, alpha=lambda n: 10 / (9 + n)),
    ):
        np.testing.assert_allclose(V, exact, atol=0.25)


def test_monte_carlo_is_the_mean_of_the_returns_of_all_visits():
    one = Episode(np.array([0, 1, 0, 2]), np.zeros(3, int), np.array([1.0, 2.0, 4.0]), True)
    two = Episode(np.array([1, 2]), np.zeros(1, int), np.array([10.0]), True)
    # Returns at gamma 1/2: state 0 gets 1 + 2/2 + 4/4 = 3 and 4; state 1 gets 2 + 4/2 = 4 and 10.
    assert monte_carlo([one, two], 3, 0.5).tolist() == [3.5, 7.0, 0.0]


@pytest.mark.thesis("errata row 7")
def test_constant_alpha_monte_carlo_is_equation_2_10():
    episodes = [Episode(np.array([0, 1]), np.array([0]), np.array([r]), True) for r in (8.0, 4.0)]
    assert monte_carlo(episodes, 2, 0.9, alpha=0.5, initial=2.0)[0] == (2 + 8) / 2 / 2 + 4 / 2


@pytest.mark.thesis("errata row 8")
def test_td_error_takes_the_value_of_the_next_state_not_the_return():
    """Equation 2.11 prints r + gamma R_t; with R_t the return from t this counts r twice."""
    episode = Episode(np.array([0, 1, 2]), np.zeros(2, int), np.array([6.0, 8.0]), True)
    V = td0([episode] * 3, 3, 0.5, alpha=1.0)
    returns = discounted_returns(episode.r, 0.5)
    assert V[:2].tolist() == returns.tolist() == [10.0, 8.0]
    assert (episode.r + 0.5 * returns).tolist() != V[:2].tolist()


def test_td_looks_beyond_an_episode_cut_short_and_monte_carlo_refuses_it():
    cut = Episode(np.array([0, 1]), np.array([0]), np.array([1.0]), False)
    done = cut._replace(terminated=True)
    assert td0([cut], 2, 0.5, alpha=1.0, initial=8.0)[0] == 1 + 0.5 * 8
    assert td0([done], 2, 0.5, alpha=1.0, initial=8.0)[0] == 1
    with pytest.raises(ValueError, match=r"got one cut short at \(1,\)"):
        monte_carlo([done, cut], 2, 0.5)


@given(st.lists(st.floats(-100, 100), max_size=20), st.floats(0, 1))
def test_returns_are_discounted_sums(r, gamma):
    expected = [sum(gamma**k * x for k, x in enumerate(r[t:])) for t in range(len(r))]
    np.testing.assert_allclose(discounted_returns(r, gamma), expected, atol=1e-9)


@pytest.mark.parametrize("mdp", [corridor(), as_sparse(corridor())], ids=["dense", "sparse"])
def test_simulated_episodes_are_walks_of_the_model(mdp):
    rng = np.random.default_rng(1)
    for _ in range(50):
        episode = simulate(mdp, [0] * 7, rng=rng)
        assert episode.s[0] == 3 and episode.terminated and mdp.ends[episode.s[-1]]
        assert not mdp.ends[episode.s[:-1]].any()
        assert (np.abs(np.diff(episode.s)) == 1).all()
        assert (episode.r == mdp.R[episode.s[:-1], 0]).all()
    short = simulate(mdp, [0] * 7, max_steps=2, rng=0)
    assert len(short.r) == 2 and len(short.s) == 3 and not short.terminated
    assert len(simulate(mdp, [0] * 7, start=6, rng=0).r) == 0


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (
            lambda m: simulate(m, [0] * 7, start=7, rng=0),
            r"start must be an integer in \[0, 6\]",
        ),
        (lambda m: simulate(m, [0] * 6, rng=0), r"policy must have shape \(7,\), got \(6,\)"),
        (
            lambda m: simulate(m, [0] * 7, max_steps=0, rng=0),
            "max_steps must be an integer >= 1",
        ),
        (lambda m: discounted_returns([np.nan], 0.5), "r must hold finite numbers, got nan"),
        (lambda m: simulate(m, [0] * 7, rng=1.5), "rng must be a numpy Generator"),
        (lambda m: simulate(m, [0] * 7, max_steps=10**9, rng=0), "max_steps must need at most"),
        (lambda m: td0([1, 2], 7, 0.5), r"episodes must be a sequence of Episode, got \[1, 2\]"),
        (lambda m: monte_carlo(None, 7, 0.5), "episodes must be a sequence of Episode, got None"),
        (lambda m: td0([], 10**10, 0.5), "n_states and n_actions must need at most"),
    ],
)
def test_bad_arguments_are_refused(call, message):
    with pytest.raises(ValueError, match=message):
        call(corridor())


def test_a_dense_and_a_sparse_model_give_the_same_episodes():
    mdp = random_mdp(8, max_states=9)
    chances = np.random.default_rng(0).dirichlet(np.ones(mdp.n_actions), size=mdp.n_states)
    one, other = (simulate(m, chances, max_steps=200, rng=4) for m in (mdp, as_sparse(mdp)))
    assert one.s.tolist() == other.s.tolist() and one.r.tolist() == other.r.tolist()

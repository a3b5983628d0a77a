"""SARSA, expected SARSA and learners of one's own, in place of Q-learning."""

import math

import gymnasium
import numpy as np
import pytest

from arkaq_edu.arkaq import (
    Arkaq,
    ExpectedSarsa,
    Experience,
    QLearning,
    Sarsa,
    Sensing,
    TableLearner,
    TrainingSettings,
    UniformGrid,
)
from arkaq_edu.mdp import QLearner, explore, softmax
from tests.arkaq.brief import BRIEF, digest, near_task

LEARNERS = [QLearning, Sarsa, ExpectedSarsa]
# A rate of 1 over the number of visits: each value is the mean of its targets.
MEAN = TrainingSettings(gamma=0.9, alpha_power=1.0, alpha_least=0.0)
EPISODE = [
    Experience(0, 1, -1.0, 1, False, 2),
    Experience(1, 0, 2.0, 2, False, 1),
    Experience(2, 1, 5.0, 0, False, 3),
]


def begun(learner, settings=MEAN, n_states=3):
    learner.begin(n_states, 2, settings)
    learner.Q[:] = np.arange(2.0 * n_states).reshape(n_states, 2)
    return learner


def textbook(kind, Q, visits, temperature, episode):
    """The three rules of the textbook, each backed up from an episode's end."""
    Q, visits = Q.copy(), visits.copy()
    for i in reversed(range(len(episode))):
        s, a, r, s_next, terminated, k = episode[i]
        mean = np.dot(softmax(Q[s_next], temperature), Q[s_next])
        worth = {
            QLearning: Q[s_next].max(),
            ExpectedSarsa: mean,
            Sarsa: mean if i == len(episode) - 1 else Q[s_next, episode[min(i + 1, 2)].a],
        }[kind]
        visits[s, a] += 1
        target = r + (0 if terminated else 0.9**k * worth)
        Q[s, a] += (target - Q[s, a]) / visits[s, a]
    return Q, visits


@pytest.mark.parametrize("kind", LEARNERS)
@pytest.mark.parametrize("temperature", [0.5, 3.0, math.inf])
@pytest.mark.parametrize("terminated", [True, False])
def test_each_rule_is_that_of_the_textbook(kind, temperature, terminated):
    episode = [*EPISODE[:2], EPISODE[2]._replace(terminated=terminated)]
    learner = begun(kind())
    for _ in range(3):
        Q, visits = textbook(kind, learner.Q, learner.visits, temperature, episode)
        learner.learn(episode, temperature)
        np.testing.assert_allclose(learner.Q, Q, atol=1e-12)
        assert np.array_equal(learner.visits, visits)


def test_expected_sarsa_becomes_q_learning_as_the_temperature_falls():
    cold, greedy = begun(ExpectedSarsa()), begun(QLearning())
    cold.learn(EPISODE, 1e-3)
    greedy.learn(EPISODE, 1e-3)
    np.testing.assert_allclose(cold.Q, greedy.Q, atol=1e-9)


class Corridor(gymnasium.Env):
    """Five places in a row; a step either way, and back at the wall it hurts. The first is the end.

    As states, or, with ``as_sightings``, as a goal that is seen in that direction.
    """

    action_space = gymnasium.spaces.Discrete(2)

    def __init__(self, as_sightings=False, limit=None):
        self.as_sightings, self.limit = as_sightings, limit
        self.observation_space = gymnasium.spaces.Discrete(5)
        if as_sightings:
            low, high = np.float32([-1, 0]), np.float32([1, 1])
            self.observation_space = gymnasium.spaces.Box(low, high, dtype=np.float32)

    def look(self):
        return np.array([(self.place - 2) / 5, 1], np.float32) if self.as_sightings else self.place

    def reset(self, *, seed=None, options=None):
        self.place, self.cycles = 4, 0
        return self.look(), {}

    def step(self, action):
        self.cycles += 1
        reward = -1.1 if action == 1 and self.place == 4 else -0.1
        self.place = min(self.place + (-1, 1)[action], 4)
        done = self.place == 0
        return self.look(), reward + 10.0 * done, done, self.cycles == self.limit, {}


# A filter that believes what it sees, in intervals where each place has a cell of its own.
SHARP = Sensing(low=(-0.5,), high=(0.5,), A=[[1]], H=[[1]], Q=[[100]], R=[[1e-9]], P0=[[100]])


def learn_corridor(learner, **settings):
    # So hot that the Boltzmann choice is any action.
    training = TrainingSettings(patterns=20, gamma=0.9, hot=1e9, cold=1e9, **settings)
    agent = Arkaq(
        sensing=SHARP, segmenter=UniformGrid((5,)), learner=learner, learning=training, rng=0
    )
    return agent.learn(Corridor(as_sightings=True, limit=12), progress=False)


def values_of_chance():
    """Q of the policy that draws each action with probability 1/2, by a linear system."""
    T, R = np.zeros((10, 10)), np.zeros(10)
    for s in range(1, 5):
        for a in range(2):
            there = min(s + (-1, 1)[a], 4)
            R[2 * s + a] = 10.0 * (there == 0) - 1.0 * (s == 4 and a == 1) - 0.1
            if there:
                T[2 * s + a, [2 * there, 2 * there + 1]] = 0.5
    return np.linalg.solve(np.eye(10) - 0.9 * T, R).reshape(5, 2)


def test_expected_sarsa_learns_the_value_of_chance():
    training = {"exploration": 200, "exploitation": 3000, "hold": 1, "alpha_power": 0.0}
    learned = learn_corridor(ExpectedSarsa(), **training)
    np.testing.assert_allclose(learned.q.Q, values_of_chance(), atol=1e-6)


def test_sarsa_learns_the_value_of_chance_on_average():
    training = {"exploration": 200, "exploitation": 12_000, "hold": 1, "alpha_power": 0.8}
    learned = learn_corridor(Sarsa(), **training, alpha_least=0.0)
    np.testing.assert_allclose(learned.q.Q, values_of_chance(), atol=0.5)
    best = {0: 0.0}
    for s in range(1, 5):
        best[s] = 0.9 * best[s - 1] - 0.1 + 10.0 * (s == 1)
    assert best[4] > learned.q.Q[4].max() + 1, "Q-learning would learn the best there is"


@pytest.mark.parametrize("hold", [1, 3])
def test_the_automaton_is_the_loop_of_figures_4_3_and_4_4(hold):
    """Given the same choices it meets the same experiences, and learns the same from them."""

    class Recorded(QLearner):
        def update(self, *experience, **n_steps):
            recorded.append(Experience(*experience, **n_steps))
            return super().update(*experience, **n_steps)

    class Repeated(TableLearner):
        """Chooses what the loop chose, and backs up in the order of time, as the loop does."""

        def begin(self, n_states, n_actions, settings):
            super().begin(n_states, n_actions, settings)
            self.choices, self.met = iter([e.a for e in recorded]), []

        def explore(self, s, rng):
            return next(self.choices, 0)

        def learn(self, episode, temperature):
            self.met += episode
            for experience in episode:
                self.table.update(*experience)

    recorded = []
    loop = Recorded(5, 2, MEAN.alpha, 0.9, rng=1)
    run = explore(Corridor(limit=12), loop, max_repeat=hold, max_backups=300, tol=0.0)
    assert len(recorded) == 300
    whole = int(run.lengths.sum())  # the last episode may have been left unfinished
    learned = learn_corridor(
        Repeated(),
        exploration=whole,
        exploitation=0,
        hold=hold,
        alpha_power=1.0,
        alpha_least=0.0,
    )
    n = len(learned.q.met)
    assert n > 280
    for ours, theirs in zip(learned.q.met, recorded, strict=False):
        assert ours == pytest.approx(theirs)
    finished = QLearner(5, 2, MEAN.alpha, 0.9)
    for experience in recorded[:n]:
        finished.update(*experience)
    np.testing.assert_allclose(learned.q.Q, finished.Q)
    assert [row[1] for row in learned.history if row[0] == "Q-learning"] == run.lengths.tolist()


@pytest.mark.parametrize("kind", [Sarsa, ExpectedSarsa])
def test_an_agent_learns_to_walk_to_the_ball_by_either(kind):
    training = TrainingSettings(patterns=400, exploration=1800, exploitation=1800)
    env = near_task(far=2000.0)
    learned = Arkaq(0.25, learner=kind(), learning=training, rng=1).learn(env, progress=False)
    reached = []
    for k in range(30):
        observation, _ = env.reset(seed=10**6 + k)
        learned.reset()
        over = False
        while not over:
            observation, _, terminated, truncated, _ = env.step(learned.act(observation))
            over = terminated or truncated
        reached.append(terminated)
    assert np.mean(reached) >= 0.9


def test_the_default_is_q_learning_and_the_others_learn_something_else(brief):
    digests = [
        digest(Arkaq(0.2, learner=kind(), learning=BRIEF, rng=4).learn(near_task(), progress=False))
        for kind in LEARNERS
    ]
    assert digests[0] == digest(brief) and len(set(digests)) == 3


def test_a_learner_that_is_given_is_copied(brief):
    learner = QLearning()
    for _ in range(2):
        agent = Arkaq(0.2, learner=learner, learning=BRIEF, rng=4)
        assert digest(agent.learn(near_task(), progress=False)) == digest(brief)
    assert not hasattr(learner, "table")


def test_a_learner_needs_no_table_of_ours():
    class Coin:
        """Learns nothing, and counts what it is given."""

        def begin(self, n_states, n_actions, settings):
            self.Q, self.cycles, self.temperatures = np.zeros((n_states, n_actions)), 0, []

        def explore(self, s, rng):
            return int(rng.integers(3))

        def exploit(self, s, temperature, rng):
            return int(rng.integers(3))

        def greedy(self, s):
            return 2

        def learn(self, episode, temperature):
            self.cycles += sum(e.n_steps for e in episode)
            self.temperatures.append(temperature)

    agent = Arkaq(0.2, learner=Coin(), learning=BRIEF, rng=4).learn(near_task(), progress=False)
    cycles = sum(row[1] for row in agent.history if row[0] == "Q-learning")
    assert agent.q.cycles == cycles
    assert agent.q.temperatures[0] == math.inf
    cooling = [T for T in agent.q.temperatures if math.isfinite(T)]
    assert cooling == sorted(cooling, reverse=True) and 0.5 <= cooling[-1] < cooling[0] <= 10
    assert agent.act(np.array([900.0, 0.1, 1.0])) == 2


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (lambda learner: learner.begin(2, 3, {}), "settings must be of the class TrainingSettings"),
        (lambda learner: learner.begin(10**9, 3, TrainingSettings()), "n_states and n_actions"),
        (lambda learner: learner.greedy(-1), r"s must be an integer in \[0, 1\], got -1"),
        (lambda learner: learner.expected(2, 1.0), r"s must be an integer in \[0, 1\], got 2"),
        (lambda learner: learner.expected(0, math.nan), "temperature"),
        (lambda learner: learner.explore(5, 0), "s must be"),
        (lambda learner: learner.explore(0, -1), "rng must be"),
        (lambda learner: learner.exploit(0, 1.0, "rng"), "rng must be"),
        (lambda learner: learner.exploit(0, -1.0, 0), "temperature"),
        (lambda learner: learner.back_up(0, 3, 1.0), r"a must be an integer in \[0, 2\], got 3"),
        (lambda learner: learner.back_up(-1, 0, 1.0), "s must be"),
        (lambda learner: learner.back_up(0, 0, math.nan), "target must be"),
    ],
)
def test_what_a_learner_refuses(call, words):
    learner = Sarsa()
    learner.begin(2, 3, TrainingSettings())
    with pytest.raises(ValueError, match=words):
        call(learner)
    assert not learner.Q.any() and not learner.visits.any()

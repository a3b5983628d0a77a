"""Other segmenters, senses and learners to compare in a study, each in a few lines.

- segmenters: `ComplementCoding`, which lets ART2 and ART 2-A see positive patterns;
- senses of the ball with less knowledge: `unfiltered`, `uncontrolled`;
- learners that explore in another way: `AtRandom`, `EpsilonGreedy`;
- learners that learn in another way: `AsPrinted`, `AveragedQ`, `TileCoding`.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from sklearn.base import BaseEstimator

from arkaq_edu import _checks
from arkaq_edu.arkaq import Experience, QLearning, Sensing, TrainingSettings


class ComplementCoding(BaseEstimator):
    """A network that is shown each feature and its complement, both in [0, 1].

    ART2 and ART 2-A look at the direction of a pattern alone. So two patterns of different length
    are the same to them, and on a single feature they see nothing but its sign. With (1 + x) / 2
    and (1 - x) / 2 in place of x, no two patterns have the same direction.

    Parameters
    ----------
    network : Segmenter
        A network of `arkaq_edu.art`.

    References
    ----------
    Carpenter, Grossberg, Rosen, Fuzzy ART, Neural Networks 4, 1991.

    Examples
    --------
    >>> from arkaq_edu.art import ART2A
    >>> halves = ComplementCoding(ART2A(vigilance=0.9))
    >>> [halves.learn_one([x]) for x in (-0.9, -0.8, 0.9)], halves.n_clusters_
    ([0, 0, 1], 3)
    """

    def __init__(self, network: Any) -> None:
        self.network = network

    @property
    def n_clusters_(self) -> int:
        """Number of states: the categories, and a last state for patterns that fit none."""
        return self.network.n_clusters_ + 1

    def category(self, x: ArrayLike) -> int:
        """Return the state of one pattern of shape (m,)."""
        return self._state(self.network.category(_coded(x)))

    def learn_one(self, x: ArrayLike) -> int:
        """Learn one pattern of shape (m,) and return its state."""
        return self._state(self.network.learn_one(_coded(x)))

    def _state(self, category: int) -> int:
        return self.network.n_clusters_ if category < 0 else category


def _coded(x: ArrayLike) -> NDArray[np.float64]:
    x = _checks.array("x", x, (None,))
    return np.concatenate([1 + x, 1 - x]) / 2


def unfiltered() -> Sensing:
    """Return senses without a filter: every sighting is believed, and between them nothing changes.

    The filter has a noise of the motion so large that its gain is 1.

    Examples
    --------
    >>> from arkaq_edu.arkaq import Estimator
    >>> senses = Estimator(unfiltered())
    >>> first = senses.observe([2000.0, 0.1, 1.0], None)
    >>> senses.observe([3000.0, -0.2, 1.0], 0).round(4), senses.observe([0.0, 0.0, 0.0], 0).round(4)
    (array([ 0.4359, -0.4   ]), array([ 0.4359, -0.4   ]))
    """
    return replace(Sensing.consistent(), Q=1e9 * np.eye(2), B=None, range_noise=0.0)


def uncontrolled() -> Sensing:
    """Return consistent senses of a robot that knows that it walks, and not which action it took.

    Each action has the mean effect of all, and the noise of the motion is larger by their variance.

    Examples
    --------
    >>> uncontrolled().B.tolist()
    [[-96.0, -96.0, -96.0], [0.0, 0.0, 0.0]]
    >>> np.sqrt(uncontrolled().Q.diagonal()).round(3)
    array([4.4  , 0.085])
    """
    known = Sensing.consistent()
    mean = np.tile(known.B.mean(axis=1, keepdims=True), known.B.shape[1])
    return replace(known, B=mean, Q=known.Q + np.diag(known.B.var(axis=1)))


class AtRandom(QLearning):
    """Q-learning that explores by actions at random, instead of the untried ones first."""

    def explore(self, s: int, rng: np.random.Generator) -> int:
        """Draw any action."""
        return int(rng.integers(self.Q.shape[1]))


class EpsilonGreedy(AtRandom):
    """Q-learning that exploits by the best action known, but for a share of actions at random.

    Parameters
    ----------
    epsilon : float
        The share, in [0, 1].

    Examples
    --------
    >>> learner = EpsilonGreedy(epsilon=0.0)
    >>> learner.begin(1, 2, TrainingSettings())
    >>> learner.back_up(0, 1, 5.0)
    >>> learner.exploit(0, 1.0, np.random.default_rng(0))
    1
    """

    def __init__(self, epsilon: float = 0.1) -> None:
        self.epsilon = _checks.number("epsilon", epsilon, 0, 1)

    def exploit(self, s: int, temperature: float, rng: np.random.Generator) -> int:
        """Take the best action known, or any."""
        return self.explore(s, rng) if rng.random() < self.epsilon else self.greedy(s)


class AsPrinted(QLearning):
    """Q-learning that discounts an action held for k cycles as if it had been held for one.

    So the thesis prints it in figure 4.3. An action that is held for long looks better than it is.

    Examples
    --------
    >>> right, printed = QLearning(), AsPrinted()
    >>> for learner in (right, printed):
    ...     learner.begin(2, 1, TrainingSettings(gamma=0.5))
    ...     learner.learn([Experience(0, 0, 0.0, 1, False, 3), Experience(1, 0, 8.0, 1, True, 1)],
    ...                   temperature=1.0)
    >>> right.Q[0, 0], printed.Q[0, 0]
    (np.float64(1.0), np.float64(4.0))
    """

    def learn(self, episode: Sequence[Experience], temperature: float) -> None:
        """Back an episode up from its end."""
        super().learn([experience._replace(n_steps=1) for experience in episode], temperature)


class AveragedQ(QLearning):
    """Q-learning that acts, when it has learned, by the mean of its values over the last part.

    With a rate that does not fall to zero, the values never come to rest: the last rewards decide
    what looks best. The mean over many episodes does not depend on the last ones.

    Parameters
    ----------
    below : float
        The last part begins when the temperature falls below this, in units of the reward.

    References
    ----------
    Polyak, Juditsky, Acceleration of stochastic approximation by averaging, SIAM J. Control and
    Optimization 30, 1992.

    Examples
    --------
    >>> learner = AveragedQ(below=10.0)
    >>> learner.begin(1, 1, TrainingSettings(alpha_power=0.0))
    >>> for reward in (50.0, 2.0, 4.0):
    ...     learner.learn([Experience(0, 0, reward, 0, True, 1)], 20.0 if reward == 50 else 5.0)
    >>> learner.Q[0, 0], learner.mean[0, 0]
    (np.float64(4.0), np.float64(3.0))
    """

    def __init__(self, below: float = 20.0) -> None:
        self.below = _checks.number("below", below, 0, open_low=True)

    def begin(self, n_states: int, n_actions: int, settings: TrainingSettings) -> None:
        """Make tables of zeros."""
        super().begin(n_states, n_actions, settings)
        self.mean, self.episodes = np.zeros_like(self.Q), 0

    def learn(self, episode: Sequence[Experience], temperature: float) -> None:
        """Back an episode up from its end; in the last part, take the values into the mean."""
        super().learn(episode, temperature)
        if temperature < self.below:
            self.episodes += 1
            self.mean += (self.Q - self.mean) / self.episodes

    def greedy(self, s: int) -> int:
        """Return the action with the highest mean."""
        values = self.mean if self.episodes else self.Q
        return int(values[self._state("s", s)].argmax())


class TileCoding(QLearning):
    """Q-learning on tiles: cells of a fine grid share what they learn with their neighbors.

    Several coarse grids, each shifted by a part of a tile, lie over a `UniformGrid` of fine cells.
    The value of a cell is the mean of its tiles, one of each grid.

    Parameters
    ----------
    cells : sequence of int
        The fine cells along each feature: those of the `UniformGrid`.
    tilings : int
        How many grids. A tile has so many fine cells along each feature.

    References
    ----------
    R. Sutton, A. Barto, "Reinforcement Learning", 2nd edition, 2018, section 9.5.4.

    Examples
    --------
    >>> learner = TileCoding(cells=(8,), tilings=4)
    >>> learner.begin(8, 1, TrainingSettings(alpha_power=0.0))
    >>> learner.back_up(3, 0, 8.0)
    >>> learner.Q[:, 0]
    array([2., 4., 6., 8., 6., 4., 2., 0.])
    >>> learner.n_tiles
    11
    """

    def __init__(self, cells: Sequence[int] = (40, 40), tilings: int = 4) -> None:
        self.cells = tuple(_checks.integers("cells", cells, 1).tolist())
        self.tilings = _checks.integer("tilings", tilings, 1)

    def begin(self, n_states: int, n_actions: int, settings: TrainingSettings) -> None:
        """Lay the tiles; `n_states` is the number of fine cells."""
        if n_states != np.prod(self.cells):
            raise ValueError(f"cells must be {n_states} in all, got {self.cells}")
        super().begin(n_states, n_actions, settings)
        places = np.stack(np.unravel_index(np.arange(n_states), self.cells), axis=-1)
        tiles = [
            np.unique((places + shift) // self.tilings, axis=0, return_inverse=True)[1].ravel()
            for shift in range(self.tilings)
        ]
        starts = np.cumsum([0, *(tile.max() + 1 for tile in tiles)])
        #: The tiles of each fine cell, shape (n_states, tilings).
        self.tiles = np.stack(tiles, axis=-1) + starts[:-1]
        #: The number of tiles: each has a weight for every action.
        self.n_tiles = int(starts[-1])
        #: The fine cells of each tile.
        self.under = [np.flatnonzero((self.tiles == t).any(axis=1)) for t in range(self.n_tiles)]

    def back_up(self, s: int, a: int, target: float) -> None:
        """Move Q(s, a), and the value of all cells that share a tile with it, toward a target."""
        self.visits[s, a] += 1
        change = self._alpha(int(self.visits[s, a])) * (target - self.Q[s, a])
        for tile in self.tiles[s]:
            self.Q[self.under[tile], a] += change / self.tilings

    def learn(self, episode: Sequence[Experience], temperature: float) -> None:
        """Back an episode up from its end."""
        for s, a, r, s_next, terminated, n_steps in reversed(episode):
            value = 0.0 if terminated else float(self.Q[s_next].max())
            self.back_up(s, a, r + self.gamma**n_steps * value)

"""Decisions in a world that is fully seen: bandits, Markov decision processes, Q-learning.

Thesis chapters 2.1, 2.2, 3 and 4.3. Learning from rewards is a third kind of learning, beside
learning with a teacher and learning without one. (The thesis counts it, and ARKAQ, as unsupervised.
In ARKAQ only the segmentation of the world is.)

- `model`, `planning`: an MDP, and the best actions if it is known (`gridworld`: an example);
- `optimality`, `performance`: what "best" means, and how well something was learned;
- `bandits`, `choice`, `schedules`: exploration against exploitation;
- `prediction`, `q_learning`, `training`: learning from experience (`compiled`: the fast twins);
- `procedures`: figures 4.3 and 4.4 line by line;
- `floor`, `machines`: the course's floor and a game on four machines, as explored.
"""

from arkaq_edu.mdp.bandits import UCB, Bandit, Boltzmann, EpsilonGreedy, Play, Random, play
from arkaq_edu.mdp.choice import argmax_shared, softmax
from arkaq_edu.mdp.gridworld import MOVES, Grid, grid_world
from arkaq_edu.mdp.model import MDP, example_mdp
from arkaq_edu.mdp.optimality import (
    CHAINS,
    average_reward,
    best_chains,
    delayed_rewards,
    discounted,
    earnings,
)
from arkaq_edu.mdp.performance import quality_of_convergence, regret, speed_of_convergence
from arkaq_edu.mdp.planning import (
    best_actions,
    error_bound,
    finite_horizon,
    modified_policy_iteration,
    policy_chances,
    policy_evaluation,
    policy_iteration,
    policy_model,
    value_iteration,
)
from arkaq_edu.mdp.prediction import Episode, discounted_returns, monte_carlo, simulate, td0
from arkaq_edu.mdp.q_learning import QLearner
from arkaq_edu.mdp.schedules import Exponential, Power
from arkaq_edu.mdp.training import Held, TrainingRun, exploit, explore, hold, train

__all__ = [
    "CHAINS",
    "MDP",
    "MOVES",
    "UCB",
    "Bandit",
    "Boltzmann",
    "Episode",
    "EpsilonGreedy",
    "Exponential",
    "Grid",
    "Held",
    "Play",
    "Power",
    "QLearner",
    "Random",
    "TrainingRun",
    "argmax_shared",
    "average_reward",
    "best_actions",
    "best_chains",
    "delayed_rewards",
    "discounted",
    "discounted_returns",
    "earnings",
    "error_bound",
    "example_mdp",
    "exploit",
    "explore",
    "finite_horizon",
    "grid_world",
    "hold",
    "modified_policy_iteration",
    "monte_carlo",
    "play",
    "policy_chances",
    "policy_evaluation",
    "policy_iteration",
    "policy_model",
    "quality_of_convergence",
    "regret",
    "simulate",
    "softmax",
    "speed_of_convergence",
    "td0",
    "train",
    "value_iteration",
]

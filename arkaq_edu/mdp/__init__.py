"""Decisions in a world that is seen: bandits, Markov decision processes, Q-learning.

Thesis chapters 2.1, 2.2, 3 and 4.3. Learning from rewards is a third kind beside learning with a
teacher and learning without any (the thesis counts it, and ARKAQ, as unsupervised; in ARKAQ only
the segmentation of the world is).

- `model`, `planning`: an MDP, and the best actions from knowing it (`grid`: a floor to try it on);
- `optimality`, `performance`: what "best" means, and how good learning was;
- `bandits`, `choice`: exploration against exploitation, and schedules between the two;
- `prediction`, `q_learning`, `control`: learning from what happens (`kernels`: the inner loops).
"""

from arkaq_edu.mdp.bandits import UCB, Bandit, Boltzmann, EpsilonGreedy, Play, Random, play
from arkaq_edu.mdp.gridworld import Grid, grid_world
from arkaq_edu.mdp.model import MDP
from arkaq_edu.mdp.optimality import average_reward, delayed_rewards, discounted
from arkaq_edu.mdp.performance import quality_of_convergence, regret, speed_of_convergence
from arkaq_edu.mdp.planning import (
    best_actions,
    error_bound,
    finite_horizon,
    policy_chances,
    policy_evaluation,
    policy_iteration,
    policy_model,
    value_iteration,
)
from arkaq_edu.mdp.prediction import Episode, discounted_returns, monte_carlo, simulate, td0
from arkaq_edu.mdp.q_learning import QLearner
from arkaq_edu.mdp.schedules import Exponential, Linear, Power, argmax_shared, softmax
from arkaq_edu.mdp.training import Held, TrainingRun, exploit, explore, hold, train

__all__ = [
    "MDP",
    "UCB",
    "Bandit",
    "Boltzmann",
    "Episode",
    "EpsilonGreedy",
    "Exponential",
    "Grid",
    "Held",
    "Linear",
    "Play",
    "Power",
    "QLearner",
    "Random",
    "TrainingRun",
    "argmax_shared",
    "average_reward",
    "best_actions",
    "delayed_rewards",
    "discounted",
    "discounted_returns",
    "error_bound",
    "exploit",
    "explore",
    "finite_horizon",
    "grid_world",
    "hold",
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

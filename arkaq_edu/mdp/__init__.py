"""Decisions in a world that is seen: Q-learning.

Thesis chapters 2.1, 2.2, 3 and 4.3.
"""

from arkaq_edu.mdp.q_learning import QLearner

__all__ = ["QLearner"]

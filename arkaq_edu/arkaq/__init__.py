"""The ARKAQ agent: senses (Kalman filter), states (ART network), values (Q-learning).

Thesis chapter 3, 5.2 and 5.3.
"""

from arkaq_edu.arkaq.agent import Arkaq
from arkaq_edu.arkaq.automata import (
    GOAL_Q_LEARNING,
    GOAL_SEGMENTATION,
    Q_LEARNING,
    SEGMENTATION,
    Automaton,
)
from arkaq_edu.arkaq.sensing import Estimator, Sensing
from arkaq_edu.arkaq.settings import TrainingSettings

__all__ = [
    "GOAL_Q_LEARNING",
    "GOAL_SEGMENTATION",
    "Q_LEARNING",
    "SEGMENTATION",
    "Arkaq",
    "Automaton",
    "Estimator",
    "Sensing",
    "TrainingSettings",
]

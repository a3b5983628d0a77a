"""The ARKAQ agent: a Kalman filter senses, a segmenter makes states, a learner chooses actions.

`agent` acts and learns, `training` runs the phases, `automata` holds their tables, `sensing`
and `settings` hold the parameters, `segmenters` and `learners` the parts that can be exchanged,
and `storage` reads and writes files. Thesis chapter 3, sections 5.2 and 5.3.
"""

from arkaq_edu.arkaq.agent import Arkaq
from arkaq_edu.arkaq.automata import (
    GOAL_Q_LEARNING,
    GOAL_SEGMENTATION,
    Q_LEARNING,
    SEGMENTATION,
    Automaton,
)
from arkaq_edu.arkaq.learners import (
    ExpectedSarsa,
    Experience,
    Learner,
    QLearning,
    Sarsa,
    TableLearner,
)
from arkaq_edu.arkaq.segmenters import Segmenter, UniformGrid
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
    "ExpectedSarsa",
    "Experience",
    "Learner",
    "QLearning",
    "Sarsa",
    "Segmenter",
    "Sensing",
    "TableLearner",
    "TrainingSettings",
    "UniformGrid",
]

"""Short runs of both tasks, and what an agent has learned as bytes."""

import hashlib

import gymnasium
import numpy as np

from arkaq_edu.arkaq import Arkaq, Sensing, TrainingSettings

TASK = "arkaq_edu:BallApproach-v0"
BRIEF = TrainingSettings(patterns=150, exploration=200, exploitation=200)
GOAL_TASK = "arkaq_edu:ScoreGoal-v0"
BRIEF_GOAL = TrainingSettings.goal(patterns=100, exploration=60, exploitation=60)
SENSINGS = {"thesis": Sensing.thesis(), "consistent": Sensing.consistent()}


def near_task(**options):
    return gymnasium.make(TASK, **{"far": 1200.0, **options})


def arrays(agent):
    """All that an agent has learned, by name."""
    return {
        "centers": agent.art.cluster_centers_,
        "counts": agent.art.counts_,
        "Q": agent.q.Q,
        "visits": agent.q.visits,
        "history": np.array([row[1:] for row in agent.history], dtype=float),
        "phases": np.array([row[0] for row in agent.history]),
        "cycles": np.array(agent.cycles),
    }


def digest(agent):
    said = hashlib.sha256()
    for name, values in arrays(agent).items():
        said.update(f"{name} {values.shape} {values.dtype}".encode() + values.tobytes())
    return said.hexdigest()


def brief_agent(seed=4, env=None, **options):
    learner = Arkaq(0.2, learning=BRIEF, rng=seed)
    return learner.learn(env or near_task(), progress=False, **options)


def brief_scorer(seed=4, env=None, **options):
    learner = Arkaq(0.06, task="goal", learning=BRIEF_GOAL, rng=seed)
    return learner.learn(env or gymnasium.make(GOAL_TASK), progress=False, **options)

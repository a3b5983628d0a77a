"""A course on a robot that learns: a Kalman filter, an ART network and Q-learning.

Units everywhere: millimeters, radians, seconds, grams. Orientation is positive to the left.

The subpackages, from the bottom up; each imports only from those above it in this list:

- `kalman`, `art`, `mdp`, `pomdp`: the methods, from scratch;
- `field`: the football field with ball, legged robot and camera;
- `arkaq`: the agent, which consists of a world model and a policy;
- `envs`: the tasks as Gymnasium environments;
- `experiments`: the experiments of the thesis;
- `figures`: its figures;
- `widgets`, `exercises`: the interactive parts of the notebooks;
- `cli`: the ``arkaq`` command.
"""

import lazy_loader as _lazy
from gymnasium.envs.registration import register as _register

__version__ = "0.1.0"

__getattr__, __dir__, __all__ = _lazy.attach(
    __name__,
    submodules=[
        "arkaq", "art", "cli", "envs", "exercises", "experiments", "field", "figures", "kalman",
        "mdp", "pomdp", "widgets",
    ],
    submod_attrs={
        "_installation": ["check_installation"],
        "arkaq": ["Arkaq"],
        "art": ["ART1", "ART2", "ART2A", "EuclideanART"],
        "kalman": ["KalmanFilter", "constant_velocity", "kalman_batch"],
        "mdp": ["MDP", "QLearner", "value_iteration"],
        "pomdp": ["POMDP", "belief_update", "read_pomdp", "solve_pomdp"],
    },
)  # fmt: skip

_register(
    "BallApproach-v0",
    entry_point="arkaq_edu.envs.ball_approach:BallApproachEnv",
    max_episode_steps=150,
)
_register("POMDP-v0", entry_point="arkaq_edu.envs.pomdp:POMDPEnv")
_register("ScoreGoal-v0", entry_point="arkaq_edu.envs.score_goal:ScoreGoalEnv")

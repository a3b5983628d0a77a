"""The tasks as Gymnasium environments.

Importing `arkaq_edu` registers them: ``gymnasium.make("arkaq_edu:BallApproach-v0")``,
``gymnasium.make("arkaq_edu:ScoreGoal-v0", goal_distance="near")``.
"""

import lazy_loader as _lazy

__getattr__, __dir__, __all__ = _lazy.attach(
    __name__,
    submod_attrs={
        "ball_approach": ["BallApproachEnv"],
        "pomdp": ["POMDPEnv"],
        "score_goal": ["ScoreGoalEnv"],
        "wrappers": ["FullState", "PixelObservation"],
    },
)

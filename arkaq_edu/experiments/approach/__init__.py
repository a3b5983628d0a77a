"""The first problem of the thesis: walk to the ball.

The twin of `arkaq_edu.experiments.goal`: the same name means the same in both.
"""

import lazy_loader as _lazy

__getattr__, __dir__, __all__ = _lazy.attach(
    __name__,
    submod_attrs={
        "task": [
            "VIGILANCE", "load_agent", "make_task", "train", "usual_learning", "usual_vigilance",
        ],
        "policies": ["at_random", "greedy", "planner"],
        "evaluation": [
            "TRAJECTORY_STARTS", "Trajectory", "describe", "evaluate", "record_episode",
            "score", "trajectory",
        ],
        "walkthrough": ["Stage", "stages"],
        "sightings": ["calibrate", "load_sightings", "mean_nis", "patterns", "record_sightings"],
        "studies": ["load_study", "seed_runs", "study"],
    },
)  # fmt: skip

"""The second problem of the thesis: score a goal.

The robot turns toward the goal and kicks. It sees one number, the orientation of the goal.
The twin of `arkaq_edu.experiments.approach`: the same name means the same in both.
"""

import lazy_loader as _lazy

__getattr__, __dir__, __all__ = _lazy.attach(
    __name__,
    submodules=["aiming", "kicks", "planning"],
    submod_attrs={
        "task": [
            "STARTS", "VIGILANCE", "LookAround", "load_agent", "make_look_around", "make_task",
            "train", "usual_learning", "usual_vigilance",
        ],
        "policies": ["at_random", "greedy", "planner"],
        "evaluation": ["Shot", "describe", "evaluate", "record_episode", "score"],
        "sightings": [
            "VIGILANCES", "calibrate", "cells", "count_fact", "coverage", "find_centers",
            "load_center_counts", "load_sightings", "mean_nis", "patterns", "record_sightings",
        ],
        "kicks": ["kick_trials", "load_kick_trials"],
        "planning": ["BestPolicy", "best_policy"],
        "studies": [
            "BLOCK", "curve", "curves", "load_study", "mean_curves", "play", "rates",
            "scored_while_learning", "seed_runs", "study",
        ],
    },
)  # fmt: skip

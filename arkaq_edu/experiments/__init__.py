"""The thesis's experiments: configuration in, tidy tables out.

- `streams`: sightings recorded on the field, and what they say of the senses;
- `segmentation`: the recorded stream cut into categories, and their map;
- `approach`: training, walking to the ball, and how well it is done;
- `goal`: training, kicking, and how well it is done: the second problem;
- `aiming`: where kicks go, kept and laid before any goal: the second problem without its physics;
- `reproduce`: thesis against here, over many seeds;
- `kicks`: kicks of a real robot, and simulated ones.
"""

import lazy_loader as _lazy

__getattr__, __dir__, __all__ = _lazy.attach(
    __name__,
    submodules=["aiming", "goal", "segmentation"],
    submod_attrs={
        "approach": [
            "STARTS",
            "Walk",
            "at_random",
            "evaluate",
            "greedy",
            "load_agent",
            "make_task",
            "planner",
            "train",
            "walk",
        ],
        "kicks": ["load_kicks", "record_kicks"],
        "reproduce": [
            "agent_file",
            "goal_table",
            "load_study",
            "mean_nis",
            "results",
            "summary",
            "thesis_numbers",
        ],
        "streams": ["calibrate", "count_centers", "load_sightings", "patterns", "record_sightings"],
    },
)

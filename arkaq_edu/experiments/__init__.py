"""The experiments of the thesis: settings in, tidy tables out.

- `approach` and `goal`: the two problems. The same name means the same in both: `make_task`,
  `train`, `load_agent`, `greedy`, `at_random`, `planner`, `evaluate`, `record_episode`,
  `record_sightings`, `load_sightings`, `patterns`, `calibrate`, `study`, `load_study`.
- `streams`: recorded sightings of either problem, and what they say about the senses;
- `segmentation`: the recorded sightings of the ball, cut into categories, and their map;
- `kicks`: kicks of a real robot, and simulated ones;
- `policies`: policies that play either problem;
- `studies`: `study`, every combination of some settings over many seeds, `read_study`, and
  `load_study` for those that come with the course; `trials`: one cell of it; `parts`: other
  segmenters and learners to compare;
- `hidden`: ARKAQ on small POMDPs; `cells`: the ball problem as a POMDP that can be planned;
- `runs`: many runs at once, and their summary;
- `counts`: the search for a recipe that gives the five counts of centers;
- `claims`: every number and every claim of the thesis, and what judges it;
- `reproduce`: both problems over many seeds, with a verdict on every claim.
"""

import lazy_loader as _lazy

__getattr__, __dir__, __all__ = _lazy.attach(
    __name__,
    submodules=[
        "approach",
        "cells",
        "claims",
        "counts",
        "goal",
        "hidden",
        "kicks",
        "parts",
        "policies",
        "reproduce",
        "runs",
        "segmentation",
        "streams",
        "studies",
        "trials",
    ],
    submod_attrs={
        "kicks": ["load_kicks", "record_kicks"],
        "claims": ["judge", "thesis_numbers"],
        "reproduce": ["measure", "results"],
        "runs": ["agent_file", "learning_curve"],
        "studies": ["bands", "load_study", "read_plan", "read_study", "study"],
        "streams": ["count_centers", "mean_nis"],
    },
)

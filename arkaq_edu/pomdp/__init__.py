"""Decisions in a world whose state is hidden: belief states, and value functions over them.

Thesis 2.3. One idea a file:

- `model`: a POMDP; `files`, `cassandra`: models from files, and the course's own;
- `belief`: what is known after an action and an observation (equation 2.15); `simplex`: beliefs
  over three states as a triangle;
- `trees`: policy trees and what they earn (2.18 to 2.22); `graph`: plans without an end;
- `value`: a value function, the upper surface of vectors (2.23); `surface`: its shape;
- `pruning`: which vectors are needed; `linear_program`: the compiled loops of pruning;
- `backup`: one step of value iteration (2.19); `solve`: exact value iteration;
- `point_based`: bounds on the value, where an exact solution is out of reach;
- `agent`: keep the belief and act on it; `turns`: a history of actions and observations by name.
"""

from arkaq_edu.pomdp.agent import BeliefAgent
from arkaq_edu.pomdp.belief import (
    Calibration,
    Successors,
    Trajectory,
    belief_update,
    calibration,
    entropy,
    expected_rewards,
    predict,
    successors,
    trajectory,
)
from arkaq_edu.pomdp.files import PomdpFormatError, problem, read_pomdp, write_pomdp
from arkaq_edu.pomdp.graph import PolicyGraph
from arkaq_edu.pomdp.model import POMDP
from arkaq_edu.pomdp.point_based import PointBased, UpperBound, solve_point_based
from arkaq_edu.pomdp.pruning import Domination, dominated, prune
from arkaq_edu.pomdp.simplex import to_triangle
from arkaq_edu.pomdp.solve import bellman_error, solve_pomdp, solved
from arkaq_edu.pomdp.surface import Bowl, UpperSurface, bowl, regions, upper_surface
from arkaq_edu.pomdp.trees import PolicyTree, all_trees, tree_value
from arkaq_edu.pomdp.value import ValueFunction

__all__ = [
    "POMDP",
    "BeliefAgent",
    "Bowl",
    "Calibration",
    "Domination",
    "PointBased",
    "PolicyGraph",
    "PolicyTree",
    "PomdpFormatError",
    "Successors",
    "Trajectory",
    "UpperBound",
    "UpperSurface",
    "ValueFunction",
    "all_trees",
    "belief_update",
    "bellman_error",
    "bowl",
    "calibration",
    "dominated",
    "entropy",
    "expected_rewards",
    "predict",
    "problem",
    "prune",
    "read_pomdp",
    "regions",
    "solve_point_based",
    "solve_pomdp",
    "solved",
    "successors",
    "to_triangle",
    "trajectory",
    "tree_value",
    "upper_surface",
    "write_pomdp",
]

"""Decisions in a world that is seen only in part: belief states and value functions over them.

Thesis 2.3.

- `model`: a POMDP;
- `belief`: what is known after what was done and observed; `grid`: all beliefs laid out;
- `files`: models in Cassandra's file format, and the course's own;
- `trees`: policy trees and what they earn;
- `value`: a value function, the upper surface of vectors; `graph`: plans without an end;
- `pruning`: which vectors are needed, and who dominates the others; `_simplex`: its loops;
- `solve`: exact value iteration, `_points`: its cheap steps in between; `bounds`: from points,
  where that is out of reach;
- `agent`: keep the belief and act on it.
"""

from arkaq_edu.pomdp.agent import BeliefAgent
from arkaq_edu.pomdp.belief import (
    Calibration,
    Successors,
    belief_update,
    calibration,
    expected_rewards,
    predict,
    successors,
)
from arkaq_edu.pomdp.files import PomdpFormatError, problem, read_pomdp, write_pomdp
from arkaq_edu.pomdp.graph import PolicyGraph
from arkaq_edu.pomdp.model import POMDP
from arkaq_edu.pomdp.point_based import PointBased, UpperBound, solve_point_based
from arkaq_edu.pomdp.pruning import Domination, dominated, prune
from arkaq_edu.pomdp.simplex import from_triangle, simplex_grid, to_triangle
from arkaq_edu.pomdp.solve import bellman_error, solve_pomdp
from arkaq_edu.pomdp.trees import PolicyTree, all_trees, tree_value
from arkaq_edu.pomdp.value import ValueFunction

__all__ = [
    "POMDP",
    "BeliefAgent",
    "Calibration",
    "Domination",
    "PointBased",
    "PolicyGraph",
    "PolicyTree",
    "PomdpFormatError",
    "Successors",
    "UpperBound",
    "ValueFunction",
    "all_trees",
    "belief_update",
    "bellman_error",
    "calibration",
    "dominated",
    "expected_rewards",
    "from_triangle",
    "predict",
    "problem",
    "prune",
    "read_pomdp",
    "simplex_grid",
    "solve_point_based",
    "solve_pomdp",
    "successors",
    "to_triangle",
    "tree_value",
    "write_pomdp",
]

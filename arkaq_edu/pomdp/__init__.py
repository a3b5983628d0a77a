"""Decisions in a world that is seen only in part: belief states and value functions over them.

Thesis 2.3.

- `model`: a POMDP;
- `belief`: what is known after what was done and observed;
- `files`: models in Cassandra's file format, and the course's own.
"""

from arkaq_edu.pomdp.belief import (
    Successors,
    belief_update,
    expected_rewards,
    predict,
    successors,
)
from arkaq_edu.pomdp.files import PomdpFormatError, problem, read_pomdp, write_pomdp
from arkaq_edu.pomdp.model import POMDP

__all__ = [
    "POMDP",
    "PomdpFormatError",
    "Successors",
    "belief_update",
    "expected_rewards",
    "predict",
    "problem",
    "read_pomdp",
    "successors",
    "write_pomdp",
]

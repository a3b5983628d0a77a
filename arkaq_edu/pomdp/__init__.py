"""Decisions in a world that is seen only in part: belief states and value functions over them.

Thesis 2.3.

- `model`: a POMDP;
- `belief`: what is known after what was done and observed.
"""

from arkaq_edu.pomdp.belief import (
    Successors,
    belief_update,
    expected_rewards,
    predict,
    successors,
)
from arkaq_edu.pomdp.model import POMDP

__all__ = [
    "POMDP",
    "Successors",
    "belief_update",
    "expected_rewards",
    "predict",
    "successors",
]

"""The head: it pans, and while its servo moves no sighting is to be trusted."""

from __future__ import annotations

from dataclasses import dataclass

from arkaq_edu import _checks


@dataclass(frozen=True)
class Head:
    """How far and how fast the head pans, and what that does to the pictures.

    Parameters
    ----------
    reach : float
        The farthest it pans to either side (rad), in [0, 1.6]. With 0 it looks straight ahead
        for good.
    speed : float
        How fast (rad/s).
    settling : float
        How long it still sways when it has got there (s).
    blurs : bool
        Whether pictures taken while it moves or sways are useless (thesis 5.1.3.2). Without, the
        robot need not wait before it looks.

    Notes
    -----
    The reach is the ERS-7's, 93 degrees. The speed is what its servo does under the load of the
    head, the settling three pictures of 1/30 s; the thesis gives neither.
    """

    reach: float = 1.6
    speed: float = 3.0
    settling: float = 0.1
    blurs: bool = True

    def __post_init__(self) -> None:
        _checks.number("reach", self.reach, 0, 1.6)
        _checks.number("speed", self.speed, 0, 100, open_low=True)
        _checks.number("settling", self.settling, 0, 10)

"""The head: it pans, and while it moves the camera's pictures are useless."""

from __future__ import annotations

from dataclasses import dataclass

from arkaq_edu import _checks


@dataclass(frozen=True)
class Head:
    """How far and how fast the head pans, and how that affects the pictures.

    Parameters
    ----------
    reach : float
        The largest pan to either side (rad), in [0, 1.6]. With 0 it always looks straight ahead.
    speed : float
        Speed of the pan (rad/s), in (0, 100].
    settling : float
        How long the head sways after it has arrived (s), in [0, 10].
    blurs : bool
        Whether pictures taken while it moves or sways are useless (thesis 5.1.3.2). If False, the
        robot need not wait before it looks.

    Notes
    -----
    The reach is the ERS-7's, 93 degrees. The thesis gives neither of the other two. The speed is
    that of the servo under the load of the head; the settling time is three pictures of 1/30 s.
    """

    reach: float = 1.6
    speed: float = 3.0
    settling: float = 0.1
    blurs: bool = True

    def __post_init__(self) -> None:
        speed = _checks.number("speed", self.speed, 0, 100, open_low=True)
        object.__setattr__(self, "reach", _checks.number("reach", self.reach, 0, 1.6))
        object.__setattr__(self, "speed", speed)
        object.__setattr__(self, "settling", _checks.number("settling", self.settling, 0, 10))
        _checks.instance("blurs", self.blurs, bool)

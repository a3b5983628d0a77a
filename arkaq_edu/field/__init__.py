"""The football field: pymunk physics, the legged robot and its camera, the supervisor.

Thesis 5.1. Units: mm, rad, s, g; orientation is positive to the left.
`drive` is the robot driven by hand; `arcs` is the motion of what touches nothing, in closed form.

Each of the three uncertainties of thesis 5.1.3 is a dataclass of `World` and can be turned off:

- the walk drifts: ``Legs(slide=0, pull=0, variation=0)``;
- there are no sightings while the head moves: ``Head(blurs=False)``;
- the ball's place before a kick varies: ``Kick(spread=0)``; ``swerve=0`` also makes it roll
  straight.
"""

from arkaq_edu.field import motion
from arkaq_edu.field.camera import Camera, GoalSighting, Sighting
from arkaq_edu.field.goal import GoalSupervisor
from arkaq_edu.field.head import Head
from arkaq_edu.field.kick import Kick
from arkaq_edu.field.supervisor import Supervisor, Verdict, random_place
from arkaq_edu.field.view import bird_view
from arkaq_edu.field.world import Legs, World

__all__ = [
    "Camera",
    "GoalSighting",
    "GoalSupervisor",
    "Head",
    "Kick",
    "Legs",
    "Sighting",
    "Supervisor",
    "Verdict",
    "World",
    "bird_view",
    "motion",
    "random_place",
]

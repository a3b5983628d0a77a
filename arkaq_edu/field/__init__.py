"""The football field: pymunk physics, the legged robot and its camera, the supervisor.

Thesis 5.1. Units: mm, rad, s, g; orientation is positive to the left.
"""

from arkaq_edu.field.camera import Camera, Sighting
from arkaq_edu.field.supervisor import Supervisor, Verdict, random_place
from arkaq_edu.field.view import bird_view
from arkaq_edu.field.world import Legs, World

__all__ = [
    "Camera",
    "Legs",
    "Sighting",
    "Supervisor",
    "Verdict",
    "World",
    "bird_view",
    "random_place",
]

"""What the notebooks let a student move: sliders above a picture that follows them.

Every explorer is an `Explorer`: plain controls, a plain function from their values to a `Scene`,
and one canvas that draws any scene. The live robot plays frames instead, which `robot` makes and
live.js draws. `EXPLORERS` has them all by name.
"""

from collections.abc import Callable
from functools import partial

from arkaq_edu.widgets.arkaq import sighting_explorer
from arkaq_edu.widgets.art import letters_explorer, resonance_explorer
from arkaq_edu.widgets.belief import belief_explorer
from arkaq_edu.widgets.explorer import Buttons, CanvasView, Drag, Explorer
from arkaq_edu.widgets.field import control_panel
from arkaq_edu.widgets.film import film_explorer
from arkaq_edu.widgets.goal import scoring_explorer
from arkaq_edu.widgets.kalman import kalman_explorer
from arkaq_edu.widgets.learning import bandit_explorer, horizon_explorer
from arkaq_edu.widgets.live import live_robot, race, vigilance_robot
from arkaq_edu.widgets.mdp import planning_explorer, q_learning_explorer
from arkaq_edu.widgets.pomdp import bowl_explorer, value_explorer
from arkaq_edu.widgets.segmentation import vigilance_explorer

#: Every explorer of the course by its short name, in the order of the chapters.
EXPLORERS: dict[str, Callable[..., Explorer]] = {
    "horizon": horizon_explorer,
    "bandit": bandit_explorer,
    "planning": planning_explorer,
    "q-learning": q_learning_explorer,
    "belief": belief_explorer,
    "value": value_explorer,
    "bowl": bowl_explorer,
    "kalman": kalman_explorer,
    "letters": letters_explorer,
    "resonance": resonance_explorer,
    "vigilance": vigilance_explorer,
    "field": control_panel,
    "sighting": sighting_explorer,
    "scoring": scoring_explorer,
    "robot": live_robot,
    "robot-goal": partial(live_robot, "goal"),
    "race": race,
    "walk": vigilance_robot,
}

__all__ = [
    "EXPLORERS",
    "Buttons",
    "CanvasView",
    "Drag",
    "Explorer",
    "bandit_explorer",
    "belief_explorer",
    "bowl_explorer",
    "control_panel",
    "film_explorer",
    "horizon_explorer",
    "kalman_explorer",
    "letters_explorer",
    "live_robot",
    "planning_explorer",
    "q_learning_explorer",
    "race",
    "resonance_explorer",
    "scoring_explorer",
    "sighting_explorer",
    "value_explorer",
    "vigilance_explorer",
    "vigilance_robot",
]

"""What the notebooks let a student move: sliders above a picture that follows them.

Every explorer is an `Explorer`: plain controls, a plain function from their values to a `Scene`,
and one canvas that draws any scene.
"""

from .belief import belief_explorer
from .explorer import Buttons, CanvasView, Drag, Explorer
from .kalman import kalman_explorer
from .learning import bandit_explorer, horizon_explorer
from .panel import control_panel
from .planning import planning_explorer, q_learning_explorer
from .pomdp import bowl_explorer, value_explorer
from .resonance import letters_explorer, resonance_explorer
from .scoring import scoring_explorer
from .vigilance import vigilance_explorer

__all__ = [
    "Buttons",
    "CanvasView",
    "Drag",
    "Explorer",
    "bandit_explorer",
    "belief_explorer",
    "bowl_explorer",
    "control_panel",
    "horizon_explorer",
    "kalman_explorer",
    "letters_explorer",
    "planning_explorer",
    "q_learning_explorer",
    "resonance_explorer",
    "scoring_explorer",
    "value_explorer",
    "vigilance_explorer",
]

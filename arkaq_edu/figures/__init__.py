"""One function for each figure of the thesis, and the visual grammar they share.

`gallery.FIGURES` leads from a figure's number to its function, ``gallery.draw("5.10")`` draws it.
"""

import lazy_loader as _lazy

__getattr__, __dir__, __all__ = _lazy.attach(
    __name__,
    submodules=[
        "arkaq", "art", "belief", "drawing", "field",
        "gallery", "goal", "kalman", "learning", "mdp", "policy", "pomdp",
        "segmentation", "trajectories",
    ],
    submod_attrs={
        "drawing.animation": [
            "MovingShot", "MovingWalk", "animate_shot", "animate_walk", "save_shot", "save_walk",
        ],
        "gallery": ["FIGURES", "draw"],
    },
)  # fmt: skip

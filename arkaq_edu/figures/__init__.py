"""One function for each figure of the thesis, and the visual grammar they share.

`gallery.FIGURES` leads from a figure's number to its function, ``gallery.draw("5.10")`` draws it.
"""

import lazy_loader as _lazy

__getattr__, __dir__, __all__ = _lazy.attach(
    __name__,
    submodules=[
        "approach", "arkaq", "art", "belief", "drawing", "errata", "field",
        "gallery", "goal", "kalman", "learning", "mdp", "pomdp", "segmentation", "studies",
    ],
    submod_attrs={
        "drawing.animation": ["Film", "animate", "save_film"],
        "gallery": ["FIGURES", "draw"],
        "studies": ["plot_study"],
    },
)  # fmt: skip

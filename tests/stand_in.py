"""A stream of sightings made of random points, for tests that need any stream at all."""

import numpy as np

from arkaq_edu.arkaq import Sensing


def triangle_stream(n=5000, rng=0):
    """Patterns as equation 5.1 places the ball: depth uniform, then aside uniform to the border."""
    rng = np.random.default_rng(rng)
    depth = rng.uniform(200, 4100, n)
    aside = rng.uniform(-1, 1, n) * depth * np.tan(0.49)
    seen = np.column_stack([np.hypot(depth, aside), np.arctan2(aside, depth)])
    return Sensing.thesis().scale(seen)

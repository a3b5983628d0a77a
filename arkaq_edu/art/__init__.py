"""Adaptive resonance: categories that are learned without forgetting, and states made of them."""

from .art1 import ART1
from .art2 import ART2, match_norm
from .art2a import ART2A
from .euclidean import EuclideanART

__all__ = ["ART1", "ART2", "ART2A", "EuclideanART", "match_norm"]

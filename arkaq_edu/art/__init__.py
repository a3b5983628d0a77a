"""Adaptive resonance: categories that are learned without forgetting, and states made of them."""

from arkaq_edu.art.art1 import ART1
from arkaq_edu.art.art2 import ART2, match_norm
from arkaq_edu.art.art2a import ART2A
from arkaq_edu.art.euclidean import EuclideanART

__all__ = ["ART1", "ART2", "ART2A", "EuclideanART", "match_norm"]

"""Adaptive resonance: categories that are learned without forgetting, and states made of them."""

from arkaq_edu.art.art1 import ART1
from arkaq_edu.art.art2 import ART2
from arkaq_edu.art.art2a import ART2A
from arkaq_edu.art.euclidean import EuclideanART
from arkaq_edu.art.letters import LETTERS, learn_letters
from arkaq_edu.art.measures import coverage, quantization_error
from arkaq_edu.art.reset import learned_norm, match_norm, reset_cosine, reset_fact

__all__ = [
    "ART1",
    "ART2",
    "ART2A",
    "LETTERS",
    "EuclideanART",
    "coverage",
    "learn_letters",
    "learned_norm",
    "match_norm",
    "quantization_error",
    "reset_cosine",
    "reset_fact",
]

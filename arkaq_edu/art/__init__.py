"""Adaptive resonance: categories that are learned without forgetting, and states made of them."""

from .euclidean import EuclideanART

__all__ = ["EuclideanART"]

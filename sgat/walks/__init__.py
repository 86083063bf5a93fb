"""Grounding of walking robots: worlds, senses, and gaits to learn from."""

from sgat.walks.gait_cloud import GaitCloud

__all__ = ["GaitCloud"]

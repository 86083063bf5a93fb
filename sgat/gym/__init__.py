"""Grounding of Gymnasium environments."""

from sgat.gym.collect import collect
from sgat.gym.grounded_env import GroundedEnv

__all__ = ["GroundedEnv", "collect"]

"""Gymnasium environments: recording transitions, and transforming actions."""

from sgat.gym.collect import collect
from sgat.gym.grounded_env import GroundedEnv

__all__ = ["GroundedEnv", "collect"]

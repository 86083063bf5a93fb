"""Grounding of walking robots: worlds, senses, and gaits to learn from."""

from sgat.walks.gait_cloud import GaitCloud
from sgat.walks.grounded_world import GroundedWorld
from sgat.walks.walk_senses import WalkSenses, leg_senses
from sgat.walks.watched_world import WatchedWorld
from sgat.walks.world_wrapper import WorldWrapper

__all__ = [
    "GaitCloud",
    "GroundedWorld",
    "WalkSenses",
    "WatchedWorld",
    "WorldWrapper",
    "leg_senses",
]

"""A walking robot as a Gymnasium environment."""

from experiments.walk_env.ids import IDS, register_envs

__all__ = ["IDS", "register_envs"]

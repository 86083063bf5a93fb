"""A walk as an environment of Gymnasium."""

from experiments.walk_env.ids import IDS, register_envs

__all__ = ["IDS", "register_envs"]

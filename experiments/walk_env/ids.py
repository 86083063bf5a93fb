"""The walking environments by name.

import gymnasium as gym
from experiments.walk_env.ids import register_envs

register_envs()
env = gym.make("Groundwalk/Nao-Sim-v0")
"""

ENTRY_POINT = "experiments.walk_env.env:WalkEnv"
IDS = {
    "Groundwalk/Nao-Sim-v0": "sim",
    "Groundwalk/Nao-Real-v0": "real",
    "Groundwalk/Nao-Grounded-v0": "grounded",
}
"""Ids and worlds. All take the arguments of `experiments.walk_env.env.WalkEnv`."""


def register_envs() -> None:
    """Register the ids of `IDS` with Gymnasium; it may be called again.

    The code of an environment is imported when one is made.

    Example:
      >>> register_envs()
      >>> env = gymnasium.make("Groundwalk/Nao-Sim-v0")
    """
    import gymnasium

    for name, world in IDS.items():
        if name not in gymnasium.registry:
            gymnasium.register(
                name,
                entry_point=ENTRY_POINT,
                kwargs={"world": world},
            )

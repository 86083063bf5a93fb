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
"""Names and worlds. All take the arguments of `experiments.walk_env.env.WalkEnv`."""


def register_envs() -> None:
    """Make Gymnasium know the names of `IDS`; it may be called again.

    An environment's own code is imported when one is made.
    """
    import gymnasium

    for name, world in IDS.items():
        if name not in gymnasium.registry:
            gymnasium.register(
                name,
                entry_point=ENTRY_POINT,
                kwargs={"world": world},
            )

"""A walking robot as a Gymnasium environment, with ids for Gymnasium's registry."""

ENTRY_POINT = "experiments.walk_env.env:WalkEnv"
IDS = {
    "Groundwalk/Nao-Sim-v0": "sim",
    "Groundwalk/Nao-Real-v0": "real",
    "Groundwalk/Nao-Grounded-v0": "grounded",
}
"""Ids of the environments, and their worlds; all take the arguments of `WalkEnv`.

Example:
  >>> IDS["Groundwalk/Nao-Sim-v0"]
  'sim'
"""


def register_envs() -> None:
    """Register the walking environments with Gymnasium; it may be called again.

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

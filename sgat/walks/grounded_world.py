"""A world whose commands first pass through an action transformer."""

from collections.abc import Sequence

import numpy as np

from groundwalk.arrays import FloatArray
from sgat.transformers.transformer import Transformer
from sgat.walks.walk_senses import WalkSenses
from sgat.walks.world_wrapper import WorldWrapper
from worlds import Observation, World


class GroundedWorld(WorldWrapper):
    """A sim that behaves like the real world, because its commands are transformed.

    Each command passes through an action transformer before the sim gets it.

    Example:
      >>> senses = leg_senses(robots.get("nao"))
      >>> world = GroundedWorld(sim, senses, transformer, seeds)
    """

    def __init__(
        self,
        world: World,
        senses: WalkSenses,
        transformer: Transformer,
        seeds: Sequence[np.random.SeedSequence],
    ) -> None:
        """Put a transformer before a world.

        Args:
          world: the sim, with n robots.
          senses: makes the states and actions that the transformer sees.
          transformer: changes the actions.
          seeds: n seeds of the transformer's noise, one for each robot.
        """
        super().__init__(world)
        self._senses, self._transformer = senses, transformer
        self._seeds = list(seeds)

    def reset(self, pose_rad: FloatArray) -> Observation:
        """Put every robot on its ground, in poses (n, joints) [rad]."""
        observation = self.world.reset(pose_rad)
        self._senses.reset(observation)
        self._transformer.reset(self._seeds)
        return observation

    def step(self, command_rad: FloatArray) -> Observation:
        """Transform commands (n, joints) [rad], then advance the sim by one tick."""
        senses = self._senses
        action = self._transformer(senses.state(), senses.action(command_rad))
        transformed_rad = senses.command(action, command_rad)
        # In the data of the real world, too, past commands are those of the gait.
        senses.remember(command_rad)
        observation = self.world.step(transformed_rad)
        senses.observe(observation)
        return observation

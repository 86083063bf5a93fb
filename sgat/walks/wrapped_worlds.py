"""Worlds around another world, which transform commands or record transitions."""

from collections.abc import Sequence

import numpy as np

from groundwalk.arrays import BoolArray, FloatArray
from groundwalk.errors import BadValueError
from robots import Description
from sgat.transformers.catalogue import Transformer
from sgat.transitions import Transitions
from sgat.walks.walk_senses import WalkSenses
from worlds import End, Observation, Truth, World, WorldOptions


class WorldWrapper:
    """A world that passes every call on to the world inside; subclasses change some."""

    def __init__(self, world: World) -> None:
        """Choose the world inside."""
        self.world = world

    @property
    def description(self) -> Description:
        """The robot; all n are alike."""
        return self.world.description

    @property
    def n(self) -> int:
        """Number of robots."""
        return self.world.n

    @property
    def options(self) -> WorldOptions:
        """Options of the world inside."""
        return self.world.options

    @property
    def ended(self) -> list[End]:
        """Why each robot's rollout ended."""
        return self.world.ended

    @property
    def active(self) -> BoolArray:
        """(n,) whether each robot's rollout continues."""
        return self.world.active

    def reset(self, pose_rad: FloatArray) -> Observation:
        """Put every robot on its ground, in poses (n, joints) [rad]."""
        return self.world.reset(pose_rad)

    def step(self, command_rad: FloatArray) -> Observation:
        """Advance the active robots by one tick with commands (n, joints) [rad]."""
        return self.world.step(command_rad)

    def stop(self, robots: BoolArray) -> None:
        """End the rollouts of the robots in a mask (n,)."""
        self.world.stop(robots)

    def truth(self) -> Truth:
        """True poses, velocities and contacts of the robots, which no gait sees."""
        return self.world.truth()

    def close(self) -> None:
        """Release the resources of the world inside."""
        self.world.close()


class GroundedWorld(WorldWrapper):
    """A sim that behaves like the real world: a transformer changes its commands.

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
        """Put a transformer, with its senses, before a world.

        `seeds` are those of the transformer's noise, one for each robot.
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


EXPLORATION_MEMORY = 0.9
"""Correlation of the exploration noise from one tick to the next: it lasts about ten
ticks (0.1 s), long enough to move the torso."""

SETTLING_TICKS = 5
"""Number of ticks at the start that are not recorded: a state contains the commands of
the ticks before, of which the first ticks have too few."""


class WatchedWorld(WorldWrapper):
    """Records transitions of the world that it wraps, with noise on commands if asked.

    The walks of a gait alone hardly show the effect of an action, because each action
    comes at its own phase of the step. Noise that lasts for several ticks shows it.

    Example:
      >>> world = WatchedWorld(sim, leg_senses(robots.get("nao")))
      >>> walk_trials(world, gaits, rules)
      >>> world.transitions()
    """

    def __init__(
        self,
        world: World,
        senses: WalkSenses,
        exploration_rad: float | FloatArray = 0.0,
        seed: np.random.SeedSequence | None = None,
    ) -> None:
        """Wrap a world with n robots; the senses make what is recorded.

        `exploration_rad` is the standard deviation [rad] of the noise on the commands
        of the grounded joints: one number, or (n, 1). The noise grows from zero.
        """
        super().__init__(world)
        if not np.all(np.asarray(exploration_rad) >= 0):
            raise BadValueError("exploration must not be negative")
        if np.any(np.asarray(exploration_rad) > 0) and seed is None:
            raise BadValueError("exploration needs a seed")
        self._senses = senses
        self._exploration_rad = exploration_rad
        self._generator = np.random.default_rng(seed)

    def reset(self, pose_rad: FloatArray) -> Observation:
        """Start anew in poses (n, joints) [rad]; forget earlier transitions."""
        observation = self.world.reset(pose_rad)
        self._senses.reset(observation)
        self._noise = np.zeros((self.n, len(self._senses.joints)))
        self._rows: list[tuple[FloatArray, FloatArray, FloatArray]] = []
        self._walking: list[BoolArray] = []
        return observation

    def step(self, command_rad: FloatArray) -> Observation:
        """Advance by one tick, with noise added to the commands (n, joints) [rad]."""
        senses, walking = self._senses, self.active
        fresh = self._generator.standard_normal(self._noise.shape)
        scale = self._exploration_rad * np.sqrt(1 - EXPLORATION_MEMORY**2)
        self._noise = np.asarray(EXPLORATION_MEMORY * self._noise + scale * fresh)
        state = senses.state()
        # Added to the command and not to the action, so that zero noise changes no bit.
        given_rad = command_rad.copy()
        given_rad[:, senses.joints] += self._noise
        action = senses.action(given_rad)
        senses.remember(given_rad)
        observation = self.world.step(given_rad)
        senses.observe(observation)
        self._rows.append((state, action, senses.outcome()))
        sound = np.array([end is not End.DIVERGED for end in self.ended])
        self._walking.append(walking & sound)
        return observation

    def transitions(self) -> Transitions:
        """All transitions since the last reset, robot by robot."""
        noted = self._rows[SETTLING_TICKS:]
        if not noted:
            raise BadValueError(
                f"nothing was noted: walk more than {SETTLING_TICKS} ticks"
            )
        arrays = [np.stack(columns, axis=1) for columns in zip(*noted, strict=True)]
        keep = np.stack(self._walking[SETTLING_TICKS:], axis=1)
        episode = np.broadcast_to(np.arange(self.n)[:, None], keep.shape)
        return Transitions(*(array[keep] for array in (*arrays, episode)))

"""The base class of both worlds: everything but the physics."""

from abc import ABC, abstractmethod
from collections.abc import Sequence

import numpy as np

from groundwalk.arrays import BoolArray, FloatArray
from groundwalk.errors import BadValueError
from robots.description import Description
from terrain import Heightfield
from worlds.falls import EndRule
from worlds.latency import DelayLine
from worlds.observation import Observation, Truth
from worlds.sensor_noise import NoisySensors
from worlds.world import TICK_S, End, WorldOptions

Schedule = list[tuple[FloatArray, int]]
"""Targets (n, joints) [rad] of one tick, and for how many physics steps each acts."""

MOST_RAD = 1e6
"""A joint position beyond this [rad] is an error: no joint turns a million radians."""


class RolloutWorld(ABC):
    """n rollouts side by side; see `World` for the interface.

    It remembers which rollouts go on, delays commands by the latency and adds the
    sensors' noise. A subclass computes the physics.

    Attributes:
      description: the robot.
      options: how the world computes.
      active: (n,) robots whose rollout goes on.
      ended: why each robot's rollout ended.
    """

    def __init__(
        self,
        description: Description,
        grounds: Sequence[Heightfield],
        seeds: Sequence[np.random.SeedSequence],
        options: WorldOptions,
    ) -> None:
        """Remember the robots' grounds and seeds; nothing is computed yet.

        Args:
          description: the robot.
          grounds: one per robot; give one object n times to share it.
          seeds: one per robot, for its sensor noise.
          options: how the world computes.

        Raises:
          BadValueError: there is not one ground and one seed for each robot.
        """
        if not grounds or len(grounds) != len(seeds):
            raise BadValueError(
                f"{len(grounds)} grounds and {len(seeds)} seeds; a world needs one of "
                "each for every robot"
            )
        self.description = description
        self.options = options
        self._grounds = list(grounds)
        self._seeds = list(seeds)
        self._delay = DelayLine(options.latency_steps, options.steps_per_tick)
        self.active: BoolArray = np.zeros(len(grounds), bool)
        self.ended: list[End] = [End.NONE] * len(grounds)

    @property
    def n(self) -> int:
        """How many robots there are."""
        return len(self._grounds)

    def reset(self, pose_rad: FloatArray) -> Observation:
        """Put every robot on its ground; see `World.reset`."""
        targets = self._targets(pose_rad)
        if not _are_positions(targets).all():
            raise BadValueError(
                "a start pose holds a number that is no joint position; it must be "
                f"finite and within {MOST_RAD:g} rad"
            )
        self._start(targets)
        self._delay.reset(targets)
        self.active = np.ones(self.n, bool)
        self.ended = [End.NONE] * self.n
        self._ticks = np.zeros(self.n)
        noise = self.options.noise
        self._noise = None if noise is None else NoisySensors(noise, self._seeds)
        self._truth, self._clean = self._read()
        self._end_rule = EndRule(self._grounds, self._truth)
        return self._as_measured()

    def step(self, command_rad: FloatArray) -> Observation:
        """Advance the active robots by one tick; see `World.step`."""
        targets = self._targets(command_rad)
        # MuJoCo would take NaN for zero.
        self._end(End.DIVERGED, ~_are_positions(targets))
        schedule = list(self._delay.tick(targets))
        if self.active.any():
            self._advance(schedule)
            self._ticks[self.active] += 1
            self._take_stock()
        return self._as_measured()

    def stop(self, robots: BoolArray) -> None:
        """End the rollouts of robots (n,); see `World.stop`."""
        self.active = self.active & ~robots

    def truth(self) -> Truth:
        """True poses and velocities of the robots; see `World.truth`."""
        return self._truth

    @abstractmethod
    def close(self) -> None:
        """End processes and free memory."""

    @abstractmethod
    def _start(self, pose_rad: FloatArray) -> None:
        """Put every robot on its ground, upright and at rest, holding its pose."""

    @abstractmethod
    def _advance(self, schedule: Schedule) -> None:
        """Compute one tick of the active robots."""

    @abstractmethod
    def _read(self) -> tuple[Truth, Observation]:
        """Truth and noiseless observation of now; NaN for robots that blew up."""

    def _take_stock(self) -> None:
        """Read all states, and end the rollouts that are over.

        Robots that are not active keep their last state.
        """
        truth, observation = self._read()
        sound = truth.finite() & observation.finite()
        keep = self.active & sound
        for end, robots in self._end_rule(truth, sound).items():
            self._end(end, robots)
        self._truth = truth.where(keep, self._truth)
        self._clean = observation.where(keep, self._clean)

    def _end(self, end: End, robots: BoolArray) -> None:
        """End the rollouts of those robots (n,) that are active, for a reason."""
        for i in np.flatnonzero(robots & self.active):
            self.ended[i] = end
        self.active = self.active & ~robots

    def _targets(self, command_rad: FloatArray) -> FloatArray:
        """Commands (n, joints) as motor targets.

        Two joints that share a motor get the mean of their commands.
        """
        targets = np.array(command_rad, dtype=float)
        for first, second in self.description.coupled:
            mean = (targets[:, first] + targets[:, second]) / 2
            targets[:, first] = targets[:, second] = mean
        return targets

    def _as_measured(self) -> Observation:
        if self._noise is None:
            return self._clean
        return self._noise(self._clean, TICK_S)


def _are_positions(joints_rad: FloatArray) -> BoolArray:
    """(n,) whether all of a robot's numbers can be joint positions; NaN cannot."""
    return np.asarray(np.all(np.abs(joints_rad) < MOST_RAD, axis=1))

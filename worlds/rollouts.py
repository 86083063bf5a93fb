"""Base class of the sim and real worlds: latency, noise and ends, but no physics."""

import math
from abc import ABC, abstractmethod
from collections import deque
from collections.abc import Iterator, Mapping, Sequence

import numpy as np

from groundwalk.arrays import BoolArray, FloatArray
from groundwalk.errors import BadValueError
from robots.description import Description
from terrain import Heightfield
from worlds.observation import Observation, Truth, up_z
from worlds.sensor_noise import NoisySensors
from worlds.world import TICK_S, End, WorldOptions

FALL_TILT_RAD = math.radians(60)
"""A robot has fallen when its torso's up axis is more than 60 degrees from vertical."""
FALL_HEIGHT_RATIO = 0.5
"""A robot has fallen when its torso is lower than this share of its start height."""
DIVERGED_SPEED_M_S = 50.0
"""Torso speed along one axis [m/s] from which the physics counts as diverged. Walks
stay below 1 m/s and falls below 5 m/s."""


def fallen(
    up_z: FloatArray, height_m: FloatArray, start_height_m: float | FloatArray
) -> BoolArray:
    """(n,) whether robots have fallen, by the rule that all worlds share.

    From `up_z` (n,), the cosine of the angle between torso and vertical, and the
    torso's height above the ground below it, now (n,) and at the start of the rollout.
    """
    low = height_m < FALL_HEIGHT_RATIO * start_height_m
    return np.asarray((up_z < math.cos(FALL_TILT_RAD)) | low)


class EndRule:
    """Decides at each tick whose rollouts are over; call it with the robots' truth."""

    def __init__(self, grounds: Sequence[Heightfield], start: Truth) -> None:
        """Remember how high every torso starts on its ground; robots may share one."""
        shared = np.array([id(ground) for ground in grounds])
        rows = [np.flatnonzero(shared == one) for one in dict.fromkeys(shared.tolist())]
        self._shared_by = [(grounds[robots[0]], robots) for robots in rows]
        self._start_height_m, _ = self._above_ground(start)

    def __call__(self, truth: Truth, sound: BoolArray) -> Mapping[End, BoolArray]:
        """Masks (n,) of the rollouts that end now, by reason; each ends for one only.

        `sound` (n,) says which robots' states and measurements are all finite.
        """
        with np.errstate(invalid="ignore", over="ignore"):
            height_m, on_ground = self._above_ground(truth)
            fell = fallen(up_z(truth.base_orientation), height_m, self._start_height_m)
            speed_m_s = np.abs(truth.base_linear_velocity_m_s).max(axis=1)
            diverged = ~sound | ~(speed_m_s < DIVERGED_SPEED_M_S)
        return {
            End.DIVERGED: diverged,
            End.FALL: fell & ~diverged,
            End.LEFT_GROUND: ~(on_ground | fell | diverged),
        }

    def _above_ground(self, truth: Truth) -> tuple[FloatArray, BoolArray]:
        """(n,) height of each torso over its ground [m]; (n,) False beyond its edge."""
        x, y, z = truth.base_position_m.T
        height_m, on_ground = z.copy(), np.ones(len(z), bool)
        for ground, rows in self._shared_by:
            height_m[rows] -= ground.height_at(x[rows], y[rows])
            on_ground[rows] = ground.contains(x[rows], y[rows])
        return height_m, on_ground


class DelayLine:
    """Delays commands by a number of physics steps, not necessarily whole ticks."""

    def __init__(self, latency_steps: int, steps_per_tick: int) -> None:
        """Delay by a number of physics steps; call `reset` before the first tick."""
        self._steps_per_tick = steps_per_tick
        self._ticks, self._late_steps = divmod(latency_steps, steps_per_tick)
        self._commands: deque[FloatArray] = deque(maxlen=self._ticks + 2)

    def reset(self, command: FloatArray) -> None:
        """Start as if `command` (n, joints) [rad] had been given at all past ticks."""
        self._commands.extend([command] * (self._ticks + 2))

    def tick(self, command: FloatArray) -> Iterator[tuple[FloatArray, int]]:
        """Take a tick's command (n, joints), and give the delayed ones that act in it.

        Each of the one or two comes with the number of physics steps for which it acts.
        """
        self._commands.append(command)
        older, newer = self._commands[0], self._commands[1]
        if self._late_steps:
            yield older, self._late_steps
        yield newer, self._steps_per_tick - self._late_steps


Schedule = list[tuple[FloatArray, int]]
"""Joint position targets (n, joints) [rad] that act one after the other during a tick,
each with the number of physics steps for which it acts."""

MOST_RAD = 1e6
"""Largest accepted joint position or target [rad]; more can only be an error."""


class RolloutWorld(ABC):
    """A `World` of n robots without the physics, which a subclass computes.

    This class keeps track of the rollouts that go on, delays commands by the latency
    and adds the sensors' noise.
    """

    def __init__(
        self,
        description: Description,
        grounds: Sequence[Heightfield],
        seeds: Sequence[np.random.SeedSequence],
        options: WorldOptions,
    ) -> None:
        """Remember the robot, and grounds and seeds, one for each of n robots."""
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
        self._open()

    @property
    def n(self) -> int:
        """Number of robots."""
        return len(self._grounds)

    def reset(self, pose_rad: FloatArray) -> Observation:
        """Start n rollouts: put robots on its ground, in poses (n, joints) [rad]."""
        targets = self._targets(pose_rad)
        if not (np.abs(targets) < MOST_RAD).all():
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
        """Advance active robots by a tick of 10 ms with commands (n, joints) [rad]."""
        targets = self._targets(command_rad)
        # A NaN, which is not below the limit, would be zero to MuJoCo.
        in_range = np.all(np.abs(targets) < MOST_RAD, axis=1)
        self._end(End.DIVERGED, np.asarray(~in_range))
        schedule = list(self._delay.tick(targets))
        if self.active.any():
            self._advance(schedule)
            self._ticks[self.active] += 1
            self._take_stock()
        return self._as_measured()

    def stop(self, robots: BoolArray) -> None:
        """End the rollouts of the robots that are True in the mask (n,)."""
        self.active = self.active & ~robots

    def truth(self) -> Truth:
        """True poses and velocities of the robots, without noise."""
        return self._truth

    @abstractmethod
    def close(self) -> None:
        """End processes and free memory; the world cannot be used afterwards."""

    @abstractmethod
    def _open(self) -> None:
        """Refuse options that this world cannot have, and make its simulations."""

    @abstractmethod
    def _start(self, pose_rad: FloatArray) -> None:
        """Put every robot on its ground, upright, at rest, in pose (n, joints)."""

    @abstractmethod
    def _advance(self, schedule: Schedule) -> None:
        """Compute the physics of the active robots over one tick."""

    @abstractmethod
    def _read(self) -> tuple[Truth, Observation]:
        """Current truth and noiseless observation; NaN where the physics diverged."""

    def _take_stock(self) -> None:
        """Read all states after a tick, and end the rollouts that are over.

        The stored state of a robot that is inactive or not finite stays as it was.
        """
        truth, observation = self._read()
        sound = truth.finite() & observation.finite()
        keep = self.active & sound
        for end, robots in self._end_rule(truth, sound).items():
            self._end(end, robots)
        self._truth = truth.where(keep, self._truth)
        self._clean = observation.where(keep, self._clean)

    def _end(self, end: End, robots: BoolArray) -> None:
        """End, for the reason `end`, the active rollouts in the mask `robots` (n,)."""
        for i in np.flatnonzero(robots & self.active):
            self.ended[i] = end
        self.active = self.active & ~robots

    def _targets(self, command_rad: FloatArray) -> FloatArray:
        """Copy commands (n, joints) [rad]; joints that share a motor get their mean."""
        targets = np.array(command_rad, dtype=float)
        for first, second in self.description.coupled:
            mean = (targets[:, first] + targets[:, second]) / 2
            targets[:, first] = targets[:, second] = mean
        return targets

    def _as_measured(self) -> Observation:
        if self._noise is None:
            return self._clean
        return self._noise(self._clean, TICK_S)

"""One robot of the real world with hidden physics."""

from collections.abc import Sequence
from math import ceil

import numpy as np

from groundwalk.arrays import FloatArray
from robots.description import Description
from terrain import Heightfield
from worlds.hidden.drive import HiddenDrive
from worlds.hidden.effects.placed import Hidden, surroundings
from worlds.hidden.engine import BodySense, check_engine
from worlds.hidden.joints import HiddenJoints
from worlds.hidden.model import hidden_model
from worlds.hidden.plant import described_hidden_plant
from worlds.real.engines import hidden_engine
from worlds.real.robot import OUT_OF_REACH_M, BulletState
from worlds.world import WorldOptions

FINE_STEP_S = 0.0005
"""Longest physics step [s]: the servo law of hidden physics is explicit, and unstable
at steps some times as long."""


class HiddenRobot:
    """A robot on its ground, with the same methods as `BulletRobot`."""

    def __init__(
        self, description: Description, ground: Heightfield, options: WorldOptions
    ) -> None:
        """Connect a client of its own and load robot and ground.

        Raises:
          GroundwalkError: the robot has no such place, or the engine no such effect.
        """
        self._plant = described_hidden_plant(description, not options.fixed_base)
        self._fine = ceil(options.timestep_s / FINE_STEP_S - 1e-9)
        self._step_s = options.timestep_s / self._fine
        self._effects = _effects(options)
        under = None if options.fixed_base else ground
        self._world = hidden_engine(
            "bullet", self._plant, self._effects, self._step_s, under
        )
        self._bias_rad_s = surroundings(options.hidden).gyroscope_bias_rad_s

    def reset(self, pose_rad: FloatArray, height_m: float) -> BulletState:
        """Put the robot upright at the origin, its torso at a height, at rest."""
        # One step out of reach first: contacts of the last rollout would linger.
        self._world.reset(pose_rad, height_m + OUT_OF_REACH_M)
        self._world.step(np.zeros(len(pose_rad)))
        self._world.reset(pose_rad, height_m)
        self._drive = HiddenDrive(
            self._plant, self._effects, self._world, self._step_s, pose_rad
        )
        return self._state(self._world.sense())

    def step(self, schedule: Sequence[tuple[FloatArray, int]]) -> BulletState | None:
        """Advance by one tick; see `BulletRobot.step`."""
        for command, steps in schedule:
            self._drive.send(command)
            self._drive.advance(steps * self._fine)
        if not np.isfinite(self._world.position_rad).all():
            return None
        return self._state(self._world.sense())

    def close(self) -> None:
        """Disconnect the client."""
        self._world.close()

    def _state(self, sense: BodySense) -> BulletState:
        return BulletState(
            base_pose=np.concatenate([sense.position_m, sense.orientation]),
            base_velocity=np.concatenate([sense.linear_m_s, sense.angular_rad_s]),
            position_rad=self._drive.encoders(),
            velocity_rad_s=self._world.velocity_rad_s.copy(),
            gyroscope_rad_s=sense.gyroscope_rad_s + self._bias_rad_s,
            accelerometer_m_s2=sense.accelerometer_m_s2,
            foot_force_n=sense.foot_force_n,
        )


def check_hidden(description: Description, options: WorldOptions) -> None:
    """Refuse hidden physics that the robot cannot have, before processes start.

    Raises:
      GroundwalkError: it has no such place, or the engine no such effect.
    """
    if not options.hidden:
        return
    plant, effects = described_hidden_plant(description, False), _effects(options)
    check_engine("bullet", effects)
    hidden_model(plant, effects, FINE_STEP_S, None)
    HiddenJoints(plant, effects, FINE_STEP_S, np.ones(len(plant.joints)))


def _effects(options: WorldOptions) -> tuple[Hidden, ...]:
    """The options' own friction, then the hidden effects, which may override it."""
    sole = Hidden("contact_friction", "feet", {"coefficient": options.friction})
    return (sole, *options.hidden)

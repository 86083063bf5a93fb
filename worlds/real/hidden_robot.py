"""Robots of the world "real" with hidden effects, physics that the sim lacks."""

from collections.abc import Sequence
from math import ceil
from typing import TYPE_CHECKING

import numpy as np

from groundwalk.arrays import FloatArray
from robots.description import Description
from robots.engine_models.urdf import model_urdf
from terrain import Heightfield
from worlds.hidden.drive import HiddenDrive, HiddenJoints
from worlds.hidden.effects.placed import Hidden, surroundings
from worlds.hidden.engine import (
    ORIGIN_POSE,
    BodySense,
    HiddenEngine,
    check_engine,
    present,
)
from worlds.hidden.mujoco_engine import HiddenMujoco, hidden_model
from worlds.hidden.plant import HiddenPlant, described_hidden_plant
from worlds.real.body import BulletBody
from worlds.real.robot import BulletState, restart
from worlds.world import WorldOptions

if TYPE_CHECKING:
    import mujoco


def hidden_engine(
    name: str,
    plant: HiddenPlant,
    effects: Sequence[Hidden],
    step_s: float,
    ground: Heightfield | None,
) -> HiddenEngine:
    """Make the engine "bullet" or "mujoco" and load a robot with effects into it.

    `ground` is that under a floating robot; None for a fixed base.
    """
    check_engine(name, effects, plant.floating)
    model = hidden_model(plant, effects, step_s, ground)
    if name == "mujoco":
        return HiddenMujoco(plant, model)
    return HiddenBullet(plant, model, effects, ground)


class HiddenBullet(BulletBody):
    """A robot with hidden effects in PyBullet, with the methods of `HiddenEngine`.

    It is made from a MuJoCo model that has the effects on masses and gravity, so that
    both engines compute the same bodies under the same gravity.
    """

    def __init__(
        self,
        plant: HiddenPlant,
        model: "mujoco.MjModel",
        effects: Sequence[Hidden],
        ground: Heightfield | None,
    ) -> None:
        """Load robot and ground from the model; soft ground comes from the effects."""
        soles = np.flatnonzero(model.geom_contype == 1)
        spring = None
        if plant.description is not None:
            for effect in effects:
                found = effect.kind.foot_spring(effect.values, plant.description)
                spring = found or spring
        super().__init__(
            model_urdf(model, plant.name),
            plant.joints,
            plant.description,
            floating=plant.floating,
            step_s=float(model.opt.timestep),
            gravity_m_s2=model.opt.gravity.copy(),
            friction=float(model.geom_friction[soles[0], 0]) if soles.size else 0.0,
            spring=spring,
            ground=ground,
        )
        self._before = np.zeros(len(plant.joints))
        self._forget()

    def _forget(self) -> None:
        self._watched, self._feet = 0, np.zeros(8)
        self._earlier: FloatArray | None = None

    def reset(self, pose_rad: FloatArray, height_m: float) -> None:
        """Put the robot at rest in a pose (joints,), a floating base at this height."""
        super().reset(pose_rad, height_m)
        self._before = self.velocity_rad_s

    def step(self, torque_nm: FloatArray) -> None:
        """Advance one physics step under torques (joints,) and the preceding pushes."""
        late = self.velocity_rad_s
        if not self._floating:
            torque_nm = torque_nm + self._turning(present(late, self._before), late)
        self._before = late
        super().step(torque_nm)

    def _turning(self, now: FloatArray, late: FloatArray) -> FloatArray:
        """(j,) torques [N m] that turn forces due to speeds from `late` to `now`."""
        return self._against(now) - self._against(late)

    def _against(self, speed: FloatArray) -> FloatArray:
        """(j,) torques [N m] of gravity and of links that turn with (j,) speeds."""
        position, rest = self.position_rad.tolist(), [0.0] * len(speed)
        needed = self.bullet.calculateInverseDynamics
        return -np.array(needed(self.number, position, speed.tolist(), rest))

    def links_nm(self) -> FloatArray:
        """(j,) torques [N m] of gravity and turning links on a fixed base."""
        speed = present(self.velocity_rad_s, self._before)
        return self._against(speed)

    def watch(self) -> None:
        """Add this step's foot forces to the mean that `sense` will return."""
        if not self._floating:
            return
        if self._earlier is None:
            self._earlier = self.base_motion()[1]
        self._watched += 1
        self._feet += self.foot_forces()

    def sense(self) -> BodySense:
        """Read the sensors, averaged over the watched steps; forget those steps."""
        if not self._floating:
            felt = -self._gravity_m_s2 if self._description else np.zeros(3)
            return BodySense.of_base(ORIGIN_POSE, np.zeros(6), felt, np.zeros(8))
        pose, now = self.base_motion()
        earlier = now if self._earlier is None else self._earlier
        seconds = max(self._watched - 1, 1) * self._step_s
        felt = self.specific_force(pose, earlier, now, seconds)
        feet = self._feet / max(self._watched, 1)
        self._forget()
        return BodySense.of_base(pose, now, felt, feet)


FINE_STEP_S = 0.0005
"""Longest physics step [s] of robots with hidden effects (physics that the sim lacks).
Their servo torque is that at a step's start: unstable at a few times this length."""


class HiddenRobot:
    """A robot with hidden effects on its ground, with the methods of `BulletRobot`."""

    def __init__(
        self, description: Description, ground: Heightfield, options: WorldOptions
    ) -> None:
        """Connect a PyBullet client of its own, and load robot and ground into it."""
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
        """Put the robot at rest in a pose (joints,), its torso upright at a height."""
        restart(self._world, pose_rad, height_m)
        self._drive = HiddenDrive(
            self._plant, self._effects, self._world, self._step_s, pose_rad
        )
        return self._state(self._world.sense())

    def step(self, schedule: Sequence[tuple[FloatArray, int]]) -> BulletState | None:
        """Advance by one tick; the state is None if the physics diverged.

        The schedule holds commands (joints,) [rad], each with its number of steps.
        """
        for command, steps in schedule:
            self._drive.send(command)
            self._drive.advance(steps * self._fine)
        if not np.isfinite(self._world.position_rad).all():
            return None
        return self._state(self._world.sense())

    def close(self) -> None:
        """Disconnect the PyBullet client; the robot cannot be used afterwards."""
        self._world.close()

    def _state(self, sense: BodySense) -> BulletState:
        rate = sense.gyroscope_rad_s + self._bias_rad_s
        joints = self._drive.encoders(), self._world.velocity_rad_s
        return (*sense._replace(gyroscope_rad_s=rate), *joints)


def check_hidden(description: Description, options: WorldOptions) -> None:
    """Refuse hidden effects that a robot cannot have, before any process starts."""
    if not options.hidden:
        return
    plant, effects = described_hidden_plant(description, False), _effects(options)
    check_engine("bullet", effects, floating=not options.fixed_base)
    hidden_model(plant, effects, FINE_STEP_S, None)
    ones = np.ones(len(plant.joints))
    HiddenJoints(plant, effects, FINE_STEP_S, ones, ones.copy)


def _effects(options: WorldOptions) -> tuple[Hidden, ...]:
    """`options.friction` as an effect, then the hidden ones, which may replace it."""
    sole = Hidden("contact_friction", "feet", {"coefficient": options.friction})
    return (sole, *options.hidden)

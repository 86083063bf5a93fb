"""`World`, the interface of the sim (MuJoCo) and real (PyBullet) worlds; options."""

import enum
import math
from dataclasses import dataclass
from typing import Protocol

from groundwalk.arrays import BoolArray, FloatArray
from groundwalk.errors import BadValueError
from robots.description import Description
from robots.sole import FRICTION
from worlds.hidden.effects import Hidden, surroundings
from worlds.observation import Observation, Truth
from worlds.sensor_noise import SensorNoise

TICK_S = 0.01
"""Length of a control tick [s]: a command (joint position targets) holds this long.

Example:
  >>> round(7.5 / TICK_S)  # ticks of a trial of 7.5 s
  750
"""


class End(enum.StrEnum):
    """Why one robot's rollout ended; NONE while it goes on.

    Example:
      >>> End.LEFT_GROUND.value
      'left the ground'
    """

    NONE = ""
    FALL = "fall"
    DIVERGED = "diverged"
    LEFT_GROUND = "left the ground"


FALLS = (End.FALL, End.DIVERGED)
"""Reasons of `End` that count as falls; diverged physics is one of them.

Example:
  >>> End.FALL in FALLS
  True
"""


@dataclass(frozen=True)
class WorldOptions:
    """Settings of a world: physics step, latency, noise, ground contact, effects.

    Attributes:
      timestep_s: physics step; the control tick of 10 ms must be a multiple of it.
      latency_s: time until a command takes effect; a multiple of `timestep_s`.
      noise: noise of the sensors; None for perfect sensors.
      friction: coefficient between sole and ground.
      sinkage_m: how deep a robot at rest on one foot sinks in; 0 for hard ground.
      fixed_base: whether the torso is held in the air where it started.
      hidden: effects, such as backlash, for the real world only; a sim refuses them.
      threads: threads of the sim, or processes of the real world; 0 for one per core.

    Example:
      >>> WorldOptions(latency_s=0.036).latency_steps
      18
    """

    timestep_s: float = 0.002
    latency_s: float = 0.0
    noise: SensorNoise | None = None
    friction: float = FRICTION
    sinkage_m: float = 0.0
    fixed_base: bool = False
    hidden: tuple[Hidden, ...] = ()
    threads: int = 0

    def __post_init__(self) -> None:
        """Refuse steps that do not divide a tick of 10 ms, and impossible values."""
        for name in ("timestep_s", "latency_s", "friction", "sinkage_m"):
            value = getattr(self, name)
            if not (math.isfinite(value) and value >= 0):
                raise BadValueError(f"{name} is {value}; it must not be negative")
        steps = TICK_S / self.timestep_s if self.timestep_s else 0
        if round(steps) < 1 or abs(steps - round(steps)) > 1e-9:
            raise BadValueError(
                f"timestep_s is {self.timestep_s}: a tick of {TICK_S} s must be a "
                "whole number of steps"
            )
        delay = self.latency_s / self.timestep_s
        if abs(delay - round(delay)) > 1e-6:
            raise BadValueError(
                f"latency_s is {self.latency_s}: it must be a whole number of steps "
                f"of {self.timestep_s} s"
            )
        if self.hidden and self.sinkage_m:
            raise BadValueError("give only one of sinkage_m and hidden physics")
        if surroundings(self.hidden).bumps_m:
            raise BadValueError("uneven_ground: give the world an uneven ground")
        if self.threads < 0:
            raise BadValueError(f"threads is {self.threads}; it must not be negative")

    @property
    def steps_per_tick(self) -> int:
        """Physics steps in one control tick."""
        return round(TICK_S / self.timestep_s)

    @property
    def latency_steps(self) -> int:
        """Physics steps until a command takes effect."""
        return round(self.latency_s / self.timestep_s)


class World(Protocol):
    """n robots, each on its own ground, stepped together by joint commands.

    Example:
      >>> world = worlds.make("sim", robot, [ground], [np.random.SeedSequence(1)])
      >>> observation = world.reset(np.zeros((1, len(robot.joints))))
      >>> observation = world.step(observation.position_rad)
    """

    @property
    def description(self) -> Description:
        """Links, joints, motors and sensors of the robot; all n robots are alike."""

    @property
    def n(self) -> int:
        """Number of robots, those whose rollout has ended included."""

    @property
    def options(self) -> WorldOptions:
        """The settings with which this world was made."""

    @property
    def ended(self) -> list[End]:
        """Why each robot's rollout ended; `End.NONE` while it goes on."""

    @property
    def active(self) -> BoolArray:
        """(n,) True for robots whose rollout goes on."""

    def reset(self, pose_rad: FloatArray) -> Observation:
        """Put every robot upright and at rest at the origin of its ground.

        Its lower sole just touches the ground. The joint positions (n, joints) are held
        until the first command.
        """

    def step(self, command_rad: FloatArray) -> Observation:
        """Advance the active robots by one tick (10 ms); the others keep their state.

        The commands are joint position targets (n, joints) for this tick. Two joints
        that share a motor get the mean of their commands.
        """

    def stop(self, robots: BoolArray) -> None:
        """End the rollouts of the robots that are True in the mask (n,)."""

    def truth(self) -> Truth:
        """True poses and velocities of the robots, without noise."""

    def close(self) -> None:
        """End processes and free memory; the world cannot be used afterwards."""

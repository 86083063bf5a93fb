"""Variants of a plant: everything that effects can change, one row a variant."""

from dataclasses import dataclass, fields
from typing import TYPE_CHECKING

import numpy as np

from groundwalk.arrays import FloatArray

if TYPE_CHECKING:
    from diagnosis.effects.bases import TorqueEffect
    from diagnosis.plant.plant import Plant


@dataclass(frozen=True)
class Push:
    """A constant force on a body for some time.

    Example:
      >>> Push("torso", (5.0, 0.0, 0.0), start_s=2.0, duration_s=0.2)

    Attributes:
      body: name of the body.
      force_n: (x, y, z) in the world frame, at the body's centre of mass.
      start_s: in the recording's time.
      duration_s: how long the force acts.
    """

    body: str
    force_n: tuple[float, float, float]
    start_s: float
    duration_s: float


@dataclass(eq=False)
class Joints:
    """Numbers of servos and joints in n variants, arrays (n, j); neutral at first.

    Attributes:
      kp_factor: multiplies the servo's stiffness.
      damping_factor: multiplies the servo's damping and the motor's back-EMF.
      fade_1_s: share of the stiffness that is lost each second.
      max_torque_nm: limit in addition to the servo's own.
      setpoint_speed_rad_s: fastest speed of the servo's set-point.
      gap_rad: play between servo and joint; no torque passes within it.
      offset_rad: measured less true position; the servo acts on the measured one.
      coulomb_nm: dry friction.
      stribeck_nm: extra dry friction at standstill.
      stribeck_speed_rad_s: speed at which the extra friction has dropped to 37 %.
      load_share: dry friction as a share of the motor's torque, back-EMF included.
      spring_nm_rad: stiffness between motor and joint; infinite where they are rigid.
      spring_damping_nm_s_rad: damping between motor and joint.
    """

    kp_factor: FloatArray
    damping_factor: FloatArray
    fade_1_s: FloatArray
    max_torque_nm: FloatArray
    setpoint_speed_rad_s: FloatArray
    gap_rad: FloatArray
    offset_rad: FloatArray
    coulomb_nm: FloatArray
    stribeck_nm: FloatArray
    stribeck_speed_rad_s: FloatArray
    load_share: FloatArray
    spring_nm_rad: FloatArray
    spring_damping_nm_s_rad: FloatArray

    @classmethod
    def neutral(cls, n: int, j: int) -> "Joints":
        """Numbers (n, j) that leave the plant as it is."""
        values = {field.name: 0.0 for field in fields(cls)} | {
            "kp_factor": 1.0,
            "damping_factor": 1.0,
            "max_torque_nm": np.inf,
            "setpoint_speed_rad_s": np.inf,
            "stribeck_speed_rad_s": 0.1,
            "spring_nm_rad": np.inf,
        }
        return cls(**{name: np.full((n, j), value) for name, value in values.items()})


@dataclass(eq=False)
class Signals:
    """Delays and errors of the signals between robot and computer, arrays (n, ...).

    Attributes:
      command_delay_s: (n,) time until a command takes effect.
      sensor_delay_s: (n,) age of measured positions and velocities.
      gyro_bias_rad_s: (n, 3) added to the gyroscope.
    """

    command_delay_s: FloatArray
    sensor_delay_s: FloatArray
    gyro_bias_rad_s: FloatArray

    @classmethod
    def neutral(cls, n: int) -> "Signals":
        """Signals of n variants without delays and errors."""
        return cls(np.zeros(n), np.zeros(n), np.zeros((n, 3)))


@dataclass(eq=False)
class Outside:
    """Forces and ground that act on n variants from outside.

    Attributes:
      pushes: lists of pushes, one for each variant.
      drag_n_s_m: (n, bodies) force against a body's velocity [N s/m]; MuJoCo's order.
      bump_height_m: (n,) amplitude of uneven ground.
    """

    pushes: list[list[Push]]
    drag_n_s_m: FloatArray
    bump_height_m: FloatArray


class Variants:
    """n copies of a plant, each changed in its own way.

    Example:
      >>> variants = Variants(plant, 2)
      >>> variants.joints.gap_rad[1, variants.column("LKneePitch")] += 0.02
      >>> variants.field("dof_damping")[1, variants.dof("LKneePitch")] += 0.1

    Attributes:
      plant: that is varied.
      n: number of variants.
      joints: numbers of servos and joints.
      signals: delays and errors of signals.
      outside: forces and ground.
      fields: fields of MuJoCo's model that some variant changes, arrays (n, ...).
      torques: values (n, j, p) of effects that compute a torque themselves.
    """

    def __init__(self, plant: "Plant", n: int) -> None:
        """Make n variants that are the plant itself."""
        self.plant = plant
        self.n = n
        self.joints = Joints.neutral(n, len(plant.joints))
        self.signals = Signals.neutral(n)
        self.outside = Outside(
            [[] for _ in range(n)], np.zeros((n, plant.model.nbody)), np.zeros(n)
        )
        self.fields: dict[str, FloatArray] = {}
        self.torques: dict[TorqueEffect, FloatArray] = {}

    def field(self, name: str) -> FloatArray:
        """(n, ...) values of a field of MuJoCo's model, to be changed in place.

        Args:
          name: as `mujoco.batch.MODEL_FIELDS` has it, for example "opt.gravity".
        """
        if name not in self.fields:
            value = self.plant.model
            for part in name.split("."):
                value = getattr(value, part)
            nominal = np.asarray(value, float)
            self.fields[name] = np.repeat(nominal[None], self.n, axis=0)
        return self.fields[name]

    def torque_values(self, effect: "TorqueEffect", parameters: int) -> FloatArray:
        """(n, j, parameters) values of an effect's own torque, to be changed in place.

        Args:
          effect: that computes the torque.
          parameters: number of its values.
        """
        shape = self.n, len(self.plant.joints), parameters
        return self.torques.setdefault(effect, np.zeros(shape))

    def column(self, joint: str) -> int:
        """Column of a joint in arrays (n, j)."""
        return self.plant.joints.index(joint)

    def dof(self, joint: str) -> int:
        """MuJoCo's number of a joint's degree of freedom."""
        return self.plant.dofs[self.column(joint)]

    def body(self, name: str) -> int:
        """MuJoCo's number of a body."""
        return int(self.plant.model.body(name).id)

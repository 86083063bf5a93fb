"""Variants of a robot model: all that effects can change, with one row per variant."""

from dataclasses import dataclass, fields
from operator import attrgetter
from typing import TYPE_CHECKING

import numpy as np

from diagnosis.plant.plant import Plant
from groundwalk.arrays import FloatArray

if TYPE_CHECKING:
    from diagnosis.effects.base_kinds import TorqueEffect


@dataclass(frozen=True)
class Push:
    """A constant force (world frame) on a body's centre of mass for some time.

    The start is in the recording's time.
    """

    body: str
    force_n: tuple[float, float, float]
    start_s: float
    duration_s: float


@dataclass(eq=False)
class Joints:
    """What effects change at servos and joints of n model variants: arrays (n, j).

    Attributes:
      kp_factor: multiplies the servo's stiffness.
      damping_factor: multiplies the servo's damping and the motor's back-EMF.
      fade_1_s: share of the stiffness that is lost each second.
      off_share: share of the motor's torque that is lost from `off_start_s` to
        `off_end_s`, times of the recording.
      sag_1_nm: share of the supply's voltage, and so of all servos' strength, that is
        lost for each N m of the motor's torque.
      max_torque_nm: torque limit, where below the nominal servo's.
      setpoint_speed_rad_s: highest speed of the servo's set-point.
      setpoint_acceleration_rad_s2: its largest acceleration, see `replay.set_points`.
      integral_1_s: integral gain of the servo as a multiple of its stiffness.
      dead_band_rad: error below which the servo's stiffness does nothing.
      rate_share: share of the set-point's rate that the servo takes from the speed that
        it damps, see `replay.controllers`.
      gap_rad: total play between servo and joint; no torque passes within it.
      compliance_rad_nm: by how much gears with play yield per torque that passes.
      offset_rad: measured minus true position; the servo acts on the measured one.
      late_s: time by which the joint's reading is older than other joints'; the servo
        acts on its own, fresh one.
      stribeck_nm: extra dry friction at standstill.
      stribeck_speed_rad_s: speed at which the extra friction has dropped to 37 %.
      slip_nm: dry friction whose springs have all slipped, see `replay.presliding`.
      slip_rad: angle by which the last of its springs bends before it slips.
      stribeck_exponent: how abruptly it drops there; 2 for a Gaussian.
      load_share: dry friction as a share of the motor's torque, back-EMF included.
      link_share: the same of the torque that the links put on the joint: see
        `replay.dry_friction.DryFriction`.
      extra_load_share, extra_link_share: the same shares, only near standstill.
      extra_square_1_nm: share of the torque that gears carry, per N m of that torque,
        that is dry friction near standstill.
      angle_nm: the part of dry friction that changes with the angle, as it is at the
        angle `angle_from_rad`.
      angle_log_1_rad: logarithm of the factor by which it grows for each rad.
      spring_nm_rad: stiffness between motor and joint; infinite for a rigid gear.
      torque_factor: measured torque over the true one, where torques are compared.
    """

    kp_factor: FloatArray
    damping_factor: FloatArray
    fade_1_s: FloatArray
    off_share: FloatArray
    off_start_s: FloatArray
    off_end_s: FloatArray
    sag_1_nm: FloatArray
    max_torque_nm: FloatArray
    setpoint_speed_rad_s: FloatArray
    setpoint_acceleration_rad_s2: FloatArray
    integral_1_s: FloatArray
    dead_band_rad: FloatArray
    rate_share: FloatArray
    gap_rad: FloatArray
    compliance_rad_nm: FloatArray
    offset_rad: FloatArray
    late_s: FloatArray
    coulomb_nm: FloatArray
    stribeck_nm: FloatArray
    stribeck_speed_rad_s: FloatArray
    slip_nm: FloatArray
    slip_rad: FloatArray
    stribeck_exponent: FloatArray
    load_share: FloatArray
    link_share: FloatArray
    extra_load_share: FloatArray
    extra_link_share: FloatArray
    extra_square_1_nm: FloatArray
    angle_nm: FloatArray
    angle_log_1_rad: FloatArray
    angle_from_rad: FloatArray
    spring_nm_rad: FloatArray
    spring_damping_nm_s_rad: FloatArray
    torque_factor: FloatArray

    @classmethod
    def neutral(cls, n: int, j: int) -> "Joints":
        """Arrays (n, j) with values that leave the robot model as it is."""
        values = {field.name: 0.0 for field in fields(cls)} | {
            "kp_factor": 1.0,
            "damping_factor": 1.0,
            "max_torque_nm": np.inf,
            "setpoint_speed_rad_s": np.inf,
            "setpoint_acceleration_rad_s2": np.inf,
            "stribeck_speed_rad_s": 0.1,
            "stribeck_exponent": 2.0,
            "spring_nm_rad": np.inf,
            "torque_factor": 1.0,
        }
        return cls(**{name: np.full((n, j), value) for name, value in values.items()})


@dataclass(eq=False)
class Signals:
    """Delays of commands and encoders (n,), and gyroscope bias (n, 3) of n variants."""

    command_delay_s: FloatArray
    sensor_delay_s: FloatArray
    gyro_bias_rad_s: FloatArray


@dataclass(eq=False)
class Outside:
    """Pushes on each of n model variants, (n, bodies) drag, and (n,) ground bumps.

    `bump_height_m` is the largest height of bumps above or below the plane.
    """

    pushes: list[list[Push]]
    drag_n_s_m: FloatArray
    bump_height_m: FloatArray


class Variants:
    """n copies of a robot model, each changed by effects in its own way.

    Example:
      >>> variants = Variants(plant, 2)
      >>> variants.joints.gap_rad[1, variants.column("LKneePitch")] += 0.02
      >>> variants.field("dof_damping")[1, variants.dof("LKneePitch")] += 0.1

    `fields` has, by name, those fields of `MjModel` that some variant changes, arrays
    (n, ...); `torques` has for each `TorqueEffect` used its p values (n, j, p).
    """

    def __init__(self, plant: Plant, n: int) -> None:
        """Make n variants that are all equal to the robot model."""
        self.plant = plant
        self.n = n
        self.joints = Joints.neutral(n, len(plant.joints))
        self.signals = Signals(np.zeros(n), np.zeros(n), np.zeros((n, 3)))
        self.outside = Outside(
            [[] for _ in range(n)], np.zeros((n, plant.model.nbody)), np.zeros(n)
        )
        self.fields: dict[str, FloatArray] = {}
        self.torques: dict[TorqueEffect, FloatArray] = {}

    @property
    def late_s(self) -> FloatArray:
        """(n, j) time [s] by which each joint's reading is older than it says."""
        return self.signals.sensor_delay_s[:, None] + self.joints.late_s

    def field(self, name: str) -> FloatArray:
        """(n, ...) values of a field in `mujoco.batch.MODEL_FIELDS`, to be changed."""
        if name not in self.fields:
            nominal = np.asarray(attrgetter(name)(self.plant.model), float)
            self.fields[name] = np.repeat(nominal[None], self.n, axis=0)
        return self.fields[name]

    def at(
        self, quantity: str, row: int, place: str
    ) -> tuple[FloatArray, tuple[int, ...]]:
        """Array of a quantity, to be changed in place, and index of one value in it.

        The quantity is an attribute of `Joints`, `Signals` or `Outside`, or a field of
        `MjModel` with a row for each body or degree of freedom, such as "dof_damping".
        """
        if quantity in vars(self.joints):
            return vars(self.joints)[quantity], (row, self.column(place))
        if quantity in vars(self.signals):
            return vars(self.signals)[quantity], (row,)
        if quantity in vars(self.outside):
            array: FloatArray = vars(self.outside)[quantity]
            return array, (row, self.body(place)) if array.ndim > 1 else (row,)
        index = self.dof(place) if quantity.startswith("dof_") else self.body(place)
        return self.field(quantity), (row, index)

    def torque_values(self, effect: "TorqueEffect", parameters: int) -> FloatArray:
        """(n, j, parameters) values of a `TorqueEffect`, to be changed in place."""
        shape = self.n, len(self.plant.joints), parameters
        return self.torques.setdefault(effect, np.zeros(shape))

    def column(self, joint: str) -> int:
        """Index of a joint in arrays (n, j)."""
        return self.plant.joints.index(joint)

    def dof(self, joint: str) -> int:
        """MuJoCo's index of a joint's degree of freedom, as in `dof_damping`."""
        return self.plant.dofs[self.column(joint)]

    def body(self, name: str) -> int:
        """MuJoCo's id of a body."""
        return int(self.plant.model.body(name).id)

"""The servos that drive a robot model's joints: law, gains, and MuJoCo actuators."""

import sys
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import mujoco
import numpy as np

from groundwalk.arrays import FloatArray
from groundwalk.errors import BadValueError, UnknownNameError
from robots import Description
from worlds.recordings.metadata import ServoGains


def servo_torque(
    kp_nm_rad: FloatArray,
    kd_nm_s_rad: FloatArray,
    max_torque_nm: FloatArray,
    error_rad: FloatArray,
    velocity_rad_s: FloatArray,
) -> FloatArray:
    """The torque that servos ask for: clip(kp error - kd velocity, +-max_torque).

    The motors' back-EMF is not included. The error is the position command less the
    measured position; all arguments have shapes that broadcast against each other.
    """
    asked = kp_nm_rad * error_rad - kd_nm_s_rad * velocity_rad_s
    # several times as fast as np.clip for the few values of a physics step
    return np.asarray(np.minimum(np.maximum(asked, -max_torque_nm), max_torque_nm))


@dataclass(frozen=True, eq=False)
class Servo:
    """The servos of all j joints of a robot model.

    Their torque is clip(kp error - kd velocity, +-max_torque) - back_emf velocity,
    error being command less position: the firmware limits the torque that it asks for,
    but not the back-EMF of the motor. Sliding joints have N for N m and m for rad.

    Attributes:
      kp_nm_rad: (j,) stiffness.
      kd_nm_s_rad: (j,) damping, inside the torque limit.
      max_torque_nm: (j,) torque limit; infinite where there is none.
      back_emf_nm_s_rad: (j,) damping outside the torque limit.

    Raises:
      BadValueError: a value is negative or NaN, or the arrays differ in length.
    """

    kp_nm_rad: FloatArray
    kd_nm_s_rad: FloatArray
    max_torque_nm: FloatArray
    back_emf_nm_s_rad: FloatArray

    def __post_init__(self) -> None:
        """Refuse negative values and arrays of unequal lengths."""
        for name, values in vars(self).items():
            if values.shape != self.kp_nm_rad.shape:
                raise BadValueError(f"{name} must have one value for each joint")
            if np.isnan(values).any() or (values < 0).any():
                raise BadValueError(f"{name} must not be negative: {values}")

    def torque(self, error_rad: FloatArray, velocity_rad_s: FloatArray) -> FloatArray:
        """(..., j) torques [N m] that the servos ask for, see `servo_torque`."""
        gains = self.kp_nm_rad, self.kd_nm_s_rad, self.max_torque_nm
        return servo_torque(*gains, error_rad, velocity_rad_s)

    def of(self, columns: Sequence[int]) -> "Servo":
        """The servos of the joints with these indices."""
        return Servo(*(values[list(columns)] for values in vars(self).values()))

    @classmethod
    def ideal(cls, joints: int) -> "Servo":
        """Servos of `joints` joints without stiffness, damping, limit and back-EMF."""
        zero = np.zeros(joints)
        return cls(zero, zero, np.full(joints, np.inf), zero)


Gains = Mapping[str, ServoGains] | ServoGains
"""Servo gains by the joint's name, or one set of gains for all joints."""


def described_servo(description: Description, joints: Sequence[str]) -> Servo:
    """Servos of joints of a robot description; motor damping counts as back-EMF."""
    motors = [
        description.links[description.joints.index(name)].motor for name in joints
    ]
    return Servo(
        np.array([motor.kp_nm_rad for motor in motors]),
        np.zeros(len(motors)),
        np.array([motor.stall_torque_nm for motor in motors]),
        np.array([motor.kd_nm_s_rad for motor in motors]),
    )


def model_servo(model: mujoco.MjModel, joints: Sequence[str]) -> Servo:
    """Read the servos of a compiled model; joints without any get zero stiffness.

    Stiffness and damping are those of position actuators (fixed gain, affine bias)
    times their gear squared. The torque limit is the tightest of the actuators' limits
    and the joint's own (`actuatorfrcrange`, which is a URDF's effort).
    """
    servo = Servo.ideal(len(joints))
    kp, kd = servo.kp_nm_rad, servo.kd_nm_s_rad.copy()
    limit = servo.max_torque_nm
    for column, name in enumerate(joints):
        joint = model.joint(name).id
        if model.jnt_actfrclimited[joint]:
            limit[column] = np.abs(model.jnt_actfrcrange[joint]).max()
        for actuator in _actuators_of(model, joint):
            gear = abs(float(model.actuator_gear[actuator, 0]))
            _, stiffness, damping = -model.actuator_biasprm[actuator, :3]
            if stiffness > 0:
                kp[column] += stiffness * gear**2
                kd[column] += damping * gear**2
            if model.actuator_forcelimited[actuator]:
                most = np.abs(model.actuator_forcerange[actuator]).max() * gear
                limit[column] = min(limit[column], most)
    return Servo(kp, kd, limit, np.zeros(len(joints)))


def with_gains(servo: Servo, joints: Sequence[str], gains: Gains | None) -> Servo:
    """Replace the servo gains of some or all joints.

    Gains without back-EMF have only one damping. At a joint whose servo has back-EMF it
    replaces the back-EMF, at others the damping inside the torque limit. The largest
    float as `max_torque` stands for no limit. None changes nothing.

    Raises:
      UnknownNameError: there are gains for a joint that does not exist.
    """
    if gains is None:
        return servo
    if isinstance(gains, ServoGains):
        gains = dict.fromkeys(joints, gains)
    values = {name: array.copy() for name, array in vars(servo).items()}
    for name, given in gains.items():
        if name not in joints:
            raise UnknownNameError("joint with servo gains", name, joints)
        column = list(joints).index(name)
        is_emf = servo.back_emf_nm_s_rad[column] > 0 and given.back_emf == 0
        values["kp_nm_rad"][column] = given.kp
        values["back_emf_nm_s_rad" if is_emf else "kd_nm_s_rad"][column] = given.kd
        if given.back_emf > 0:
            values["back_emf_nm_s_rad"][column] = given.back_emf
        unlimited = given.max_torque >= sys.float_info.max
        values["max_torque_nm"][column] = np.inf if unlimited else given.max_torque
    return replace(servo, **values)


def add_rotors(spec: mujoco.MjSpec, joints: Sequence[str], gains: Gains | None) -> None:
    """Give joints without rotor inertia the one that is stated with their gains."""
    for name in joints:
        given = gains.get(name) if isinstance(gains, Mapping) else gains
        joint = spec.joint(name)
        if given is not None and given.armature > 0 and joint.armature == 0:
            joint.armature = given.armature


def remove_actuators(spec: mujoco.MjSpec) -> None:
    """Remove all actuators, sensors of actuators and keyframes from a model."""
    kind = mujoco.mjtObj.mjOBJ_ACTUATOR
    sensors = [sensor for sensor in spec.sensors if sensor.objtype == kind]
    # the keyframes' controls would be of the wrong number
    for part in (*sensors, *list(spec.keys), *list(spec.actuators)):
        spec.delete(part)


def add_servos(spec: mujoco.MjSpec, joints: Sequence[str], servo: Servo) -> None:
    """Add one affine actuator for each joint to a model, named as the joint.

    Its force is clip(kp (control - q) - kd v, +-max_torque) at joint position q and
    velocity v; the back-EMF becomes damping of the joint.
    """
    for column, name in enumerate(joints):
        joint = spec.joint(name)
        joint.actfrclimited = mujoco.mjtLimited.mjLIMITED_FALSE.value
        emf = float(servo.back_emf_nm_s_rad[column])
        joint.damping = [joint.damping[0] + emf, *joint.damping[1:]]
        kp, kd = float(servo.kp_nm_rad[column]), float(servo.kd_nm_s_rad[column])
        actuator = spec.add_actuator(
            name=name,
            target=name,
            trntype=mujoco.mjtTrn.mjTRN_JOINT,
            gaintype=mujoco.mjtGain.mjGAIN_FIXED,
            biastype=mujoco.mjtBias.mjBIAS_AFFINE,
        )
        actuator.gainprm = _padded([kp], len(actuator.gainprm))
        actuator.biasprm = _padded([0.0, -kp, -kd], len(actuator.biasprm))
        limit = float(servo.max_torque_nm[column])
        if np.isfinite(limit):
            actuator.forcerange = [-limit, limit]
            actuator.forcelimited = mujoco.mjtLimited.mjLIMITED_TRUE.value


def _actuators_of(model: mujoco.MjModel, joint: int) -> list[int]:
    at_joint = (mujoco.mjtTrn.mjTRN_JOINT, mujoco.mjtTrn.mjTRN_JOINTINPARENT)
    kinds = [kind.value for kind in at_joint]
    return [
        actuator
        for actuator in range(model.nu)
        if model.actuator_trntype[actuator] in kinds
        and model.actuator_trnid[actuator, 0] == joint
    ]


def _padded(values: list[float], length: int) -> FloatArray:
    return np.array([*values, *[0.0] * (length - len(values))])

"""Reads servo gains from robot descriptions and models, and adds servos to models."""

import sys
from collections.abc import Mapping, Sequence
from dataclasses import replace

import mujoco
import numpy as np

from diagnosis.plant.servo import Servo
from groundwalk.arrays import FloatArray
from groundwalk.errors import UnknownNameError
from robots import Description
from worlds.recordings.metadata import ServoGains

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

    New gains have only one damping. At a joint whose servo has back-EMF it replaces the
    back-EMF, at others the damping inside the torque limit. The largest float as
    `max_torque` stands for no limit. None changes nothing.

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
        is_emf = servo.back_emf_nm_s_rad[column] > 0
        values["kp_nm_rad"][column] = given.kp
        values["back_emf_nm_s_rad" if is_emf else "kd_nm_s_rad"][column] = given.kd
        unlimited = given.max_torque >= sys.float_info.max
        values["max_torque_nm"][column] = np.inf if unlimited else given.max_torque
    return replace(servo, **values)


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

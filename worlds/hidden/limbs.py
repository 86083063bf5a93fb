"""Arms and legs of example-robot-data on a fixed base, as nominal robots with servos.

A model file states masses, ranges and often the largest torques; it states no rotors
and no servos. They are chosen by one rule for all limbs, see `limb_plant`.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import product
from typing import TYPE_CHECKING

import numpy as np

from groundwalk.arrays import FloatArray
from groundwalk.errors import UnknownNameError
from robots.engine_models.mjcf import quiet_mujoco
from robots.engine_models.urdf import model_urdf
from worlds.hidden.plant import HiddenPlant, example_urdf, hidden_plant, hinged_plant

if TYPE_CHECKING:
    import mujoco

_ROTOR_RAD_S2 = 400.0
"""Acceleration [rad/s^2] that a motor's largest torque gives its own rotor, both seen
through the gear: 0.2 kg m^2 for 87 N m, 0.08 for 33 N m, about as in real arms."""
_SERVO_RAD_S, _SERVO_DAMPING = 40.0, 0.7
"""Natural frequency [rad/s] and damping ratio of a servo that holds its joint, all
other joints locked: about those of the SO-101's servos."""
_MOST_SAG_RAD = 0.08
"""A servo is stiffer where it would otherwise sag more than this under gravity."""
_RIGID = 200.0
"""Stiffness of gear teeth that touch, as a multiple of a servo's: they take no share of
the error of a strong servo."""
_FASTEST_RAD_S = 4.0
"""Highest speed of commands where the model file allows more, as of the SO-101."""
_ENDLESS_RAD = (-2.5, 2.5)
"""Range of a joint for which the model file states none."""
_POSES = (0.25, 0.5, 0.75)
"""Positions of each joint, as shares of its range, at which weight and inertia are
measured, in all combinations of the first four joints."""


@dataclass(frozen=True)
class Limb:
    """An arm or leg: the end of its URDF's path, and what the file does not say.

    Attributes:
      tail: end of the file's path in example-robot-data.
      ends: joints from which on all is cut away, as grippers and other legs.
      torque_nm: largest torque of every joint [N m]; None for that of the file.
      speed_rad_s: highest speed of every joint [rad/s]; None for that of the file.
      range_rad: range of every joint [rad]; None for that of the file.
    """

    tail: str
    ends: tuple[str, ...] = ()
    torque_nm: float | None = None
    speed_rad_s: float | None = None
    range_rad: tuple[float, float] | None = None


def _other_legs(*sides: str) -> tuple[str, ...]:
    return tuple(f"{side}_hip_joint" for side in sides)


_FINGERS = ("panda_finger_joint1", "panda_finger_joint2")
_SOLO_LEGS = ("FR_HAA", "HL_HAA", "HR_HAA")
LIMBS = {
    "two_dof": Limb("/TwoDofs.urdf", torque_nm=8.0, speed_rad_s=4.0),
    "double_pendulum": Limb(
        "/double_pendulum_simple.urdf", torque_nm=3.0, speed_rad_s=4.0
    ),
    "z1": Limb("/z1.urdf", ("jointGripper",)),
    "ur5": Limb("/ur5_robot.urdf", range_rad=_ENDLESS_RAD),
    "kinova": Limb("/kinova.urdf", speed_rad_s=1.5),
    "panda": Limb("/panda.urdf", _FINGERS),
    "xarm7": Limb("/xarm7.urdf"),
    "a1_leg": Limb("/a1.urdf", _other_legs("FL", "RR", "RL")),
    "go2_leg": Limb("/go2.urdf", _other_legs("FR", "RL", "RR")),
    "solo_leg": Limb("/solo12.urdf", _SOLO_LEGS, 2.7, 4.0, (-1.5, 1.5)),
}
"""The limbs by name. Where numbers are given, the file has none, or one that stands for
"any" (1000 N m); solo's torque is its motors'."""


def limb_plant(name: str) -> HiddenPlant:
    """The nominal limb of a name in `LIMBS`, or "so101" as `hidden_plant` has it.

    The rotor's inertia, which is lumped into each link, is in proportion to the joint's
    largest torque. Each servo has the same natural frequency and damping ratio at the
    inertia of its joint, and more stiffness where gravity is strong.

    Raises:
      UnknownNameError: there is no such limb.
      BadValueError: the files of example-robot-data are not installed.

    Example:
      >>> limb_plant("a1_leg").joints
      ('FR_hip_joint', 'FR_thigh_joint', 'FR_calf_joint')
    """
    if name == "so101":
        return hidden_plant(name)
    if name not in LIMBS:
        raise UnknownNameError("limb", name, ("so101", *LIMBS))
    import mujoco

    quiet_mujoco()  # no warnings on joints without a range
    limb = LIMBS[name]
    text = example_urdf(limb.tail)
    torque_nm, speed_rad_s = _limits(limb, text)
    spec = mujoco.MjSpec.from_string(text)
    for end in limb.ends:
        spec.delete(spec.joint(end).parent)
    for joint in spec.joints:
        if limb.range_rad is not None or joint.range[0] >= joint.range[1]:
            joint.range = limb.range_rad or _ENDLESS_RAD
            joint.limited = mujoco.mjtLimited.mjLIMITED_TRUE
    model = spec.compile()
    joints = [model.joint(i).name for i in range(model.njnt)]
    most = np.array([torque_nm[joint] for joint in joints])
    urdf = model_urdf(model, name, most / _ROTOR_RAD_S2, most)
    fastest = [min(speed_rad_s[joint], _FASTEST_RAD_S) for joint in joints]
    servo = _servos(urdf, most, np.array(fastest))
    plant = hinged_plant(name, "nominal.urdf", urdf, servo)
    return replace(plant, rigid=_RIGID)


def _limits(limb: Limb, text: str) -> tuple[dict[str, float], dict[str, float]]:
    """Largest torque [N m] and speed [rad/s] of each joint, by name."""
    from xml.etree import ElementTree

    torque, speed = {}, {}
    for joint in ElementTree.fromstring(text).iter("joint"):
        limit = joint.find("limit")
        if limit is not None:
            name = joint.get("name", "")
            torque[name] = limb.torque_nm or float(limit.get("effort", "nan"))
            speed[name] = limb.speed_rad_s or float(limit.get("velocity", "nan"))
    return torque, speed


def _servos(urdf: str, torque_nm: FloatArray, speed_rad_s: FloatArray) -> FloatArray:
    """(j, 4) kp, kd, largest torque and speed of the servos of a limb with a URDF."""
    import mujoco

    model = mujoco.MjModel.from_xml_string(urdf)
    inertia, weight_nm = _loads(model, _poses(model))
    kp = np.maximum(inertia * _SERVO_RAD_S**2, weight_nm / _MOST_SAG_RAD)
    kd = 2 * _SERVO_DAMPING * np.sqrt(kp * inertia)
    return np.stack([kp, kd, torque_nm, speed_rad_s], axis=1)


def _poses(model: "mujoco.MjModel") -> list[FloatArray]:
    """Poses (j,) [rad] with all positions in `_POSES` of the first four joints."""
    low, high = model.jnt_range.T
    moved = min(model.njnt, 4)
    rest = (0.5,) * (model.njnt - moved)
    every = product(_POSES, repeat=moved)
    return [low + np.array([*shares, *rest]) * (high - low) for shares in every]


def _loads(
    model: "mujoco.MjModel", poses: Sequence[FloatArray]
) -> tuple[FloatArray, FloatArray]:
    """(j,) mean inertia with all other joints locked, and largest torque by gravity."""
    import mujoco

    data, mass = mujoco.MjData(model), np.zeros((model.nv, model.nv))
    inertias, weights = [], []
    for pose in poses:
        data.qpos[:] = pose
        mujoco.mj_forward(model, data)
        mujoco.mj_fullM(model, data, mass)
        inertias.append(np.diag(mass).copy())
        weights.append(np.abs(data.qfrc_bias))
    return np.mean(inertias, axis=0), np.max(weights, axis=0)

"""Typical torques, speeds and masses of a robot, for bounds of effects' parameters.

Where recordings state known loads, the robot with the heaviest one counts.
"""

from functools import lru_cache

import mujoco
import numpy as np

from diagnosis.plant.loads import model_under
from diagnosis.plant.plant import Plant
from groundwalk.gravity import GRAVITY_M_S2

REFERENCE_SPEED_RAD_S, REFERENCE_SPEED_M_S = 5.0, 0.5
"""Speed in brisk use of a hinge and of a sliding joint, assumed where the motor is not
known."""

_SERVO_ERROR_RAD = 0.1
"""Servo error [rad] whose torque counts as large, for a servo without torque limit."""

_ACCELERATION_RAD_S2 = 5.0
"""Acceleration [rad/s^2] whose torque counts as large, for a joint without servo."""


def torque_nm(plant: Plant, joint: str) -> float:
    """A large torque [N m] for a joint, always above 0.

    It is the servo's limit, or its torque at an error of 0.1 rad; without a servo the
    largest of gravity's torque, that for 5 rad/s^2, and those measured.
    """
    column = plant.joints.index(joint)
    limit = float(plant.servo.max_torque_nm[column])
    if 0 < limit < np.inf:
        return limit
    stiffness = float(plant.servo.kp_nm_rad[column])
    if stiffness > 0:
        return _SERVO_ERROR_RAD * stiffness
    gravity = _gravity_torque_nm(plant, joint)
    used = 0.0 if plant.used_nm is None else float(plant.used_nm[column])
    return max(gravity, _ACCELERATION_RAD_S2 * inertia_kg_m2(plant, joint), used)


WEAK = 0.01
"""Share of a large torque that weak friction takes, as in every gear."""


def weak_friction_nm(plant: Plant, joint: str) -> float:
    """Friction torque [N m] that every gear has; 0 for a joint without a motor."""
    column = plant.joints.index(joint)
    driven = plant.used_nm is not None or plant.servo.kp_nm_rad[column] > 0
    return WEAK * torque_nm(plant, joint) if driven else 0.0


def inertia_kg_m2(plant: Plant, joint: str) -> float:
    """A joint's entry in the mass matrix's diagonal, in the reference pose."""
    dof, found = plant.dofs[plant.joints.index(joint)], []
    for model, data in _at_rest(plant):
        mass_matrix = np.zeros((model.nv, model.nv))
        mujoco.mj_fullM(model, data, mass_matrix)
        found.append(float(mass_matrix[dof, dof]))
    return max(found)


def speed_rad_s(plant: Plant, joint: str) -> float:
    """No-load speed of a joint's motor [rad/s]; without it a speed in brisk use."""
    column = plant.joints.index(joint)
    limit = float(plant.servo.max_torque_nm[column])
    back_emf = float(plant.servo.back_emf_nm_s_rad[column])
    if back_emf > 0 and np.isfinite(limit):
        return limit / back_emf
    return brisk_rad_s(plant, joint)


def brisk_rad_s(plant: Plant, joint: str) -> float:
    """Speed of a joint in brisk use: 5 rad/s for a hinge, 0.5 m/s for a slider."""
    number = plant.model.joint(joint).id
    slides = plant.model.jnt_type[number] == mujoco.mjtJoint.mjJNT_SLIDE
    return REFERENCE_SPEED_M_S if slides else REFERENCE_SPEED_RAD_S


def range_rad(plant: Plant, joint: str) -> tuple[float, float]:
    """Lowest and highest angle of a joint's range; -pi and pi if it has no range."""
    view = plant.model.joint(joint)
    if not plant.model.jnt_limited[view.id]:
        return -np.pi, np.pi
    low, high = plant.model.jnt_range[view.id]
    return float(low), float(high)


def middle_rad(plant: Plant, joint: str) -> float:
    """Middle of the range that the model states for a joint, 0 if it states none.

    Also where the range was lifted, since recordings go beyond it.
    """
    low, high = plant.model.joint(joint).range
    return float(low + high) / 2


def mass_kg(plant: Plant) -> float:
    """Mass of the whole robot model."""
    carried = (sum(one.mass for one in loads.values()) for loads in plant.loads)
    return float(plant.model.body_mass.sum()) + max(carried, default=0.0)


def weight_n(plant: Plant) -> float:
    """Weight of the robot on Earth [N], even if its model has no gravity."""
    return GRAVITY_M_S2 * mass_kg(plant)


def _gravity_torque_nm(plant: Plant, joint: str) -> float:
    """Largest torque [N m] about a hinge that gravity of any direction can cause.

    The robot is in its reference pose. For a sliding joint, the weight [N] it carries.
    """
    return max(_gravity_on(model, data, joint) for model, data in _at_rest(plant))


def _gravity_on(model: mujoco.MjModel, data: mujoco.MjData, joint: str) -> float:
    """Largest torque [N m] of gravity about a joint of one model, posed as `data`."""
    number = model.joint(joint).id
    body = int(model.jnt_bodyid[number])
    weight = GRAVITY_M_S2 * float(model.body_subtreemass[body])
    if model.jnt_type[number] == mujoco.mjtJoint.mjJNT_SLIDE:
        return weight
    arm = data.subtree_com[body] - data.xanchor[number]
    axis = data.xaxis[number]
    return weight * float(np.linalg.norm(arm - axis * (axis @ arm)))


@lru_cache(maxsize=4)
def _at_rest(plant: Plant) -> tuple[tuple[mujoco.MjModel, mujoco.MjData], ...]:
    """The robot model at rest in its reference pose: bare, and with each known load.

    Kept for the plants asked for last: bounds of effects ask a thousand times. None
    may be changed.
    """
    models = [model_under(plant, loads) for loads in ({}, *plant.loads)]
    posed = tuple((model, mujoco.MjData(model)) for model in models)
    for model, data in posed:
        mujoco.mj_forward(model, data)
    return posed

"""How large things are at a place of a plant: what effects' bounds are made of."""

from typing import TYPE_CHECKING, Any

import numpy as np

from groundwalk.gravity import GRAVITY_M_S2

if TYPE_CHECKING:
    from diagnosis.plant.plant import Plant

REFERENCE_SPEED_RAD_S, REFERENCE_SPEED_M_S = 5.0, 0.5
"""A brisk joint, where nothing better is known: a hinge and a slide."""

_SERVO_ERROR_RAD = 0.1
_ACCELERATION_RAD_S2 = 5.0


def torque_nm(plant: "Plant", joint: str) -> float:
    """What counts as a large torque at a joint; always above 0.

    The servo's limit; without one its torque at an error of 0.1 rad; without a
    servo the larger of what gravity can do and what an acceleration of 5 rad/s^2
    takes.
    """
    column = plant.joints.index(joint)
    limit = float(plant.servo.max_torque_nm[column])
    if 0 < limit < np.inf:
        return limit
    stiffness = float(plant.servo.kp_nm_rad[column])
    if stiffness > 0:
        return _SERVO_ERROR_RAD * stiffness
    gravity = _gravity_torque_nm(plant, joint)
    return max(gravity, _ACCELERATION_RAD_S2 * inertia_kg_m2(plant, joint))


def inertia_kg_m2(plant: "Plant", joint: str) -> float:
    """Inertia that a joint feels in the reference pose: its place in M's diagonal."""
    import mujoco

    model, data = plant.model, _reference(plant)
    mass_matrix = np.zeros((model.nv, model.nv))
    mujoco.mj_fullM(model, data, mass_matrix)
    dof = plant.dofs[plant.joints.index(joint)]
    return float(mass_matrix[dof, dof])


def speed_rad_s(plant: "Plant", joint: str) -> float:
    """No-load speed of a joint's motor; a brisk joint's where it is not known."""
    column = plant.joints.index(joint)
    limit = float(plant.servo.max_torque_nm[column])
    back_emf = float(plant.servo.back_emf_nm_s_rad[column])
    if back_emf > 0 and np.isfinite(limit):
        return limit / back_emf
    return brisk_rad_s(plant, joint)


def brisk_rad_s(plant: "Plant", joint: str) -> float:
    """A speed that a joint is used at; of a slide in m/s."""
    import mujoco

    number = plant.model.joint(joint).id
    slides = plant.model.jnt_type[number] == mujoco.mjtJoint.mjJNT_SLIDE
    return REFERENCE_SPEED_M_S if slides else REFERENCE_SPEED_RAD_S


def range_rad(plant: "Plant", joint: str) -> tuple[float, float]:
    """A joint's range; half a turn both ways where it has none."""
    view = plant.model.joint(joint)
    if not plant.model.jnt_limited[view.id]:
        return -np.pi, np.pi
    low, high = plant.model.jnt_range[view.id]
    return float(low), float(high)


def mass_kg(plant: "Plant") -> float:
    """Mass of all bodies."""
    return float(plant.model.body_mass.sum())


def weight_n(plant: "Plant") -> float:
    """What the plant weighs on Earth, also where its model has no gravity."""
    return GRAVITY_M_S2 * mass_kg(plant)


def _gravity_torque_nm(plant: "Plant", joint: str) -> float:
    """Weight beyond a hinge times its lever in the reference pose; a slide's weight."""
    import mujoco

    model, data = plant.model, _reference(plant)
    number = model.joint(joint).id
    body = int(model.jnt_bodyid[number])
    weight = GRAVITY_M_S2 * float(model.body_subtreemass[body])
    if model.jnt_type[number] == mujoco.mjtJoint.mjJNT_SLIDE:
        return weight
    arm = data.subtree_com[body] - data.xanchor[number]
    axis = data.xaxis[number]
    return weight * float(np.linalg.norm(arm - axis * (axis @ arm)))


def _reference(plant: "Plant") -> Any:
    """The plant at rest in its reference pose."""
    import mujoco

    data = mujoco.MjData(plant.model)
    mujoco.mj_forward(plant.model, data)
    return data

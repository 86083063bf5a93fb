"""Effects on joints: how they add up, and MuJoCo's torques against closed forms."""

import mujoco
import numpy as np
import pytest

from diagnosis.effects.library import effect
from diagnosis.effects.variants import Variants
from diagnosis.plant.plant import Plant
from diagnosis.plant.servo import Servo

MASS_KG, LENGTH_M, STIFFNESS, REST_RAD = 2.0, 0.3, 4.0, 0.2
PENDULUM = f"""
<mujoco><option timestep=".001"/><worldbody><body name="rod">
  <joint name="hinge" axis="0 1 0" stiffness="{STIFFNESS}" springref="11.459155902616"/>
  <geom size=".01" pos="0 0 -{LENGTH_M}" mass="{MASS_KG}"/></body></worldbody>
  <actuator><general name="hinge" joint="hinge"/></actuator></mujoco>"""
INERTIA = MASS_KG * LENGTH_M**2 + 0.4 * MASS_KG * 0.01**2


def pendulum(kp=20.0, limit=3.0, back_emf=0.5, xml=PENDULUM):
    values = (np.array([value]) for value in (kp, 0.0, limit, back_emf))
    return Plant("pendulum", mujoco.MjSpec.from_string(xml), ("hinge",), Servo(*values))


def changed(*effects, plant=None):
    """Variants of a pendulum: row 0 as it is, row 1 with effects (name, *values)."""
    plant = plant or pendulum()
    variants = Variants(plant, 2)
    for name, *values in effects:
        effect(name).apply(variants, 1, "hinge", np.array(values, float))
    return variants


def model_of(variants, row):
    """A compiled model with one row's fields in it."""
    model = variants.plant.spec.compile()
    for name, values in variants.fields.items():
        getattr(model, name)[...] = values[row].reshape(getattr(model, name).shape)
    mujoco.mj_setConst(model, mujoco.MjData(model))
    return model


def passive_torque(variants, row, angle_rad, speed_rad_s):
    model = model_of(variants, row)
    data = mujoco.MjData(model)
    data.qpos[0], data.qvel[0] = angle_rad, speed_rad_s
    mujoco.mj_forward(model, data)
    return data.qfrc_passive[0]


# How effects add up


@pytest.mark.parametrize(
    ("name", "first", "second", "field", "together"),
    [
        ("coulomb_friction", 0.1, 0.2, "coulomb_nm", 0.3),
        ("load_friction", 0.1, 0.2, "load_share", 0.3),
        ("backlash", 0.01, 0.03, "gap_rad", 0.04),
        ("encoder_offset", 0.1, -0.15, "offset_rad", -0.05),
        ("servo_gain", 0.8, 0.5, "kp_factor", 0.4),
        ("servo_damping", 2.0, 3.0, "damping_factor", 6.0),
        ("servo_fade", 0.01, 0.02, "fade_1_s", 0.03),
        ("torque_limit", 2.0, 1.0, "max_torque_nm", 1.0),
        ("speed_limit", 1.0, 2.0, "setpoint_speed_rad_s", 1.0),
    ],
)
def test_two_of_a_kind(name, first, second, field, together):
    joints = changed((name, first), (name, second)).joints
    assert getattr(joints, field)[1, 0] == pytest.approx(together)


def test_stribeck_and_coulomb_share_their_torque():
    joints = changed(
        ("coulomb_friction", 0.1), ("stribeck_friction", 0.2, 0.3, 0.05)
    ).joints
    assert joints.coulomb_nm[1, 0] == pytest.approx(0.3)
    assert joints.stribeck_nm[1, 0] == pytest.approx(0.3)
    assert joints.stribeck_speed_rad_s[1, 0] == pytest.approx(0.05)


def test_two_stribeck_speeds_average():
    first, second = (
        ("stribeck_friction", 0, 0.3, 0.1),
        ("stribeck_friction", 0, 0.1, 0.5),
    )
    joints = changed(first, second).joints
    assert joints.stribeck_nm[1, 0] == pytest.approx(0.4)
    assert joints.stribeck_speed_rad_s[1, 0] == pytest.approx(0.2)


def test_springs_in_a_row():
    springs = [(100.0, 0.5), (300.0, 2.0)]
    joints = changed(*(("joint_elasticity", *spring) for spring in springs)).joints
    # What both do at a low frequency s = i w, as complex stiffness
    w = 1e-3
    whole = 1 / sum(1 / (k + 1j * w * d) for k, d in springs)
    assert joints.spring_nm_rad[1, 0] == pytest.approx(whole.real)
    assert joints.spring_damping_nm_s_rad[1, 0] == pytest.approx(whole.imag / w)


def test_one_spring_is_itself():
    joints = changed(("joint_elasticity", 100.0, 0.5)).joints
    assert joints.spring_nm_rad[1, 0] == 100.0
    assert joints.spring_damping_nm_s_rad[1, 0] == 0.5
    assert joints.spring_nm_rad[0, 0] == np.inf


# What MuJoCo makes of them


def test_viscous_friction_brakes():
    variants = changed(("viscous_friction", 0.1), ("viscous_friction", 0.2))
    extra = passive_torque(variants, 1, 0.4, 3.0) - passive_torque(variants, 0, 0.4, 3)
    assert extra == pytest.approx(-0.3 * 3.0)


def test_armature_adds_to_the_inertia():
    variants = changed(("armature", 0.05), ("armature", 0.01))
    model = model_of(variants, 1)
    data = mujoco.MjData(model)
    data.qpos[0] = REST_RAD  # where the spring is silent
    mujoco.mj_forward(model, data)
    gravity = -MASS_KG * 9.81 * LENGTH_M * np.sin(REST_RAD)
    assert data.qacc[0] == pytest.approx(gravity / (INERTIA + 0.06), rel=1e-6)


@pytest.mark.parametrize("angle", [-0.7, 0.1, 0.9])
def test_two_springs_pull_as_one(angle):
    variants = changed(("joint_spring", 1.5, -0.4), ("joint_spring", 0.5, 1.0))
    torque = -STIFFNESS * (angle - REST_RAD) - 1.5 * (angle + 0.4) - 0.5 * (angle - 1.0)
    assert passive_torque(variants, 1, angle, 0.0) == pytest.approx(torque)
    assert passive_torque(variants, 0, angle, 0.0) == pytest.approx(
        -STIFFNESS * (angle - REST_RAD)
    )


def resting_angles(variants, start_rad):
    """Where each row comes to rest, driven by `mujoco.batch` as a replay does it."""
    from mujoco.batch import Batch

    batch = Batch(variants.plant.model, variants.n, nthread=1)
    for name, values in variants.fields.items():
        field = batch.expand(name)
        field[...] = values.reshape(field.shape)
    batch.set_const()
    batch.reset()
    angles = batch.bind("qpos")
    angles[:] = start_rad
    damping = batch.expand("dof_damping")
    damping[:] = 1.0
    batch.step(nstep=4000)
    return angles[:, 0]


@pytest.mark.parametrize(("side", "stop"), [(1, -0.1), (-1, 0.5)])
def test_an_end_stop_holds_in_its_row_only(side, stop):
    # Between spring and gravity the free pendulum rests near 0.08.
    variants = changed(("end_stop", stop, side))
    free, held = resting_angles(variants, stop - 0.1 * side)
    assert 0.05 < free < 0.12
    assert held == pytest.approx(stop, abs=2e-3)


def test_the_nearer_stop_counts():
    first, second, lower = (0.6, 1), (0.4, 1), (-0.3, -1)
    variants = changed(*(("end_stop", *one) for one in (first, second, lower)))
    assert variants.fields["jnt_range"][1, 0].tolist() == [-0.3, 0.4]
    variants = changed(*(("end_stop", *one) for one in (second, first)))
    assert variants.fields["jnt_range"][1, 0, 1] == 0.4


def test_a_stop_outside_of_the_range_is_none():
    limited = PENDULUM.replace('axis="0 1 0"', 'axis="0 1 0" range="-20 20"')
    variants = changed(("end_stop", 0.4, 1), plant=pendulum(xml=limited))
    for values in variants.fields.values():
        assert (values[1] == values[0]).all()


def test_a_stop_is_stiff():
    soft = PENDULUM.replace('axis="0 1 0"', 'axis="0 1 0" solreflimit=".2 1"')
    variants = changed(("end_stop", -0.1, 1), plant=pendulum(xml=soft))
    _, held = resting_angles(variants, -0.2)
    assert held == pytest.approx(-0.1, abs=2e-3)


# Sizes that fit the joint


@pytest.mark.parametrize(
    ("servo", "torque"),
    [
        ({"limit": 3.0}, 3.0),
        ({"limit": np.inf}, 0.1 * 20.0),
        ({"limit": np.inf, "kp": 0.0}, MASS_KG * 9.81 * LENGTH_M),
    ],
)
def test_torques_are_measured_by_what_the_joint_can(servo, torque):
    (friction,) = effect("coulomb_friction").parameters(pendulum(**servo), "hinge")
    assert friction.high == pytest.approx(0.5 * torque)
    assert 0.01 * torque <= friction.typical <= 0.15 * torque


def test_gravity_cannot_turn_a_vertical_axis():
    upright = pendulum(limit=np.inf, kp=0.0, xml=PENDULUM.replace("0 1 0", "0 0 1"))
    (friction,) = effect("coulomb_friction").parameters(upright, "hinge")
    assert friction.high > 0


def test_a_slide_carries_its_weight():
    slide = PENDULUM.replace('name="hinge" axis', 'name="hinge" type="slide" axis', 1)
    plant = pendulum(limit=np.inf, kp=0.0, xml=slide)
    (friction,) = effect("coulomb_friction").parameters(plant, "hinge")
    assert friction.high == pytest.approx(0.5 * 9.81 * MASS_KG)


def test_inertias_are_measured_by_the_joint_s_own():
    (inertia,) = effect("armature").parameters(pendulum(), "hinge")
    assert inertia.typical == pytest.approx(0.5 * INERTIA)


def test_speeds_are_measured_by_the_motor_s():
    (speed,) = effect("speed_limit").parameters(pendulum(), "hinge")
    assert speed.typical == pytest.approx(0.4 * 3.0 / 0.5)
    (speed,) = effect("speed_limit").parameters(pendulum(back_emf=0.0), "hinge")
    assert speed.typical == pytest.approx(0.4 * 5.0)

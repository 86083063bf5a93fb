"""Limbs of example-robot-data as robots with servos."""

import numpy as np
import pytest

from groundwalk.errors import UnknownNameError
from worlds.hidden.limbs import LIMBS, limb_plant


@pytest.fixture(scope="module")
def plants():
    return {name: limb_plant(name) for name in ("so101", *LIMBS)}


def test_there_are_arms_and_legs_of_at_least_eight_robots(plants):
    assert len(plants) >= 8
    for name, plant in plants.items():
        assert 2 <= len(plant.joints) <= 7, name
        assert not plant.floating
        for values in (plant.kp_nm_rad, plant.kd_nm_s_rad, plant.max_torque_nm):
            assert np.isfinite(values).all()
            assert (values > 0).all()
        low, high = plant.range_rad.T
        assert (high - low > 1.0).all(), name


def test_ranges_and_torques_are_those_of_the_file(plants):
    leg = plants["a1_leg"]
    assert leg.joints == ("FR_hip_joint", "FR_thigh_joint", "FR_calf_joint")
    assert leg.range_rad[1] == pytest.approx([-1.0471975512, 4.1887902048])
    assert leg.max_torque_nm == pytest.approx([33.5] * 3)
    panda = plants["panda"]
    assert panda.max_torque_nm == pytest.approx([87.0] * 4 + [12.0] * 3)
    assert panda.speed_rad_s == pytest.approx([2.175] * 4 + [2.61] * 3)


def test_a_servo_holds_its_joint_at_its_own_frequency_and_does_not_sag(plants):
    import mujoco

    for name in LIMBS:
        plant = plants[name]
        model = plant.make_spec().compile()
        data, mass = mujoco.MjData(model), np.zeros((model.nv, model.nv))
        data.qpos[:] = plant.range_rad.mean(axis=1)
        mujoco.mj_forward(model, data)
        mujoco.mj_fullM(model, data, mass)
        frequency = np.sqrt(plant.kp_nm_rad / np.diag(mass))
        assert (frequency > 20).all(), name
        assert (frequency < 120).all(), name
        sag = np.abs(data.qfrc_bias) / plant.kp_nm_rad
        assert (sag <= 0.08 + 1e-9).all(), name
        assert (np.abs(data.qfrc_bias) < 0.8 * plant.max_torque_nm).all(), name


def test_gear_teeth_are_far_stiffer_than_the_servo(plants):
    for plant in plants.values():
        for joint, kp in enumerate(plant.kp_nm_rad):
            assert plant.rigid_nm_rad(joint) >= max(3000.0, 150 * kp)


def test_bodies_can_be_heavier_and_lighter(plants):
    leg = plants["a1_leg"]
    own = leg.make_spec().compile()
    other = leg.with_masses({"FR_calf": 0.1, "FR_hip": -0.05}).make_spec().compile()
    change = other.body_mass - own.body_mass
    assert change[own.body("FR_calf").id] == pytest.approx(0.1)
    assert change[own.body("FR_hip").id] == pytest.approx(-0.05)
    assert change[own.body("FR_thigh").id] == 0.0
    assert other.body_inertia == pytest.approx(own.body_inertia)


def test_an_unknown_limb_is_told():
    with pytest.raises(UnknownNameError, match="a1_leg"):
        limb_plant("a1_lag")

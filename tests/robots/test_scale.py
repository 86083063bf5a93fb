"""A robot's size, and the servos that follow from it."""

import mujoco
import numpy as np
import pytest

from groundwalk.errors import BadValueError
from robots.engine_models.mjcf import mujoco_spec
from robots.from_urdf.adapter import FREE, IN_STANCE, servo
from robots.scale import NAO_CENTRE_M, NAO_HIP_M, NAO_KG, NAO_SIZE, Scale


def test_the_nao_is_its_own_size(nao, model):
    """With arms that hang, as the constants say."""
    data = mujoco.MjData(model)
    data.qpos[:7] = [0, 0, 0, 1, 0, 0, 0]
    for side in "LR":
        data.joint(f"{side}ShoulderPitch").qpos = np.pi / 2
    mujoco.mj_forward(model, data)
    sole_m = data.body("LFoot").xpos[2] + nao.feet[0].sole_height_m
    assert data.subtree_com[1][2] - sole_m == pytest.approx(NAO_CENTRE_M, abs=1e-3)
    assert nao.mass_kg == pytest.approx(NAO_KG, abs=1e-3)
    assert -0.085 - sole_m == pytest.approx(NAO_HIP_M, abs=1e-4)
    assert nao.scale == NAO_SIZE


def test_units_of_a_robot_four_times_as_high():
    scale = Scale.of_robot(4 * NAO_HIP_M, 4 * NAO_CENTRE_M, 64 * NAO_KG)
    factors = {"m": 4, "s": 2, "m/s": 2, "rad/s": 0.5, "rad/m": 0.25, "N": 64}
    for unit, factor in (factors | dict.fromkeys(("1", "m/m", "rad"), 1)).items():
        assert scale.of(unit) == pytest.approx(factor)
        assert NAO_SIZE.of(unit) == 1.0


@pytest.mark.parametrize("wrong", [0.0, -1.0, float("nan")])
def test_sizes_that_no_robot_has(wrong):
    with pytest.raises(BadValueError, match="scale time"):
        Scale(time=wrong)


def test_a_servo_in_the_stance():
    """10 kg at 0.981 m: the pendulum's frequency is sqrt(10) rad/s, m h^2 9.62."""
    motor = servo(100.0, 20.0, 10.0, 0.981, None)
    inertia, w = 10 * 0.981**2, IN_STANCE[0] * np.sqrt(10)
    assert motor.kp_nm_rad == pytest.approx(inertia * (w**2 + 10))
    assert motor.kd_nm_s_rad == pytest.approx(2 * IN_STANCE[1] * inertia * w)


def test_a_free_servo_and_its_back_emf():
    """A light load: the back-EMF of 2 N m s/rad damps more than the rule asks."""
    motor = servo(10.0, 5.0, 10.0, 0.981, 0.01)
    w = FREE[0] * np.sqrt(10)
    assert motor.kp_nm_rad == pytest.approx(0.01 * w**2)
    assert motor.kd_nm_s_rad == 2.0


def test_the_nao_stands_as_firmly_as_the_rule_says(nao):
    """Its pitch and roll joints have 59.9 and 92.1 N m/rad; the rule is in between."""
    motor = servo(7.8, 6.4, NAO_KG, NAO_CENTRE_M, None)
    gains = {joint.motor.kp_nm_rad for joint in nao.links[1:6]}
    assert min(gains) < motor.kp_nm_rad < max(gains)


def test_a_motor_needs_torque_and_speed():
    for effort, speed in ((0.0, 1.0), (1.0, 0.0)):
        with pytest.raises(BadValueError, match="must be positive"):
            servo(effort, speed, 1.0, 1.0, None)


def test_models_of_an_adapted_robot_compile():
    import robots

    model = mujoco_spec(robots.get("icub")).compile()
    assert model.nu == len(robots.get("icub").joints)
    assert model.body_mass.sum() == pytest.approx(28.347, abs=1e-3)

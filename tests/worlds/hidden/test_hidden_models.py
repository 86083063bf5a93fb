"""The nominal robots, and that both engines are given the same bodies."""

import mujoco
import numpy as np
import pytest

import robots
from groundwalk.errors import BadValueError, UnknownNameError
from robots.engine_models.urdf import model_urdf
from worlds.hidden.effects import Hidden, surroundings
from worlds.hidden.mujoco_engine import hidden_model
from worlds.hidden.plant import SO101_ROTOR_KG_M2, hidden_plant
from worlds.hidden.run import Clock, run_hidden

NOBODY = np.random.SeedSequence(0)


def bias(model, pose, speed):
    data = mujoco.MjData(model)
    data.qpos[:], data.qvel[:] = pose, speed
    mujoco.mj_forward(model, data)
    return data.qfrc_bias.copy()


@pytest.mark.parametrize("name", ["pendulum", "so101", "nao"])
def test_a_model_and_its_urdf_need_the_same_torques(name):
    plant = hidden_plant(name)
    model = plant.make_spec().compile()
    again = mujoco.MjModel.from_xml_string(model_urdf(model, name))
    rng = np.random.default_rng(1)
    pose, speed = rng.uniform(-0.4, 0.4, (2, len(plant.joints)))
    assert np.allclose(bias(model, pose, speed), bias(again, pose, speed), atol=1e-9)
    assert [again.joint(i).name for i in range(again.njnt)] == list(plant.joints)


def test_the_arm_has_five_joints_and_weighs_what_its_links_do():
    plant = hidden_plant("so101")
    model = plant.make_spec().compile()
    assert len(plant.joints) == 5
    assert "gripper" not in plant.joints
    assert model.body_mass.sum() == pytest.approx(0.485, abs=0.001)
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    mass = np.zeros((5, 5))
    mujoco.mj_fullM(model, data, mass)
    assert mass[4, 4] > SO101_ROTOR_KG_M2


def test_the_robot_s_servos_are_those_of_its_description():
    plant, motor = hidden_plant("nao"), robots.get("nao").links[3].motor
    gains = plant.servo["LKneePitch"]
    assert (gains.kp, gains.kd) == (motor.kp_nm_rad, motor.kd_nm_s_rad)
    assert gains.max_torque == motor.stall_torque_nm


def test_unknown_robots_and_floating_arms_are_refused():
    with pytest.raises(UnknownNameError, match="nao"):
        hidden_plant("nao2")
    with pytest.raises(BadValueError, match="fixed base"):
        hidden_plant("so101", floating=True)


def test_both_engines_move_the_arm_alike():
    plant = hidden_plant("so101")
    time_s = np.arange(60) * 0.01
    table = 0.3 * np.sin(6 * time_s)[:, None] * np.array([1, -1, 1, -1, 1])
    clock = Clock(0.00025, np.arange(60) * 40, 0)
    payload = Hidden("payload_mass", "gripper_link", {"mass": 0.1})
    heavy, light = (
        [
            run_hidden(
                plant, hidden, engine, clock, lambda k, s: table[k], table[0], NOBODY
            )
            for engine in ("mujoco", "bullet")
        ]
        for hidden in ([payload], [])
    )
    for one, other in (heavy, light):
        assert np.abs(one.position_rad - other.position_rad).max() < 1e-6
    assert np.abs(heavy[0].position_rad - light[0].position_rad).max() > 0.01


def test_a_tilted_mount_turns_gravity():
    nose_down = [Hidden("ground_slope", "world", {"pitch": 0.1, "roll": 0.0})]
    pull = surroundings(nose_down).gravity_m_s2()
    assert pull == pytest.approx([9.81 * np.sin(0.1), 0, -9.81 * np.cos(0.1)])
    left_up = [Hidden("ground_slope", "world", {"pitch": 0.0, "roll": 0.1})]
    assert surroundings(left_up).gravity_m_s2()[1] == pytest.approx(-9.81 * np.sin(0.1))
    assert np.array_equal(surroundings([]).tilt(), np.eye(3))


def test_bumps_begin_at_once_and_are_as_high_as_said():
    bumps = [Hidden("uneven_ground", "world", {"height": 0.005})]
    heights = surroundings(bumps).ground(NOBODY).heights_m
    assert np.quantile(np.abs(heights), 0.99) == pytest.approx(0.005, rel=0.15)
    assert surroundings([]).ground(NOBODY).is_flat


def test_an_effect_changes_the_soles_only_if_it_is_there():
    plant = hidden_plant("nao", floating=True)
    ground = surroundings([]).ground(NOBODY)
    ice = [Hidden("contact_friction", "feet", {"coefficient": 0.3})]
    for effects, friction in ((ice, 0.3), ([], 0.8)):
        model = hidden_model(plant, effects, 0.0005, ground)
        soles = model.geom_contype == 1
        assert (model.geom_friction[soles, 0] == friction).all()

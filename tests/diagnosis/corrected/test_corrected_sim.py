"""The corrected sim: against replays, against the sim as it is, and closed forms."""

import numpy as np
import pytest
from corrected_rig import CROUCH, NAO, model_of, roll, sim, swing
from joint_rigs import ticks, trace_of
from scipy.spatial.transform import Rotation

import terrain
from diagnosis.corrected.sim import sim_plant
from diagnosis.plant.load import load_plant
from diagnosis.replay.replay import replay
from diagnosis.residuals.replays import variants_of
from diagnosis.traces.windows import Run
from groundwalk.errors import BadModelError
from worlds import SensorNoise, WorldOptions

SHOULDER = NAO.joints.index("LShoulderPitch")
REACHING = np.where(np.arange(len(CROUCH)) == SHOULDER, 0.3, CROUCH)
G = 9.81


@pytest.fixture(scope="module")
def flat():
    return terrain.make("flat", seed=0)


@pytest.fixture(scope="module")
def lumpy():
    return [
        terrain.make("lumps", seed, x_range_m=(-0.6, 1.0), y_range_m=(-0.6, 0.6))
        for seed in (1, 2, 3)
    ]


# Nothing missing


def test_without_effects_it_is_the_sim_to_the_bit(lumpy):
    grounds = [*lumpy[:2], lumpy[0]]
    plain = roll(sim(grounds, nominal=True, noise=SensorNoise()), swing(0.3))
    same = roll(sim(grounds, noise=SensorNoise()), swing(0.3))
    for name, values in plain.items():
        np.testing.assert_array_equal(values, same[name], err_msg=name)


@pytest.mark.parametrize("where", ["flat", "lumps", "air"])
def test_an_effect_of_no_size_changes_nothing(lumpy, flat, where):
    """Also with other actuators, and one model for all grounds."""
    grounds = lumpy if where == "lumps" else [flat] * 2
    fixed = where == "air"
    plain = roll(sim(grounds, nominal=True, fixed=fixed), swing(0.4))
    same = roll(
        sim(grounds, ("servo_gain", "LKneePitch", 1.0), fixed=fixed), swing(0.4)
    )
    for name, values in plain.items():
        np.testing.assert_allclose(values, same[name], atol=1e-8, err_msg=name)


# Against replays of the same model


IN_THE_AIR = [
    [("servo_gain", "LKneePitch", 0.5), ("servo_damping", "LHipPitch", 0.5)],
    [("torque_limit", "LShoulderPitch", 0.3), ("speed_limit", "RKneePitch", 0.8)],
    [("backlash", "LKneePitch", 0.05), ("servo_fade", "RShoulderPitch", 0.05)],
    [("encoder_offset", "LKneePitch", 0.1), ("sensor_delay", "encoders", 0.0133)],
    [("command_latency", "commands", 0.0133)],
    [("late_reading", "LKneePitch", 0.0133), ("sensor_delay", "encoders", 0.005)],
    [("presliding", "LElbowRoll", 0.2, 0.03), ("presliding", "LKneePitch", 0.5, 0.01)],
    [("integral_term", "LKneePitch", 0.5), ("dead_band", "LShoulderPitch", 0.02)],
    [("stribeck_friction", "LElbowRoll", 0.1, 0.2, 0.1)],
    [("load_friction", "LShoulderPitch", 0.4), ("coulomb_friction", "RHipPitch", 0.5)],
    [("joint_elasticity", "LKneePitch", 40.0, 0.1), ("armature", "LKneePitch", 0.02)],
    [("external_force", "LTibia", 3.0, 0.0, 5.0, 0.503, 0.3)],
    [("drag", "RForeArm", 5.0), ("payload_mass", "LForeArm", 0.2)],
    [("ground_slope", "world", 0.2, 0.1), ("end_stop", "RElbowRoll", 0.1, -1.0)],
]


@pytest.mark.parametrize("effects", IN_THE_AIR, ids=lambda one: one[0][0])
def test_in_the_air_it_does_what_a_replay_does(flat, effects):
    commands = swing(2.0)
    plant = load_plant("nao", "fixed")
    found = roll(sim([flat] * 2, *effects, fixed=True), commands)["position_rad"]
    trace = trace_of(plant, ticks(2.0), command_rad=commands)
    run = Run(trace, found[0, 0], np.zeros(len(plant.joints)))
    variants = variants_of(plant, [model_of(*effects), ()])
    corrected, nominal = replay([run], variants)[0].position_rad
    np.testing.assert_allclose(found[:, 0], corrected, rtol=0, atol=1e-4)
    np.testing.assert_array_equal(found[:, 0], found[:, 1])
    assert np.abs(found[:, 0] - nominal).max() > 2e-3


def test_on_the_ground_it_does_what_a_replay_does(flat):
    effects = [
        ("contact_friction", "feet", 0.3),
        ("payload_mass", "torso", 0.5),
        ("contact_compliance", "feet", 8000.0),
        ("backlash", "LKneePitch", 0.03),
    ]
    commands = swing(0.5)
    plant = load_plant("nao", "floating")
    world = sim([flat], *effects)
    world.reset(commands[:1])
    start = world.truth()
    place = [start.base_position_m[0], start.base_orientation[0], np.zeros(6)]
    found = roll(world, commands)["position_rad"][:, 0]
    trace = trace_of(plant, ticks(0.5), command_rad=commands)
    run = Run(trace, commands[0], np.zeros(len(plant.joints)), np.concatenate(place))
    variants = variants_of(plant, [model_of(*effects), ()])
    corrected, nominal = replay([run], variants)[0].position_rad
    np.testing.assert_allclose(found, corrected, rtol=0, atol=1e-6)
    assert np.abs(found - nominal).max() > 1e-3


# Closed forms


def rest(*effects, pose_rad=REACHING):
    """(j,) where the joints hang in the air at last."""
    ground = terrain.make("flat", seed=0)
    commands = np.tile(pose_rad, (200, 1))
    return roll(sim([ground], *effects, fixed=True), commands)["position_rad"][-1, 0]


def test_half_the_gain_sags_twice_as_far():
    """Kp f (command - q) holds the same weight, but for its lever's change."""
    once = REACHING[SHOULDER] - rest()[SHOULDER]
    twice = REACHING[SHOULDER] - rest(("servo_gain", "LShoulderPitch", 0.5))[SHOULDER]
    assert abs(once) > 1e-3
    assert twice == pytest.approx(2 * once, rel=0.02)


def test_a_payload_sags_by_its_weight():
    """Kp (sag) = m g times the lever of the forearm's centre of mass."""
    import mujoco

    mass_kg = 0.1
    plant = sim_plant(NAO, WorldOptions(fixed_base=True))
    plain, laden = rest(), rest(("payload_mass", "LForeArm", mass_kg))
    data = mujoco.MjData(plant.model)
    data.qpos[plant.qpos] = laden
    mujoco.mj_forward(plant.model, data)
    jacobian = np.zeros((3, plant.model.nv))
    body = plant.model.body("LForeArm").id
    mujoco.mj_jacBodyCom(plant.model, data, jacobian, None, body)
    lever_m = jacobian[2, plant.dofs[SHOULDER]]
    sag_rad = -mass_kg * G * lever_m / plant.servo.kp_nm_rad[SHOULDER]
    assert abs(sag_rad) > 1e-3
    found = laden[SHOULDER] - plain[SHOULDER]
    assert found == pytest.approx(sag_rad, rel=0.02)


def test_latency_is_that_of_the_worlds_own_delay_line(flat):
    commands = swing(0.6)
    own = roll(sim([flat], nominal=True, latency_s=0.036), commands)
    late = roll(sim([flat], ("command_latency", "commands", 0.036)), commands)
    both = ("command_latency", "commands", 0.016)
    sum_of_both = roll(sim([flat], both, latency_s=0.02), commands)
    for other in (late, sum_of_both):
        np.testing.assert_allclose(
            other["position_rad"], own["position_rad"], rtol=0, atol=1e-8
        )
    prompt = roll(sim([flat], nominal=True), commands)
    assert np.abs(prompt["position_rad"] - own["position_rad"]).max() > 0.01


def test_no_command_is_known_before_it_is_given(flat):
    commands = swing(0.3)
    early = roll(sim([flat], ("command_latency", "commands", -1e-5)), commands)
    prompt = roll(sim([flat], nominal=True), commands)
    np.testing.assert_allclose(
        early["position_rad"], prompt["position_rad"], rtol=0, atol=1e-8
    )


def test_encoders_show_the_past_and_the_gyroscope_its_bias(flat):
    effects = [("sensor_delay", "encoders", 0.02), ("gyro_bias", "gyroscope", 1, 2, -3)]
    plain = roll(sim([flat], nominal=True), swing(0.5))
    seen = roll(sim([flat], *effects), swing(0.5))
    for name in ("position_rad", "velocity_rad_s"):
        np.testing.assert_allclose(seen[name][2:], plain[name][:-2], atol=1e-8)
        np.testing.assert_array_equal(seen[name][:3], seen[name][:1].repeat(3, 0))
    bias = seen["gyroscope_rad_s"] - plain["gyroscope_rad_s"]
    np.testing.assert_allclose(bias, np.broadcast_to([1, 2, -3], bias.shape), atol=1e-8)
    np.testing.assert_allclose(seen["base"], plain["base"], atol=1e-8)


def test_on_a_slope_gravity_pulls_ahead_and_the_feet_stay(flat):
    """A ground that falls towards +x: its normal leans back against gravity."""
    pitch, commands = 0.05, np.tile(CROUCH, (300, 1))
    world = sim([flat], ("ground_slope", "world", pitch, 0.0))
    found = roll(world, commands)
    turn = Rotation.from_quat(world.truth().base_orientation[0], scalar_first=True)
    felt = turn.apply(found["accelerometer_m_s2"][-1, 0])
    wanted = [-G * np.sin(pitch), 0, G * np.cos(pitch)]
    np.testing.assert_allclose(felt, wanted, atol=0.02)
    assert world.ended == [""]
    level = roll(sim([flat], nominal=True), commands)
    np.testing.assert_allclose(found["base"][0], level["base"][0], atol=0.01)


# Rollouts


def test_a_second_rollout_is_the_first_again(flat):
    world = sim(
        [flat],
        ("joint_elasticity", "LKneePitch", 40.0, 0.1),
        ("speed_limit", "RKneePitch", 0.3),
        ("servo_fade", "LHipPitch", 0.05),
        ("external_force", "torso", 5.0, 0.0, 0.0, 0.1, 0.3),
        ("drag", "LForeArm", 3.0),
        ("backlash", "LAnkleRoll", 0.05),
        ("sensor_delay", "encoders", 0.0133),
    )
    first, second = roll(world, swing(0.3)), roll(world, swing(0.3))
    for name, values in first.items():
        np.testing.assert_array_equal(values, second[name], err_msg=name)


def test_what_blows_up_ends_and_the_others_go_on(flat):
    world = sim([flat] * 2, ("backlash", "LKneePitch", 0.05))
    commands = np.tile(CROUCH, (2, 1))
    world.reset(commands)
    commands[0, 3] = np.nan
    for _ in range(3):
        observation = world.step(commands)
    assert world.ended == ["diverged", ""]
    assert np.isfinite(observation.position_rad).all()
    np.testing.assert_allclose(observation.time_s, [0, 0.03])


def test_bumps_that_nobody_knows_are_refused(flat):
    with pytest.raises(BadModelError, match="give the sim a terrain with bumps"):
        sim([flat], ("uneven_ground", "world", 0.01))

"""The corrected model, loaded by nothing but MuJoCo, against replays."""

from dataclasses import replace

import mujoco
import numpy as np
import pytest
from joint_rigs import run_from, smooth_command, ticks, trace_of

from diagnosis.corrected.mjcf import corrected_mjcf
from diagnosis.effects.parts import PlacedEffect
from diagnosis.plant.load import load_plant
from diagnosis.plant.servo import Servo
from diagnosis.replay.replay import replay
from diagnosis.residuals.replays import variants_of
from diagnosis.traces.windows import Run

STEPS_PER_TICK = 5
ABOVE_GROUND = np.array([0, 0, 0.33, 1, 0, 0, 0, *[0.0] * 6])


def everywhere(plant, joint, body):
    """Every native effect that acts without a ground, but no latency."""
    effects = [
        ("servo_gain", joint, 0.7),
        ("servo_damping", joint, 1.3),
        ("coulomb_friction", joint, 0.123),
        ("viscous_friction", joint, 1 / 3),
        ("armature", joint, 0.0123),
        ("torque_limit", joint, 0.8),
        ("payload_mass", body, 0.2),
        ("com_offset", body, 0.01, 0.02, 1 / 300),
        ("link_inertia", body, 2.5),
        ("joint_spring", joint, 0.3, 0.1),
        ("end_stop", joint, 0.3, 1.0),
        ("ground_slope", "world", 0.1, 0.05),
        ("encoder_offset", joint, 0.07),
        ("torque_offset", joint, -0.2),
    ]
    if plant.base == "floating":
        effects += [
            ("contact_friction", "feet", 0.5),
            ("contact_compliance", "feet", 20000 / 3),
        ]
    return effects


def commanded_run(plant, servo=None):
    time_s = ticks(1.0)
    command = np.repeat(smooth_command(time_s), len(plant.joints))
    trace = trace_of(plant, time_s, command_rad=command)
    trace = replace(trace, servo=servo or plant.servo)
    base = ABOVE_GROUND if plant.base == "floating" else None
    start = run_from(trace)
    return Run(trace, start.position_rad, start.velocity_rad_s, base)


def simulated(text, plant, run):
    """Positions (T, j) as MuJoCo alone has them."""
    model = mujoco.MjModel.from_xml_string(text)
    assert model.opt.timestep == plant.model.opt.timestep
    data = mujoco.MjData(model)
    if run.base is not None:
        data.qpos[:7] = run.base[:7]
    columns = [model.joint(name).qposadr[0] for name in plant.joints]
    data.qpos[columns] = run.position_rad
    actuators = [model.actuator(name).id for name in plant.joints]
    positions = [data.qpos[columns].copy()]
    for command in run.trace.command_rad[:-1]:
        data.ctrl[actuators] = command
        mujoco.mj_step(model, data, STEPS_PER_TICK)
        positions.append(data.qpos[columns].copy())
    return np.array(positions)


def check_same(plant, effects, servo=None, atol=1e-9):
    model = tuple(PlacedEffect(name, place, values) for name, place, *values in effects)
    run = commanded_run(plant, servo)
    found = simulated(corrected_mjcf(plant, model, servo), plant, run)
    corrected, nominal = replay([run], variants_of(plant, [model, ()]))[0].position_rad
    np.testing.assert_allclose(found, corrected, rtol=0, atol=atol)
    assert np.abs(found - nominal).max() > 1e-3


@pytest.mark.parametrize("base", ["fixed", "floating"])
def test_a_described_robot(base):
    plant = load_plant("nao", base)
    check_same(plant, everywhere(plant, "LKneePitch", "LTibia"))


def test_a_urdf_with_the_recordings_servos():
    plant = load_plant("so101", "fixed")
    full = np.full(len(plant.joints), 1.0)
    servo = Servo(17 * full, 0.6 * full, 2.9 * full, 0 * full)
    # in the step in which a servo leaves its limit MuJoCo has it there to the end
    effects = everywhere(plant, "elbow_flex", plant.bodies[2])
    check_same(plant, effects, servo, atol=5e-4)


@pytest.mark.parametrize("delay_s", [0.02, 0.0133])
def test_late_commands(delay_s):
    """Before the first command is due both ask for 0."""
    plant = load_plant("nao", "fixed")
    check_same(plant, [("command_latency", "commands", delay_s)])


@pytest.mark.parametrize("joint", ["LKneePitch", "RShoulderRoll"])
def test_an_encoders_zero_alone(joint):
    """The robot stands where it stood; its angles are called otherwise."""
    plant = load_plant("nao", "fixed")
    check_same(plant, [("encoder_offset", joint, 0.1)])
    text = corrected_mjcf(plant, (PlacedEffect("encoder_offset", joint, (0.1,)),))
    model = mujoco.MjModel.from_xml_string(text)
    low, high = model.joint(joint).range - plant.model.joint(joint).range
    assert (low, high) == pytest.approx((0.1, 0.1))
    poses = [mujoco.MjData(one) for one in (model, plant.model)]
    for one, data in zip((model, plant.model), poses, strict=True):
        mujoco.mj_kinematics(one, data)
    np.testing.assert_allclose(poses[0].xpos, poses[1].xpos, atol=1e-12)
    assert poses[0].joint(joint).qpos[0] == pytest.approx(0.1)


def test_a_joint_without_a_range_gets_none_with_another_zero(tmp_path):
    path = tmp_path / "arm.xml"
    path.write_text(OWN)
    plant = load_plant(path, "fixed")
    off = PlacedEffect("encoder_offset", "elbow", (0.1,))
    model = mujoco.MjModel.from_xml_string(corrected_mjcf(plant, (off,)))
    assert not model.jnt_limited.any()
    assert model.qpos0 == pytest.approx([0, 0.1])


def test_a_constant_torque_is_beside_the_servos_limit():
    """With a limit that both reach; the servo alone could not hold the joint."""
    plant = load_plant("nao", "fixed")
    effects = [
        ("torque_limit", "LShoulderPitch", 0.4),
        ("torque_offset", "LShoulderPitch", 0.3),
    ]
    # in the step in which a servo leaves its limit MuJoCo has it there to the end
    check_same(plant, effects, atol=2e-4)
    model = tuple(PlacedEffect(name, place, tuple(v)) for name, place, *v in effects)
    servo = mujoco.MjModel.from_xml_string(corrected_mjcf(plant, model))
    assert servo.actuator("LShoulderPitch").forcerange == pytest.approx((-0.1, 0.7))


def read_late(plant, delay_s):
    """(steps, j, 2) readings of corrected.xml's sensors, and what a replay shows."""
    late = PlacedEffect("sensor_delay", "encoders", (delay_s,))
    run = commanded_run(plant)
    model = mujoco.MjModel.from_xml_string(corrected_mjcf(plant, (late,)))
    data = mujoco.MjData(model)
    actuators = [model.actuator(name).id for name in plant.joints]
    found = []
    for command in run.trace.command_rad:
        mujoco.mj_forward(model, data)  # sensors show what was when it began
        late_ones = data.sensordata[-2 * len(plant.joints) :]  # behind its own
        found.append(late_ones.reshape(-1, 2).copy())
        data.ctrl[actuators] = command
        mujoco.mj_step(model, data, STEPS_PER_TICK)
    one = replay([run], variants_of(plant, [(late,), ()]))[0]
    return np.array(found), np.stack([one.position_rad, one.velocity_rad_s], axis=-1)


@pytest.mark.parametrize(("delay_s", "atol"), [(0.02, 1e-9), (0.0133, 4e-5)])
def test_late_encoders_are_sensors(delay_s, atol):
    """Between steps MuJoCo takes another cubic than replays do."""
    found, (late, prompt) = read_late(load_plant("nao", "fixed"), delay_s)
    np.testing.assert_allclose(found[..., 0], late[..., 0], rtol=0, atol=atol)
    np.testing.assert_allclose(found[..., 1], late[..., 1], rtol=0, atol=1e-4)
    assert np.abs(found - prompt)[..., 0].max() > 0.01


def test_encoders_late_by_less_than_half_a_step_have_no_sensors():
    plant = load_plant("nao", "fixed")
    late = PlacedEffect("sensor_delay", "encoders", (9e-4,))
    model = mujoco.MjModel.from_xml_string(corrected_mjcf(plant, (late,)))
    assert model.nsensor == plant.model.nsensor


@pytest.mark.parametrize("delay_s", [-5e-4, 3e-4])
def test_what_is_nearer_to_no_delay_than_to_a_step_is_none(delay_s):
    """A clock may seem to run ahead; MuJoCo would not move with a negative delay."""
    plant = load_plant("nao", "fixed")
    late = PlacedEffect("command_latency", "commands", (delay_s,))
    model = mujoco.MjModel.from_xml_string(corrected_mjcf(plant, (late,)))
    assert not model.actuator_delay.any()


def test_what_mujoco_lacks_is_left_out():
    plant = load_plant("nao", "fixed")
    play = PlacedEffect("backlash", "LKneePitch", (0.03,))
    text, without = corrected_mjcf(plant, (play,)), corrected_mjcf(plant, ())
    assert "MuJoCo lacks them: backlash@LKneePitch" in text
    assert text.partition("-->")[2] == without.partition("-->")[2]


def test_of_friction_with_a_peak_the_rest_is_there():
    plant = load_plant("nao", "fixed")
    values = (0.1, 0.2, 0.05)
    stribeck = PlacedEffect("stribeck_friction", "LKneePitch", values)
    model = mujoco.MjModel.from_xml_string(corrected_mjcf(plant, (stribeck,)))
    knee = model.joint("LKneePitch").dofadr[0]
    assert model.dof_frictionloss[knee] == pytest.approx(0.1)
    assert model.dof_frictionloss.sum() == pytest.approx(0.1)


OWN = """<mujoco model="own">
  <option timestep="0.0007" integrator="RK4" iterations="33"/>
  <worldbody><body name="upper"><joint name="shoulder" axis="0 1 0" frictionloss="0.1"
  solreffriction="0.03 1.1" solimpfriction="0.8 0.85 0.002 0.4 3"/>
  <geom size="0.05" pos="0 0 -0.2"/><body name="lower" pos="0 0 -0.4">
  <joint name="elbow" axis="0 1 0" frictionloss="0.2" solreffriction="0.04 1.2"/>
  <geom size="0.05" pos="0 0 -0.2"/></body></body></worldbody><actuator>
  <position joint="shoulder" kp="20" kv="1"/><position joint="elbow" kp="10" kv="0.5"/>
  </actuator></mujoco>"""
"""A user's arm whose options are none of MuJoCo's defaults or of replays."""


@pytest.mark.parametrize("found", ["armature", "coulomb_friction"])
def test_the_users_own_options_stay(tmp_path, found):
    path = tmp_path / "arm.xml"
    path.write_text(OWN)
    plant = load_plant(path, "fixed")
    text = corrected_mjcf(plant, (PlacedEffect(found, "elbow", (0.05,)),))
    own, new = (mujoco.MjModel.from_xml_string(xml) for xml in (OWN, text))
    for option in ("timestep", "integrator", "disableflags", "iterations", "cone"):
        assert getattr(new.opt, option) == getattr(own.opt, option), option
    rubs = found == "coulomb_friction"
    changed = {"armature": (0.05, 0.2), "coulomb_friction": (0, 0.25)}[found]
    assert (new.dof_armature[1], new.dof_frictionloss[1]) == pytest.approx(changed)
    for name in ("dof_solref", "dof_solimp"):
        same = getattr(own, name) == getattr(new, name)
        assert same[0].all()
        assert same[1].all() == (not rubs)
    assert new.dof_frictionloss[0] == own.dof_frictionloss[0]
    np.testing.assert_array_equal(own.actuator_gainprm, new.actuator_gainprm)
    np.testing.assert_array_equal(own.actuator_forcelimited, new.actuator_forcelimited)
    comment = text.partition("<!--")[2].partition("-->")[0]
    assert f"In this file: {found}@elbow." in comment
    assert ("solreffriction" in comment) == rubs
    assert "time step of 0.002 s" in comment


def test_others_are_written_with_as_few_digits_as_ever():
    plant = load_plant("nao", "fixed")
    before = plant.spec.copy().to_xml()
    assert corrected_mjcf(plant, ()) != before
    assert plant.spec.copy().to_xml() == before


def test_meshes_are_found_from_anywhere(tmp_path, monkeypatch):
    corners = ("0 0 0", "1 0 0", "0 1 0", "0 0 1")
    faces = ("1 3 2", "1 2 4", "2 3 4", "3 1 4")
    lines = [f"v {c}" for c in corners] + [f"f {f}" for f in faces]
    (tmp_path / "parts").mkdir()
    (tmp_path / "parts" / "link.obj").write_text("\n".join(lines))
    path = tmp_path / "arm.xml"
    path.write_text("""<mujoco><compiler meshdir="parts"/>
      <asset><mesh name="link" file="link.obj"/></asset><worldbody><body>
      <joint name="hinge"/><geom type="mesh" mesh="link"/></body></worldbody>
      <actuator><position joint="hinge" kp="5"/></actuator></mujoco>""")
    plant = load_plant(path, "fixed")
    text = corrected_mjcf(plant, (PlacedEffect("armature", "hinge", (0.1,)),))
    monkeypatch.chdir("/")
    assert mujoco.MjModel.from_xml_string(text).dof_armature[0] == 0.1

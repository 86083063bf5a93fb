"""`corrected_laws.py`, stepped by MuJoCo alone, against replays of the same effects.

Largest differences found, in mrad, at steps of 1 ms: below 0.001 for each effect alone
and for combinations, but for encoders that are late by other than whole steps (0.02,
since MuJoCo interpolates by another cubic).
"""

import ast
import sys
from dataclasses import replace

import mujoco
import numpy as np
import pytest
from joint_rigs import plant_of, run_from, ticks, trace_of
from laws_rig import commanded, compared, model_of, module_of, stepped

from diagnosis.corrected.laws_file import covered_parts, laws_text
from diagnosis.corrected.mjcf import corrected_mjcf
from diagnosis.effects import all_effects, effect
from diagnosis.effects.parts import PlacedEffect
from diagnosis.plant.load import load_plant
from diagnosis.plant.servo import Servo
from diagnosis.replay.replay import replay
from diagnosis.residuals.replays import variants_of
from diagnosis.traces.windows import Run

KNEE, ARM = "LKneePitch", "LShoulderPitch"
SPRING = [("joint_elasticity", KNEE, 40.0, 0.1), ("armature", KNEE, 0.02)]
PLAY = ("backlash", KNEE, 0.03)
LATE = ("command_latency", "commands", 0.0133)
SAG = ("supply_sag", "supply", 0.6)
PEAK = 0.05, 0.05, 0.2, 1.3
ALONE = [
    ("stribeck_friction", KNEE, 0.1, 0.2, 0.1),
    ("load_friction", ARM, 0.4),
    ("shaped_stribeck_friction", KNEE, 0.1, 0.2, 0.1, 1.3),
    ("angle_friction", KNEE, 0.2, 3.0),
    ("gear_friction", ARM, 0.05, 0.2),
    ("gear_stribeck_friction", ARM, *PEAK, 0.1, 0.2),
    ("directional_gear_friction", ARM, *PEAK, 0.05, 0.2, 0.1, 0.3),
    ("quadratic_gear_friction", ARM, *PEAK, 0.05, 0.2, 0.1, 0.3, 0.5),
    PLAY,
    ("joint_elasticity", KNEE, 40.0, 0.1),
    ("speed_limit", KNEE, 0.8),
    ("acceleration_limit", KNEE, 8.0),
    ("servo_fade", ARM, 0.05),
    ("servo_off", KNEE, 0.8, 0.503, 0.3),
    SAG,
    ("external_force", "LTibia", 3.0, 0.0, 5.0, 0.503, 0.3),
    ("drag", "RForeArm", 5.0),
    ("presliding", KNEE, 0.5, 0.05),
    ("cogging", KNEE, 0.3, 12.0, 0.5),
    ("integral_term", ARM, 0.3),
    ("dead_band", KNEE, 0.02),
    ("error_derivative", KNEE, 0.7),
]
"""Each effect that moves a robot and that MuJoCo lacks."""

TOGETHER = {
    "late and slow": [LATE, ("speed_limit", KNEE, 0.8)],
    "late, slow and gentle": [
        LATE, ("speed_limit", KNEE, 0.8), ("acceleration_limit", KNEE, 5.0),
    ],
    "late, with play, a wrong zero and a constant torque": [
        LATE, PLAY, ("encoder_offset", KNEE, 0.1), ("torque_offset", KNEE, 0.5),
    ],
    "all of friction": [
        ("angle_friction", KNEE, 0.2, 0.3), ("encoder_offset", KNEE, 0.1),
        ("stribeck_friction", KNEE, 0.1, 0.2, 0.1), ("load_friction", KNEE, 0.2),
        ("coulomb_friction", KNEE, 0.05), ("torque_offset", KNEE, 0.3),
        ("servo_damping", KNEE, 1.4),
    ],
    "a weak supply of servos that weaken, with play and a soft gear": [
        SAG, ("servo_fade", KNEE, 0.05), ("backlash", ARM, 0.03), *SPRING[:1],
        ("torque_offset", ARM, 0.2), ("load_friction", "LElbowRoll", 0.3),
    ],
    "a weak supply of servos at their limits": [SAG, ("torque_limit", KNEE, 0.5)],
    "presliding and a ripple behind a wrong zero": [
        ("presliding", KNEE, 0.3, 0.02), ("cogging", KNEE, 0.3, 12.0, 0.5),
        ("encoder_offset", KNEE, 0.1), ("coulomb_friction", ARM, 0.1),
    ],
    "a controller behind a late and slow command": [
        LATE, ("speed_limit", KNEE, 0.8), ("dead_band", KNEE, 0.02),
        ("integral_term", ARM, 0.3), ("torque_offset", ARM, 0.1),
        ("cogging", ARM, 0.3, 12.0, 0.5), ("encoder_offset", ARM, 0.1),
    ],
    "a controller and play": [
        PLAY, ("integral_term", KNEE, 0.5), ("dead_band", KNEE, 0.01),
    ],
    "a controller and a spring": [
        *SPRING, ("integral_term", KNEE, 0.5), ("servo_fade", KNEE, 0.05),
        ("coulomb_friction", KNEE, 0.2), ("torque_limit", KNEE, 0.8),
    ],
    "weak, with play": [("torque_limit", KNEE, 0.8), PLAY],
    "weak and elastic": [("torque_limit", KNEE, 0.8), *SPRING],
    "elastic with friction": [
        *SPRING, ("coulomb_friction", KNEE, 0.2), ("load_friction", KNEE, 0.2),
    ],
    "elastic, with a fading servo and another zero": [
        *SPRING, ("encoder_offset", KNEE, 0.1), ("servo_fade", KNEE, 0.05),
    ],
}  # fmt: skip


@pytest.fixture(scope="module")
def nao():
    return load_plant("nao", "fixed")


@pytest.mark.parametrize("one", ALONE, ids=lambda one: one[0])
def test_an_effect_alone(nao, one):
    """Servos of the robot have no damping of their own, which one effect needs."""
    own = nao.servo
    if one[0] == "error_derivative":
        own = replace(own, kd_nm_s_rad=np.full_like(own.kp_nm_rad, 0.5))
    with_laws, native = compared(nao, model_of(one), commanded(nao, servo=own), 1e-3)
    assert with_laws < 1e-6
    assert native > 1e-3


@pytest.mark.parametrize("effects", TOGETHER.values(), ids=TOGETHER)
def test_effects_together(nao, effects):
    with_laws, native = compared(nao, model_of(*effects), commanded(nao), 1e-3)
    assert with_laws < 1e-5
    assert native > 5e-3


@pytest.mark.parametrize(
    "name",
    ["weak, with play", "elastic with friction", "a controller and a spring"],
)
def test_servos_with_damping_inside_of_their_limit(name):
    """There MuJoCo leaves a limit a step late, which the laws mend; steps of 2 ms."""
    plant = load_plant("so101", "fixed")
    full = np.ones(len(plant.joints))
    servo = Servo(17 * full, 0.6 * full, 2.9 * full, 0.3 * full)
    effects = [
        (kind, "elbow_flex" if place == KNEE else place, *values)
        for kind, place, *values in TOGETHER[name]
    ]
    run = commanded(plant, servo=servo)
    with_laws, native = compared(plant, model_of(*effects), run, 2e-3)
    assert with_laws < 1e-5
    assert native > 5e-3


def test_late_encoders_of_elastic_joints_see_motors(nao):
    """Other joints are read by MuJoCo's sensors: another cubic between the steps."""
    late = ("sensor_delay", "encoders", 0.0133)
    with_laws, native = compared(nao, model_of(*SPRING, late), commanded(nao), 1e-3)
    assert with_laws < 2e-5
    assert native > 0.1
    run = commanded(nao)
    speed = stepped(nao, model_of(*SPRING, late), run, 1e-3)[1]
    knee = nao.joints.index(KNEE)
    variants = variants_of(nao, [model_of(*SPRING, late)])
    wanted = replay([run], variants, 1e-3)[0]
    np.testing.assert_allclose(
        speed[:, knee], wanted.velocity_rad_s[0, :, knee], atol=1e-6
    )
    slope = np.gradient(wanted.position_rad[0, :, knee], run.trace.time_s)
    assert np.abs(speed[5:-5, knee] - slope[5:-5]).max() < 0.2


def test_a_robot_on_its_feet():
    plant = load_plant("nao", "floating")
    run = commanded(plant, 0.5, size=0.3)
    base = np.array([0, 0, 0.33, 1, 0, 0, 0, *[0.0] * 6])
    run = Run(run.trace, run.position_rad, run.velocity_rad_s, base)
    model = model_of(PLAY, ("external_force", "torso", 9.0, 0.0, 5.0, 0.1, 0.2))
    with_laws, native = compared(plant, model, run, 1e-3)
    assert with_laws < 1e-5
    assert native > 1e-3


PENDULUM = """<body name="rod"><joint name="hinge" axis="0 -1 0"/>
  <inertial pos="0 0 -0.1" mass="0.5" diaginertia="0.015 0.015 0.001"/></body>"""


@pytest.mark.parametrize(
    "one",
    [
        ("load_friction", "hinge", 0.3),
        ("joint_elasticity", "hinge", 20.0, 0.05),
        ("servo_off", "hinge", 0.5, 0.4, 0.5),
    ],
    ids=lambda one: one[0],
)
def test_motors_without_servos(one):
    """Torques instead of targets drive the joint."""
    plant = plant_of(PENDULUM, armature=0.004, emf=0.01)
    time_s = ticks(1.0)
    torque = 0.4 * np.sin(7 * time_s)
    run = run_from(trace_of(plant, time_s, command_torque_nm=torque))
    model = model_of(one)
    (wanted,) = replay([run], variants_of(plant, [model]), 1e-3)
    found = []
    for laws_of in (lambda module: module.LAWS, lambda module: ()):
        module = module_of(laws_text(plant, model))
        text = corrected_mjcf(plant, model, step_s=1e-3)
        compiled = mujoco.MjModel.from_xml_string(text)
        data = mujoco.MjData(compiled)
        parts = laws_of(module)
        laws = module.CorrectedLaws(compiled, data, module.BACK_EMF_NM_S_RAD, parts)
        rows = [0.0]
        for now_nm in torque[:-1]:
            for _ in range(10):
                laws.before_step({}, {"hinge": now_nm})
                mujoco.mj_step(compiled, data)
            rows.append(laws.readings()["hinge"][0])
        found.append(np.abs(rows - wanted.position_rad[0, :, 0]).max())
    assert found[0] < 1e-6
    assert found[1] > 1e-3


def test_the_gyroscope_shows_its_bias(nao):
    bias = PlacedEffect("gyro_bias", "gyroscope", (0.1, -0.2, 0.3))
    module = module_of(laws_text(nao, (bias,)))
    model = mujoco.MjModel.from_xml_string(corrected_mjcf(nao, (bias,)))
    data = mujoco.MjData(model)
    laws = module.CorrectedLaws(model, data, module.BACK_EMF_NM_S_RAD, module.LAWS)
    assert laws.gyroscope([1.0, 1.0, 1.0]) == pytest.approx([1.1, 0.8, 1.3])


# The file


def test_every_effect_is_in_a_file_or_left_out_with_a_reason():
    lacking = {name for name, kind in all_effects().items() if not kind.native}
    left_out = {name for name in lacking if effect(name).no_law}
    assert left_out == {"uneven_ground", "torque_scale"}
    assert {name for name, *_ in ALONE} == lacking - left_out - {"gyro_bias"}


def test_what_is_left_out_is_said(nao):
    pushed = PlacedEffect("external_force", "torso", (9.0, 0.0, 0.0, 1.0, 0.2))
    once = replace(pushed, place="LTibia", recording="kicked")
    scale = PlacedEffect("torque_scale", KNEE, (1.2,))
    every = (*model_of(PLAY), once, scale)
    assert covered_parts(every) == model_of(PLAY)
    told = ast.get_docstring(ast.parse(laws_text(nao, every)))
    assert "In this file:\n- backlash@LKneePitch\n" in told
    assert "external_force@LTibia:\n  it happened in kicked only" in told
    assert "torque_scale@LKneePitch:\n  it is in what a recording says" in told
    assert "PUSHES = [" not in laws_text(nao, every)


def test_where_mujoco_has_all_there_is_no_file(nao):
    assert laws_text(nao, model_of(LATE, ("encoder_offset", KNEE, 0.1))) == ""
    assert laws_text(nao, ()) == ""


def test_it_needs_numpy_and_mujoco_only_and_has_only_what_it_needs(nao):
    text = laws_text(nao, model_of(PLAY))
    tree = ast.parse(text)
    imported = {
        node.module if isinstance(node, ast.ImportFrom) else node.names[0].name
        for node in ast.walk(tree)
        if isinstance(node, (ast.Import, ast.ImportFrom))
    }
    roots = {name.partition(".")[0] for name in imported}
    assert roots - set(sys.stdlib_module_names) == {"mujoco", "numpy"}
    classes = [node.name for node in tree.body if isinstance(node, ast.ClassDef)]
    assert classes == ["Joint", "Step", "Law", "Play", "CorrectedLaws"]
    assert max(map(len, text.splitlines())) <= 88


def test_an_unnamed_joint_keeps_its_target(nao):
    """It stays where it starts until it is told otherwise."""
    module = module_of(laws_text(nao, model_of(PLAY)))
    model = mujoco.MjModel.from_xml_string(corrected_mjcf(nao, model_of(PLAY)))
    data = mujoco.MjData(model)
    arm = model.joint(ARM).qposadr[0]
    data.qpos[arm] = 0.2
    laws = module.CorrectedLaws(model, data, module.BACK_EMF_NM_S_RAD, module.LAWS)
    number = model.actuator(ARM).id
    for targets, wanted in (({KNEE: 0.1}, 0.2), ({ARM: 0.5}, 0.5), ({}, 0.5)):
        laws.before_step(targets)
        assert data.ctrl[number] == pytest.approx(wanted)
        mujoco.mj_step(model, data)


def test_a_joint_that_is_read_late_has_late_sensors(nao):
    late, run = model_of(("late_reading", KNEE, 0.0133)), commanded(nao)
    found, prompt = (stepped(nao, model, run, 1e-3)[0] for model in (late, ()))
    wanted = replay([run], variants_of(nao, [late]), 1e-3)[0].position_rad[0]
    knee = nao.joints.index(KNEE)
    assert np.abs(found - wanted)[5:].max() < 2e-5
    assert np.abs(found - prompt)[:, knee].max() > 1e-3
    assert np.abs(np.delete(found - prompt, knee, axis=1)).max() < 1e-9

"""Tests that drawn effects can be found by the diagnosis, and have the right sizes."""

from dataclasses import replace

import numpy as np
import pytest

from diagnosis.effects.library import all_effects
from diagnosis.plant.load import load_plant
from diagnosis.traces.read import trace_of
from experiments.concealed.case import REFERENCES
from experiments.concealed.draw import (
    CONFUSABLE,
    PLANTS,
    CaseSort,
    drawn_effects,
)
from experiments.concealed.motion import CaseMotion
from worlds.hidden.effects import KINDS
from worlds.hidden.recorded import HiddenSensors, hidden_recording
from worlds.hidden.run import run_hidden
from worlds.hidden.scales import scales
from worlds.recordings.metadata import RecordingMetadata

DURATION_S = 3.0
CASES = 300


def rng(*seed):
    return np.random.default_rng(list(seed))


def short_motion(name):
    """A robot, the scales of its nominal motion, and a trace for the diagnosis."""
    motion = CaseMotion.drawn(name, False, 1e-4, rng(3))
    short = replace(motion, spans_s=((0.3, DURATION_S),) * 4)
    runs = []
    for number in REFERENCES if motion.plant.floating else (0,):
        start_rad, feed = short.feed(number)
        clock = short.clock(number, 0.001)
        nobody = np.random.SeedSequence(0)
        runs.append(
            run_hidden(motion.plant, [], "mujoco", clock, feed, start_rad, nobody)
        )
    return motion, runs, scales(motion.plant, runs)


@pytest.fixture(scope="module")
def drawn():
    """Motions by plant, and 300 drawn cases: (sort, hidden effects)."""
    motions = {name: short_motion(name) for name in PLANTS}
    cases = []
    for number in range(CASES):
        sort = CaseSort.drawn(rng(11, number))
        motion, _, nominal = motions[sort.plant]
        of_run = sort, motion.plant, nominal, motion.places, motion.duration_s
        hidden = drawn_effects(*of_run, rng(12, number))
        cases.append((sort, hidden))
    return motions, cases


@pytest.fixture(scope="module")
def searched(drawn, tmp_path_factory):
    """Each robot as the diagnosis sees it: its plant and traces."""
    folder, found = tmp_path_factory.mktemp("plants"), {}
    for name, (motion, runs, _) in drawn[0].items():
        plant = motion.plant
        source = plant.name
        if plant.file is not None:
            source = folder / plant.file[0]
            source.write_text(plant.file[1])
        base = "floating" if plant.floating else "fixed"
        metadata = RecordingMetadata(str(source), base, "test", servo=plant.servo)
        recording = hidden_recording(
            plant, runs[0], [], HiddenSensors(), rng(1), metadata
        )
        loaded = load_plant(source, base, recording.joints)
        found[name] = loaded, [trace_of(recording, loaded, name)]
    return found


def test_every_drawn_truth_is_one_that_the_diagnosis_can_say(drawn, searched):
    names = set()
    for sort, hidden in drawn[1]:
        plant, traces = searched[sort.plant]
        for effect in hidden.effects:
            learned = effect.name in all_effects()  # some since the set was drawn
            if KINDS[effect.name].outside and not learned:
                continue
            names.add(effect.name)
            known = all_effects()[effect.name]
            assert effect.place in known.places(plant, traces)
            parameters = known.parameters(plant, effect.place)
            units = KINDS[effect.name].parameters
            said = {name: units[name].unit for name in effect.parameters}
            assert {p.name: p.unit for p in parameters} == said
            for parameter in parameters:
                value = effect[parameter.name]
                assert parameter.low <= value <= parameter.high, effect
    assert len(names) > 20


def test_the_diagnosis_knows_the_servos_limits(drawn, searched):
    for name, (plant, _) in searched.items():
        limit_nm = drawn[0][name][0].plant.max_torque_nm
        assert plant.servo.max_torque_nm == pytest.approx(limit_nm)


def test_nothing_is_drawn_that_acts_as_something_else(drawn):
    for sort, hidden in drawn[1]:
        names = {effect.name for effect in hidden.effects}
        fixed = sort.plant in ("pendulum", "so101", "nao_air")
        assert not (fixed and "sensor_delay" in names)
        for group in (
            {"backlash", "joint_elasticity"},
            {"coulomb_friction", "stribeck_friction"},
        ):
            assert len(group & names) < 2
        if sort.plant == "pendulum":
            assert not names & {"drag", "ground_slope"}
            assert len({"payload_mass", "com_offset", "armature"} & names) < 2
        if sort.plant.startswith("nao"):
            assert len({"viscous_friction", "servo_damping"} & names) < 2
        for effect in hidden.effects:
            at = (sort.plant, effect.name)
            if at == ("pendulum", "external_force"):
                assert effect["duration"] <= 0.5
                assert effect["y"] == 0.0  # along the hinge
            if at == ("pendulum", "com_offset"):
                assert effect["x"] == effect["y"] == 0.0
            if effect.name == "servo_damping" and sort.plant.startswith("nao"):
                assert effect["factor"] < 1


def test_compounds_are_of_the_easier_half_and_mostly_apart_if_they_can(drawn):
    ease = {kind: [] for kind in ("single", "pair", "triple")}
    for sort, hidden in drawn[1]:
        if sort.kind in ease:
            ease[sort.kind].append(hidden.ease)
    assert min(ease["single"]) < 0.1
    assert min(ease["pair"] + ease["triple"]) >= 0.5
    assert max(ease["pair"] + ease["triple"]) > 0.9
    for sort, hidden in drawn[1]:
        joints = [e.place for e in hidden.effects if KINDS[e.name].place == "joint"]
        names = tuple(effect.name for effect in hidden.effects)
        if len(names) == 2 and sort.plant != "pendulum" and len(joints) == 2:
            assert (joints[0] == joints[1]) == (names in CONFUSABLE)


@pytest.mark.parametrize(
    ("plant", "effect", "place", "possible"),
    [
        # The pan's axis is vertical: gravity does not feel where it points.
        ("so101", "encoder_offset", "shoulder_pan", False),
        ("so101", "encoder_offset", "shoulder_lift", True),
        ("so101", "payload_mass", "shoulder_link", False),
        ("so101", "com_offset", "shoulder_link", False),
        ("so101", "payload_mass", "gripper_link", True),
        # Only the pan moves it: drag would be the pan's viscous friction.
        ("so101", "drag", "shoulder_link", False),
        ("so101", "drag", "lower_arm_link", True),
        ("pendulum", "drag", "link", False),
        ("pendulum", "external_force", "link", True),
        ("nao_air", "external_force", "LShoulder", False),
        ("nao_air", "external_force", "LForeArm", True),
        ("nao_air", "drag", "LForeArm", True),
        # Feet that stand are the ground's to carry.
        ("nao_standing", "payload_mass", "LFoot", False),
        ("nao_standing", "payload_mass", "torso", True),
        ("nao_walking", "payload_mass", "LFoot", True),
    ],
)
def test_an_effect_is_only_where_it_tells(drawn, plant, effect, place, possible):
    motion, _, nominal = drawn[0][plant]
    found = KINDS[effect].spots(motion.plant, nominal, range(len(motion.plant.joints)))
    places = {spot.body for spot in found}
    if KINDS[effect].place == "joint":
        places = {motion.plant.joints[spot.joint] for spot in found}
    assert (place in places) == possible


@pytest.mark.parametrize(
    ("plant", "effect", "possible"),
    [
        ("pendulum", "ground_slope", False),
        ("so101", "ground_slope", True),
        ("so101", "sensor_delay", False),
        ("nao_standing", "sensor_delay", True),
        ("so101", "gyro_bias", False),
        ("nao_air", "gyro_bias", True),
        ("nao_air", "contact_friction", False),
    ],
)
def test_an_effect_is_only_on_robots_that_tell(drawn, plant, effect, possible):
    motion, _, nominal = drawn[0][plant]
    found = KINDS[effect].spots(motion.plant, nominal, motion.places)
    assert bool(found) == possible


def test_a_pendulum_s_body_is_measured_as_geometry_says(drawn):
    motion, runs, nominal = drawn[0]["pendulum"]
    assert motion.plant.links == nominal.bodies
    angle = np.concatenate([run.position_rad[run.clock.first :, 0] for run in runs])
    lever_m = 0.3 * np.abs(np.sin(angle)).max()
    assert nominal.lever_m == pytest.approx(lever_m, rel=0.01)
    assert nominal.branch_lever_m == pytest.approx(lever_m, rel=0.01)
    box_m = 0.3 * np.hypot(np.ptp(np.sin(angle)), np.ptp(np.cos(angle)))
    assert nominal.moved_m == pytest.approx(box_m, rel=0.01)
    assert nominal.arm_m == pytest.approx(np.array([[0, 0, -0.3]]))

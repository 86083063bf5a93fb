"""`test_corrected_laws.py`: it holds for what is written, and fails for what is not."""

import sys
from dataclasses import replace
from types import ModuleType

import numpy as np
import pytest
from joint_rigs import ticks, trace_of
from laws_rig import model_of

from diagnosis.corrected.laws_file import CORRECTED_LAWS, laws_text
from diagnosis.corrected.laws_test_file import TEST_LAWS_NPZ, expected_npz, text_of_test
from diagnosis.corrected.mjcf import CORRECTED_XML, corrected_mjcf
from diagnosis.plant.load import load_plant
from diagnosis.plant.servo import Servo

LIFT, FLEX = "shoulder_lift", "elbow_flex"
PLAY = ("backlash", FLEX, 0.04)
RUB = ("load_friction", FLEX, 0.3)
LATE = ("command_latency", "commands", 0.0133)
CASES = {
    "play": [PLAY],
    "friction, late commands in the model": [RUB, LATE],
    "play, late commands, another zero, a torque limit": [
        PLAY, LATE, ("encoder_offset", FLEX, 0.1), ("torque_limit", FLEX, 1.2),
        ("torque_offset", LIFT, 0.4),
    ],
    "elastic, with late encoders": [
        ("joint_elasticity", FLEX, 60.0, 0.1), ("armature", FLEX, 0.03),
        ("sensor_delay", "encoders", 0.0133), ("coulomb_friction", FLEX, 0.1),
    ],
    "off and fading, later in a recording": [
        ("servo_off", FLEX, 0.6, 7.3, 0.4), ("servo_fade", LIFT, 0.03),
    ],
}  # fmt: skip


@pytest.fixture(scope="module")
def arm():
    return load_plant("so101", "fixed")


def recorded(plant, start_s=0.0):
    """A recording with steps and sways of its commands, already in motion."""
    time_s = ticks(3.0, tick_s=0.0123, start_s=start_s)
    since_s = time_s - start_s
    sway = 0.4 * np.sin(6 * since_s) + 0.2 * (since_s > 1.0)
    command = np.repeat(sway[:, None], len(plant.joints), axis=1)
    full = np.ones(len(plant.joints))
    servo = Servo(17 * full, 0.6 * full, 2.9 * full, 0.3 * full)
    measured = 0.7 * 0.4 * np.sin(6 * since_s - 0.3)[:, None] * np.ones(command.shape)
    trace = trace_of(plant, time_s, measured, command_rad=command)
    return replace(trace, servo=servo)


def written(folder, plant, model, trace):
    """The module of the test, in a folder with all that it needs."""
    (folder / CORRECTED_XML).write_text(corrected_mjcf(plant, model, trace.servo))
    (folder / CORRECTED_LAWS).write_text(laws_text(plant, model, trace.servo))
    (folder / TEST_LAWS_NPZ).write_bytes(expected_npz(plant, model, trace))
    test = ModuleType("test_corrected_laws")
    test.__file__ = str(folder / "test_corrected_laws.py")
    exec(compile(text_of_test(), test.__file__, "exec"), vars(test))
    return test


@pytest.fixture(autouse=True)
def _fresh_imports(monkeypatch):
    """Each test imports the file of its own folder."""
    monkeypatch.setattr(sys, "path", sys.path.copy())
    monkeypatch.setattr(sys, "dont_write_bytecode", True)
    sys.modules.pop("corrected_laws", None)
    yield
    sys.modules.pop("corrected_laws", None)


@pytest.mark.parametrize("effects", CASES.values(), ids=CASES)
def test_what_is_written_agrees(arm, effects, tmp_path):
    start_s = 6.0 if effects[0][0] == "servo_off" else 0.0
    model = model_of(*effects)
    test = written(tmp_path, arm, model, recorded(arm, start_s))
    assert test.expected("laws_show")
    test.test_it_moves_as_the_sim_of_the_diagnosis()
    test.test_without_the_laws_it_does_not()
    assert test.expected("tolerance_rad") < 4e-4
    assert test.largest_error().max() < 1e-4
    assert test.largest_error(without_laws=True).max() > 8e-4


def test_a_wrong_value_fails(arm, tmp_path):
    test = written(tmp_path, arm, model_of(PLAY), recorded(arm))
    laws = tmp_path / CORRECTED_LAWS
    text = laws.read_text()
    assert '"gap_rad": 0.04' in text
    laws.write_text(text.replace('"gap_rad": 0.04', '"gap_rad": 0.05'))
    with pytest.raises(AssertionError):
        test.test_it_moves_as_the_sim_of_the_diagnosis()


def test_a_robot_on_its_feet(tmp_path):
    plant = load_plant("nao", "floating")
    time_s = ticks(0.5)
    command = 0.2 * np.sin(9 * time_s)[:, None] * np.ones(len(plant.joints))
    trace = replace(
        trace_of(plant, time_s, command_rad=command),
        base_position_m=np.tile([0.0, 0.0, 0.333], (len(time_s), 1)),
        base_orientation=np.tile([1.0, 0.0, 0.0, 0.0], (len(time_s), 1)),
    )
    model = model_of(("backlash", "LKneePitch", 0.05), ("payload_mass", "torso", 0.3))
    test = written(tmp_path, plant, model, trace)
    test.test_it_moves_as_the_sim_of_the_diagnosis()
    test.test_without_the_laws_it_does_not()

"""Tests the oracle on a pendulum that MuJoCo simulates with viscous friction."""

import json

import mujoco
import numpy as np
import pytest

from diagnosis.verdict import Estimate, Found
from experiments.concealed.reading import read_case
from experiments.concealed.scoring.oracle import (
    Oracle,
    answer_key,
    consult,
)
from experiments.concealed.scoring.truth import TrueCase
from groundwalk.errors import RunFolderError
from worlds import Recording, RecordingMetadata, write_recording
from worlds.hidden.effects import Hidden
from worlds.recordings.metadata import ServoGains

XML = """<mujoco model="pendulum"><compiler angle="radian"/><worldbody>
<body name="link"><joint name="swing" axis="0 1 0" range="-3 3"/>
<inertial pos="0 0 -0.3" mass="0.5" diaginertia="0.002 0.002 0.001"/></body>
</worldbody></mujoco>"""
KP, KD, LIMIT, TRUE = 8.0, 0.2, 4.0, 0.08
STEP_S, TICK_S = 0.0005, 0.01
VISCOUS = Hidden("viscous_friction", "swing", {"coefficient": TRUE})


def swing(seed, seconds=3.0):
    """Times, positions and commands of the pendulum with viscous friction."""
    spec = mujoco.MjSpec.from_string(XML)
    spec.option.timestep = STEP_S
    spec.joint("swing").damping[0] = TRUE
    model = spec.compile()
    data, rng = mujoco.MjData(model), np.random.default_rng(seed)
    time_s = TICK_S * np.arange(round(seconds / TICK_S) + 1)
    phases = np.outer(time_s, (2.0, 5.0, 11.0)) + rng.uniform(0, 6, 3)
    command = np.sin(phases) @ np.array([0.5, 0.3, 0.15])
    data.qpos[0] = command[0]
    position = np.zeros(len(time_s))
    for row, asked in enumerate(command):
        position[row] = data.qpos[0]
        for _ in range(round(TICK_S / STEP_S)):
            torque = KP * (asked - data.qpos[0]) - KD * data.qvel[0]
            data.qfrc_applied[0] = np.clip(torque, -LIMIT, LIMIT)
            mujoco.mj_step(model, data)
    return time_s, position + rng.normal(0, 0.001, len(time_s)), command


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """A case with three recordings."""
    folder = tmp_path_factory.mktemp("case")
    (folder / "nominal.xml").write_text(XML)
    plant = {"robot": "nominal.xml", "base": "fixed"}
    (folder / "plant.json").write_text(json.dumps(plant))
    (folder / "recordings").mkdir()
    servo = {"swing": ServoGains(KP, KD, LIMIT)}
    for seed in range(3):
        time_s, position, command = swing(seed)
        columns = {
            "time": time_s,
            "position.swing": position,
            "command.swing": command,
        }
        metadata = RecordingMetadata("nominal.xml", "fixed", "test", servo)
        path = folder / "recordings" / f"{seed}.parquet"
        write_recording(Recording(columns, metadata), path)
    return folder


def answer(name, parameter, value, place="swing"):
    return [Found(name, place, {parameter: Estimate(value, value, value, "1")}, 0.9)]


def test_the_oracle_reaches_the_noise_and_answers_are_replayed_beside_it(folder):
    case = TrueCase("pendulum", "mujoco", "single", (VISCOUS,), name="case_000")
    answers = {
        "right": answer("viscous_friction", "coefficient", TRUE),
        "wrong": answer("coulomb_friction", "torque", 0.02),
        "elsewhere": answer("viscous_friction", "coefficient", TRUE, "no such joint"),
        "nothing": [],
    }
    oracle = consult(folder, case, answers)
    errors = {name: rms for name, (_, rms) in oracle.answered.items()}
    assert 0.7 < oracle.fitted < 1.1  # uncertain starts take some of the noise away
    assert oracle.nominal > 1.5 * oracle.fitted
    assert oracle.level == "L1"
    assert errors["right"] == pytest.approx(oracle.fitted, rel=0.1)
    assert oracle.fitted < errors["wrong"] < oracle.nominal
    assert errors["nothing"] == errors["elsewhere"] == oracle.nominal
    assert oracle.neutral == {"viscous_friction@swing": {"coefficient": 0.0}}
    assert Oracle.from_json(oracle.to_json()) == oracle


@pytest.mark.parametrize(
    ("gain", "level"),
    [(100.1, "L1"), (99.0, "L2"), (20.1, "L2"), (19.0, "L3"), (4.9, "L4"), (-3, "L4")],
)
def test_levels_are_by_gain(gain, level):
    assert Oracle(gain, 2.0, 1.0, {}, {}).level == level


def test_other_values_are_other_answers():
    one = answer("viscous_friction", "coefficient", 0.1)
    assert answer_key(one) == answer_key(answer("viscous_friction", "coefficient", 0.1))
    assert answer_key(one) != answer_key(answer("viscous_friction", "coefficient", 0.2))
    assert answer_key(one) != answer_key([])


def test_a_folder_without_a_case_is_refused(tmp_path):
    with pytest.raises(RunFolderError, match="holds no case"):
        read_case(tmp_path)

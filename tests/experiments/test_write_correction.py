"""`groundwalk diagnose` leaves behind a sim that is right."""

import csv
import subprocess
import sys
from types import SimpleNamespace

import mujoco
import numpy as np
import pytest

import robots
import terrain
from diagnosis.corrected.sim import CorrectedSim
from diagnosis.effects.parts import PlacedEffect
from diagnosis.plant.load import load_plant
from diagnosis.traces.trace import Trace
from diagnosis.verdict import Estimate, Found
from experiments.diagnosis_report.corrected_files import write_correction
from experiments.runs.folder import RunFolder
from experiments.walking.evaluation import make_sim
from worlds import WorldOptions
from worlds.sim.world import SimWorld

WEAK = PlacedEffect("servo_gain", "LKneePitch", (0.5,))
PLAY = PlacedEffect("backlash", "LKneePitch", (0.03,))
KNEE = Found("servo_gain", "LKneePitch", {"factor": Estimate(0.5, 0.4, 0.6, "1")}, 0.9)
TIME_S = np.arange(61) * 0.01


def found(effects, model=(PLAY, WEAK)):
    """As much of a diagnosis as is written down."""
    plant = load_plant("nao", "fixed")
    command = np.repeat(0.3 * np.sin(8 * TIME_S)[:, None], len(plant.joints), axis=1)
    trace = Trace("one", TIME_S, 0 * command, plant.servo, command_rad=command)
    return SimpleNamespace(
        verdict=SimpleNamespace(effects=effects),
        model=model,
        given=(),
        nuisance=(),
        plant=plant,
        test=SimpleNamespace(traces=[trace]),
    )


def sim_of(correction):
    ground, seed = terrain.make("flat", seed=0), np.random.SeedSequence(0)
    options = WorldOptions(threads=1)
    return make_sim(robots.get("nao"), [ground], [seed], options, correction)


def test_what_was_found_is_written_and_can_be_walked_in(tmp_path):
    write_correction(RunFolder(tmp_path), found([KNEE]))
    model = mujoco.MjModel.from_xml_path(str(tmp_path / "corrected.xml"))
    nominal = load_plant("nao", "fixed").servo.kp_nm_rad
    gains = model.actuator_gainprm[:, 0] / nominal
    knee = model.actuator("LKneePitch").id
    assert gains[knee] == pytest.approx(0.5)
    assert np.delete(gains, knee) == pytest.approx(1.0)
    assert type(sim_of(tmp_path)) is CorrectedSim


def test_where_nothing_was_found_there_is_nothing_to_correct(tmp_path):
    write_correction(RunFolder(tmp_path), found([]))
    assert list(tmp_path.iterdir()) == []
    assert type(sim_of(None)) is SimWorld


def run_its_test(folder):
    """Run the test in the folder as a user would, who has no clone of this project."""
    command = [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", "."]
    return subprocess.run(
        command, cwd=folder, capture_output=True, text=True, check=False, env={}
    )


def test_the_laws_come_with_a_test_that_holds_and_can_fail(tmp_path):
    write_correction(RunFolder(tmp_path), found([KNEE]))
    names = {path.name for path in tmp_path.iterdir()}
    assert names == {
        "corrected.xml", "corrected.json", "corrected_laws.py", "corrected_joints.csv",
        "test_corrected_laws.py", "corrected_laws_test.npz",
    }  # fmt: skip
    assert sum(path.stat().st_size for path in tmp_path.iterdir()) < 1e6
    held = run_its_test(tmp_path)
    assert held.returncode == 0, held.stdout
    assert "2 passed" in held.stdout
    laws = tmp_path / "corrected_laws.py"
    text = laws.read_text()
    assert '"gap_rad": 0.03' in text
    laws.write_text(text.replace('"gap_rad": 0.03', '"gap_rad": 0.027'))
    wrong = run_its_test(tmp_path)
    assert "1 failed, 1 passed" in wrong.stdout


def test_there_are_no_laws_where_mujoco_has_all(tmp_path):
    write_correction(RunFolder(tmp_path), found([KNEE], model=(WEAK,)))
    assert not list(tmp_path.glob("*laws*"))


def test_the_table_has_each_joint_with_what_is_known(tmp_path):
    write_correction(RunFolder(tmp_path), found([KNEE]))
    with (tmp_path / "corrected_joints.csv").open() as file:
        rows = {row["joint"]: row for row in csv.DictReader(file)}
    plant = load_plant("nao", "fixed")
    assert list(rows) == list(plant.joints)
    full = plant.servo.kp_nm_rad[plant.joints.index("LKneePitch")]
    gains = [float(rows["LKneePitch"][f"kp{end} [N m/rad]"]) for end in ENDS]
    assert gains == pytest.approx([0.5 * full, 0.4 * full, 0.6 * full], rel=1e-5)
    assert rows["RKneePitch"]["kp low [N m/rad]"] == ""


ENDS = ("", " low", " high")

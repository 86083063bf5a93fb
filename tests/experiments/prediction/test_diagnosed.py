"""What is read from the run of a diagnosis, made up here: its sims, what it lacks."""

import json

import pytest

from diagnosis import PlacedEffect, load_plant
from diagnosis.conclude.soft_friction import CREEPS
from diagnosis.corrected.effects_json import Correction
from diagnosis.verdict import ChannelFit, Estimate, Fit, Found, Verdict, When
from experiments.prediction.diagnosed import DiagnosisRun
from groundwalk.errors import BadRecordingError, BadValueError, RunFolderError

KNEE, HIP = "LKneePitch", "LHipPitch"
PLANT = load_plant("nao", "fixed")
RUBS = PlacedEffect("coulomb_friction", KNEE, (0.3,))
OFF = PlacedEffect("servo_off", HIP, (1.0, 2.0, 0.5))
WEAK = PlacedEffect("servo_gain", KNEE, (1.02,))
RUBBED = PlacedEffect("coulomb_friction", KNEE, (0.1,))


def found(placed, names, **when):
    values = zip(names, placed.values, strict=True)
    estimates = {name: Estimate(one, one, one, "1") for name, one in values}
    return Found(placed.name, placed.place, estimates, 0.9, **when)


FOUND = found(RUBS, ["torque"])


def event(recording):
    names = ["share", "start", "duration"]
    return found(OFF, names, when=When("burst", 2.0, 2.5, recording))


def fit(names):
    numbers = {"nominal": 5.0, "corrected": 1.0, "floor": 1.0}
    return Fit(
        **numbers, channels={one: ChannelFit(**numbers, unit="") for one in names}
    )


def write_run(folder, verdict, model=(), **options):
    asked = {"verb": "diagnose", "robot": "nao", "recordings": ["a.parquet"]} | options
    (folder / "config.json").write_text(json.dumps(asked))
    (folder / "diagnosis.json").write_text(verdict.to_json())
    if model:
        text = Correction.of(PLANT, model).to_json()
        (folder / "corrected.json").write_text(text)
    return folder


def test_the_corrected_sim_has_small_mismatch_as_well(tmp_path):
    run = DiagnosisRun.read(
        write_run(tmp_path, Verdict("effects", (FOUND,)), (WEAK, RUBS))
    )
    before, after, events = run.sims(PLANT)
    assert (before, set(after), events) == ((), {WEAK, RUBS}, ())
    assert not run.changed
    assert not run.creeps


def test_what_happened_in_one_recording_is_no_physics_of_the_robot(tmp_path):
    verdict = Verdict("effects", (FOUND, event("a")))
    run = DiagnosisRun.read(write_run(tmp_path, verdict, (RUBS, OFF)))
    assert run.sims(PLANT) == ((), (RUBS,), (OFF,))
    verdict = Verdict("effects", (FOUND, event(None)))  # it happened in all of them
    run = DiagnosisRun.read(write_run(tmp_path, verdict, (RUBS, OFF)))
    assert run.sims(PLANT) == ((), (RUBS, OFF), ())


def test_with_a_reference_the_sim_before_is_that_of_the_healthy_robot(tmp_path):
    model, verdict = (RUBBED, WEAK, RUBS), Verdict("effects", (FOUND,))
    options = {"reference": ["healthy.parquet"]}
    run = DiagnosisRun.read(write_run(tmp_path, verdict, model, **options))
    before, after, _ = run.sims(PLANT)
    assert set(before) == {RUBBED, WEAK}
    assert set(after) == {RUBBED, WEAK, RUBS}
    assert run.changed
    assert [path.name for path in run.recordings] == ["a.parquet", "healthy.parquet"]


def test_friction_creeps_as_the_verdict_says(tmp_path):
    verdict = Verdict("effects", (FOUND,), limits=("Something.", CREEPS))
    assert DiagnosisRun.read(write_run(tmp_path, verdict, (RUBS,))).creeps


def test_other_joints_are_refused(tmp_path):
    names = [f"position.{joint}" for joint in PLANT.joints]
    same, fewer = (
        Verdict("effects", (FOUND,), fit=fit(own)) for own in (names, names[1:])
    )
    run = DiagnosisRun.read(write_run(tmp_path, same, (RUBS,)))
    run.check_joints(PLANT)
    assert run.compares_torques is False
    run = DiagnosisRun.read(write_run(tmp_path, fewer, (RUBS,)))
    with pytest.raises(BadRecordingError, match=f"recordings have.*{PLANT.joints[0]}"):
        run.check_joints(PLANT)


def test_torques_are_known_by_the_channels(tmp_path):
    names = [f"torque.{joint}" for joint in PLANT.joints]
    verdict = Verdict("effects", (FOUND,), fit=fit(names))
    run = DiagnosisRun.read(write_run(tmp_path, verdict, (RUBS,)))
    assert run.compares_torques is True
    run.check_joints(PLANT)


@pytest.mark.parametrize("kind", ["none", "not_identifiable"])
def test_where_nothing_is_named_there_is_nothing_to_check(tmp_path, kind):
    folder = write_run(tmp_path, Verdict(kind, limits=("Nothing moved.",)))
    with pytest.raises(BadValueError, match=f"is '{kind}': no effect is named"):
        DiagnosisRun.read(folder)


def test_a_run_without_a_corrected_sim_is_refused(tmp_path):
    folder = write_run(tmp_path, Verdict("effects", (FOUND,)))
    with pytest.raises(BadValueError, match=r"no corrected\.json"):
        DiagnosisRun.read(folder)


def test_what_is_no_run_of_a_diagnosis_is_refused(tmp_path):
    with pytest.raises(RunFolderError, match="no run folder"):
        DiagnosisRun.read(tmp_path)
    (tmp_path / "config.json").write_text('{"verb": "evaluate"}')
    with pytest.raises(RunFolderError, match="a run of evaluate, not of diagnose"):
        DiagnosisRun.read(tmp_path)
    (tmp_path / "config.json").write_text('{"verb": "diagnose"}')
    with pytest.raises(RunFolderError, match="did not get there"):
        DiagnosisRun.read(tmp_path)
    (tmp_path / "diagnosis.json").write_text('{"format": 1}')
    with pytest.raises(BadValueError, match=r"diagnosis\.json"):
        DiagnosisRun.read(tmp_path)

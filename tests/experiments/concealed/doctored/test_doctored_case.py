"""Whole doctored cases: what is true of them, and that undoing it undoes it."""

import json
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from made_up_data import write_arm, write_data

from diagnosis.audit.audit import audit
from diagnosis.effects import PlacedEffect, all_effects, effect
from diagnosis.material import Material
from diagnosis.residuals.torques.torque_predictor import predictor_of
from experiments.concealed.doctored import case as doctored
from experiments.concealed.doctored.case import LEAST_NATS, doctored_case
from experiments.concealed.doctored.plan import planned_real
from experiments.concealed.doctored.robots import IN_MODEL, NOTHING, OUTSIDE, REAL_SETS
from experiments.concealed.make import ConcealedMake, main
from experiments.concealed.reading import read_case
from experiments.concealed.scoring.truth import read_truth
from experiments.concealed.written import write_case
from experiments.runs import processes
from groundwalk.errors import BadRecordingError, BadValueError

REAL = Path(__file__).parents[4] / ".." / "shared" / "data"
COUNT, SEED = 120, 4


@pytest.fixture(scope="module")
def arm(tmp_path_factory):
    """Data of one robot, the simulated arm."""
    folder = tmp_path_factory.mktemp("arm")
    write_arm(folder)
    return folder


def first_with(data, what, name=None):
    """Number of the first case of a set in which something is doctored."""
    for number in range(COUNT):
        robot, done = planned_real(data, SEED, COUNT, number)
        if done == what and name in (None, robot):
            return number
    pytest.skip(f"no recordings for {what}")


def before_and_after(data, number):
    """The case as it would be without the doctoring, and the case."""
    kept = {}

    def noting(real, what, model, parts, rng):
        kept["was"] = model.text, parts.recordings
        return original(real, what, model, parts, rng)

    original = doctored._doctored
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(doctored, "_doctored", noting)
        made = doctored_case(data, SEED, number, COUNT)
    text, recordings = kept["was"]
    return replace(made, model=(made.model[0], text), recordings=recordings), made


def read_one(folder, made):
    """Plant and up to 2 s (12 s of 50 Hz) of the first recording of a case."""
    write_case(folder / "cases", folder / "truths", "one", made)
    plant, traces, _ = read_case(folder / "cases" / "one")
    one = traces[0]
    return plant, one.part(0, min(one.ticks, max(600, int(2 / one.tick_s))))


def errors(plant, trace, *models):
    """Rms error [noise] of a recording as a diagnosis prepares it, for each model."""
    ready = Material.of(plant, [trace], None, "servos")
    for one in models:
        for placed in one:
            places = effect(placed.name).places(ready.plant, ready.traces)
            assert placed.place in places
    predictor = predictor_of(ready.plant, ready.traces, ready.channels)
    predictor.calibrate(models[-1], tolerances=False)
    residuals = predictor.residuals(models)[:, predictor.scored]
    return np.sqrt(np.mean(residuals**2, axis=1)).tolist()


def undone(tmp_path, data, what, name=None):
    """Errors without the doctoring, with it, and with it undone by the true effect."""
    was, made = before_and_after(data, first_with(data, what, name))
    (true,) = made.truth["effects"]
    plant0, trace0 = read_one(tmp_path / "was", was)
    plant, trace = read_one(tmp_path / "is", made)
    (known,) = effect(true["name"]).parameters(plant, true["place"])
    value = true["parameters"][known.name]
    assert known.low <= value <= known.high
    rows = min(trace.ticks, trace0.ticks)
    (nominal,) = errors(plant0, trace0.part(0, rows), ())
    placed = PlacedEffect(true["name"], true["place"], (value,))
    wrong, right = errors(plant, trace.part(0, rows), (), (placed,))
    return nominal, wrong, right


@pytest.mark.parametrize(
    "what", ["servo_gain", "command_latency", "encoder_offset", "payload_mass"]
)
def test_the_true_effect_undoes_a_doctoring_of_a_simulated_arm(tmp_path, arm, what):
    nominal, wrong, right = undone(tmp_path, arm, what)
    assert abs(right - nominal) < 0.25 * abs(wrong - nominal)


@pytest.mark.slow
@pytest.mark.skipif(not REAL.is_dir(), reason="no real recordings in ../shared/data")
@pytest.mark.parametrize(
    ("name", "what"),
    {  # one robot for each
        what: (name, what)
        for name, real in REAL_SETS.items()
        for what in real.doctorings
        if what not in OUTSIDE
    }.values(),
)
def test_the_true_effect_undoes_a_doctoring_of_real_recordings(tmp_path, name, what):
    if what not in all_effects():
        pytest.skip(f"the diagnosis has no {what}")
    nominal, _, right = undone(tmp_path, REAL, what, name)
    assert right == pytest.approx(nominal, rel=0.02)


def test_swapped_joints_are_refused_in_the_words_of_the_truth(tmp_path, arm):
    was, made = before_and_after(arm, first_with(arm, "joints_swapped"))
    plant, trace = read_one(tmp_path, made)
    refused = audit([trace], plant).refused
    assert any(all(word in text for word in made.truth["refusal"]) for text in refused)
    plant, trace = read_one(tmp_path / "was", was)
    assert audit([trace], plant).refused == ()


def test_the_reference_has_what_is_real_and_the_model_that_fits_it(arm):
    for number in range(COUNT):
        was, made = before_and_after(arm, number)
        truth = made.truth
        in_model = any(one["name"] in IN_MODEL for one in truth["effects"])
        assert made.reference
        assert made.before is not None
        assert made.before[1] == was.model[1]
        assert (made.before[1] != made.model[1]) == in_model
        assert not set(made.reference) & set(made.recordings)
        if truth["kind"] == "none":
            assert was.recordings == made.recordings
        kinds = {"none": 0, "single": 1, "outside": 1}
        assert len(truth["effects"]) == len(truth["nats"]) == kinds[truth["kind"]]


def test_what_is_doctored_shows(arm, monkeypatch):
    faintest = [
        made.truth["nats"][0]
        for number in range(COUNT)
        if (made := doctored_case(arm, SEED, number, COUNT)).truth["kind"] == "single"
    ]
    assert min(faintest) >= LEAST_NATS
    monkeypatch.setattr(doctored, "LEAST_NATS", 0.0)
    assert any(
        doctored_case(arm, SEED, number, COUNT).truth["nats"] < [LEAST_NATS]
        for number in range(COUNT)
        if planned_real(arm, SEED, COUNT, number)[1] not in (NOTHING, *OUTSIDE)
    )


def make(folder, data, cases=8):
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(
            processes, "ProcessPoolExecutor", lambda *_, **__: ThreadPoolExecutor(1)
        )
        main(ConcealedMake(folder, cases=cases, seed=SEED, real=data, threads=1))
    return (folder / "sealed.sha256").read_text()


def test_a_set_is_sealed_and_tells_nothing(tmp_path):
    data = tmp_path / "data"
    write_data(data)
    digest = make(tmp_path / "set", data)
    assert make(tmp_path / "again", data) == digest
    truth = read_truth(tmp_path / "set")
    assert (truth.set, len(truth.cases)) == (3, 8)
    for name, case in truth.cases.items():
        folder = tmp_path / "set" / "cases" / name
        assert case.engine == "real"
        told = json.loads((folder / "plant.json").read_text())
        assert (folder / told["robot"]).is_file()
        _, traces, reference = read_case(folder)
        assert bool(reference) == case.reference
        assert len(traces) >= 2
        assert all(trace.servo.kp_nm_rad.any() for trace in traces)
        files = [path.name for path in folder.rglob("*") if path.is_file()]
        assert not any("doctor" in file or "truth" in file for file in files)


def test_data_without_recordings_are_told(tmp_path):
    with pytest.raises(BadRecordingError, match="no recordings"):
        make(tmp_path / "set", tmp_path)
    with pytest.raises(BadValueError, match="no folder of real recordings"):
        ConcealedMake(tmp_path / "set", real=tmp_path / "nothing")


def test_recordings_without_motion_are_told(tmp_path, arm, monkeypatch):
    monkeypatch.setattr("experiments.concealed.doctored.parts.MOVES", 100.0)
    with pytest.raises(BadRecordingError, match="no joint at which servo_gain"):
        doctored_case(arm, SEED, first_with(arm, "servo_gain"), COUNT)

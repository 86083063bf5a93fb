"""`groundwalk predict` on a pendulum with hidden friction, from a diagnosis to a page.

The other engine (PyBullet) makes the recordings, with friction that it has by itself.
"""

import json
import shutil
from functools import partial
from types import SimpleNamespace

import pytest
from copied_processes import groundwalk
from made_once import made_once

from diagnosis import Rules
from experiments.diagnose import Diagnose, run_diagnosis
from experiments.predict import Predict, _check_compared, main, predict_recordings
from experiments.prediction.page import rows_of
from experiments.prediction.result import PredictionResult
from experiments.record import Record
from experiments.record import main as record
from groundwalk.errors import BadRecordingError, BadValueError, GroundwalkError
from worlds import read_recording
from worlds.recordings.files import write_recording

TORQUE_NM = 0.1
FRICTION = (f"coulomb_friction@swing:torque={TORQUE_NM}",)
KINDS = {
    "seen": ("multisine", 1, FRICTION, 3.0),
    "new": ("steps", 5, FRICTION, 2.0),
    "smooth": ("steps", 6, (), 2.0),
    "short": ("steps", 7, FRICTION, 0.5),
}
"""Motion, seed, hidden physics and duration [s] of each recording."""

QUICK = partial(
    Rules, single_effects=6, further_effects=2, beam=1, pairs=0, finished=2, largest=1
)
"""Looks for a single effect only, in a fraction of the time."""

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    """A folder of recordings, and `run`, a diagnosis of the one that was seen."""

    def make(folder):
        for name, (motion, seed, hidden, duration_s) in KINDS.items():
            own = {"robot": "pendulum", "motion": motion, "seed": seed}
            options = own | {"hidden": hidden, "duration": duration_s}
            record(Record(**options, out=folder / f"{name}.parquet"))
        model = str(folder / "seen.nominal.xml")
        with pytest.MonkeyPatch.context() as patch:
            patch.setattr("experiments.diagnose.Rules", QUICK)
            run_diagnosis(
                Diagnose((folder / "seen.parquet",), model, out=folder / "run")
            )
        write_recording(read_recording(folder / "seen.parquet"), folder / "again.csv")

    return made_once(tmp_path_factory, "predicted", make)


@pytest.fixture(scope="module")
def predicted(made, tmp_path_factory):
    """The folder of a prediction of a new recording, beside one that was used."""

    def make(folder):
        recordings = made / "new.parquet", made / "again.csv"
        predict_recordings(Predict(made / "run", recordings, out=folder / "out"))

    return made_once(tmp_path_factory, "a_prediction", make) / "out"


def read(folder):
    return PredictionResult.from_json((folder / "result.json").read_text())


def test_the_corrected_sim_predicts_a_new_recording(made, predicted):
    result = read(predicted)
    assert result.judgement == "holds"
    assert [one.name for one in result.effects] == ["coulomb_friction"]
    assert result.together.low > 3
    swing = result.channels["position.swing"]
    assert swing.ratio == pytest.approx(swing.nominal / swing.corrected)
    assert swing.low < swing.ratio < swing.high
    # what is left is the noise of the encoder
    assert swing.corrected < 1.5 * swing.floor
    verdict = json.loads((made / "run" / "diagnosis.json").read_text())
    assert result.promise.nominal == verdict["fit"]["nominal"]
    assert result.interval.unit == "blocks of time"


def test_a_used_recording_is_marked_and_does_not_count(predicted):
    result = read(predicted)
    new, used = result.recordings
    assert (new.name, new.used) == ("new", False)
    assert (used.name, used.used, used.together) == ("again", True, None)
    assert new.together.nominal == pytest.approx(result.together.nominal)
    assert new.channels["position.swing"].ratio == pytest.approx(
        result.channels["position.swing"].ratio
    )
    assert ("recording again: used, not counted", *[""] * 6) in rows_of(result)


def test_a_prediction_explains_itself(predicted):
    written = {path.name for path in predicted.iterdir()}
    assert written >= {
        "result.json", "result.md", "report.html", "config.json", "provenance.json",
        "audit.json", "channel_1.png",
    }  # fmt: skip
    page = (predicted / "result.md").read_text()
    assert "Holds: the corrected sim's error is" in page
    assert "dry friction at the joint swing" in page
    assert "![The position of the joint swing in recording new](channel_1.png)" in page
    report = (predicted / "report.html").read_text()
    assert report.count("<img src=") == 1
    assert "data:image/png" in report


def test_where_there_is_no_friction_the_promise_does_not_hold(made, tmp_path, capsys):
    out = tmp_path / "out"
    main(Predict(made / "run", (made / "smooth.parquet",), out=out))
    result = read(out)
    assert result.judgement == "does not hold"
    assert result.together.high < 1
    # as large as the friction's error, which the corrected sim makes now
    assert result.together.nominal < 1.5 < 5 < result.together.corrected
    said = capsys.readouterr().out
    assert said.startswith("judgement   does not hold: the corrected sim's error is")
    assert f"Results written to {out}" in said


def test_bad_input_is_one_line_and_leaves_nothing(made, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    run, new = made / "run", made / "new.parquet"
    arm = tmp_path / "arm.parquet"
    record(Record(arm, robot="so101", motion="steps", duration=1.0))
    there = sorted(tmp_path.iterdir())
    for options, said in (
        ({"run": tmp_path}, "is no run folder"),
        ({"recordings": (made / "again.csv",)}, "all of these recordings were used"),
        ({"recordings": (made / "nowhere.parquet",)}, "nowhere.parquet"),
        ({"recordings": (arm,)}, "joint"),
        ({"recordings": (made / "short.parquet",)}, "at least 1 s are needed"),
        ({"robot": "nao"}, "joint"),
        ({"out": made}, "exists already"),
    ):
        asked = {"run": run, "recordings": (new,)} | options
        with pytest.raises(GroundwalkError, match=said) as error:
            main(Predict(**asked))
        assert "\n" not in str(error.value)
        assert sorted(tmp_path.iterdir()) == there


def test_a_model_that_has_moved_is_given_anew(made, tmp_path):
    run = tmp_path / "run"
    shutil.copytree(made / "run", run)
    config = json.loads((run / "config.json").read_text())
    config["robot"] = str(tmp_path / "seen.nominal.xml")
    (run / "config.json").write_text(json.dumps(config))
    asked = Predict(run, (made / "short.parquet",))
    with pytest.raises(BadValueError, match="give it with --robot"):
        main(asked)
    model = str(made / "seen.nominal.xml")
    with pytest.raises(GroundwalkError, match="at least 1 s"):  # and not the model
        main(Predict(run, (made / "short.parquet",), robot=model))


def test_on_the_command_line_bad_input_has_the_status_2(made, tmp_path):
    words = ["predict", str(made / "run"), str(made / "again.csv")]
    status, printed = groundwalk(tmp_path, words)
    assert status == 2
    assert printed.startswith("groundwalk: all of these recordings were used")
    assert len(printed.splitlines()) == 1
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    ("torques", "reference", "channel", "said"),
    [
        (True, ("healthy.csv",), "position.elbow", "reference taught"),
        (True, (), "position.elbow", "in these recordings only motions"),
        (False, (), "torque.elbow", "in these recordings only torques"),
        (False, ("healthy.csv",), "position.elbow", ""),
        (True, (), "torque.elbow", ""),
        (None, (), "torque.elbow", ""),  # nothing was held out
    ],
)
def test_the_same_quantities_must_be_compared(torques, reference, channel, said):
    run = SimpleNamespace(compares_torques=torques, options={"reference": reference})
    if not said:
        _check_compared(run, [channel])
        return
    with pytest.raises(BadRecordingError, match=said):
        _check_compared(run, [channel])

import contextlib
import io
import json
import shutil
import sys
from dataclasses import replace

import pytest
from made_once import made_once

from diagnosis.verdict import Verdict
from experiments.diagnose import STAGES, Diagnose, main
from experiments.record import Record
from experiments.record import main as record
from experiments.runs.checkpoint_files import CheckpointFiles
from groundwalk.errors import (
    BadRecordingError,
    BadValueError,
    RunFolderError,
    UnknownNameError,
)


@pytest.fixture(scope="module")
def recording(tmp_path_factory):
    """A recording of a pendulum whose servo has 0.9 of its nominal stiffness."""
    hidden, name = ("servo_gain@swing:factor=0.9",), "swing.parquet"

    def recorded(folder):
        options = {"robot": "pendulum", "motion": "multisine", "duration": 4.0}
        record(Record(**options, hidden=hidden, out=folder / name))

    return made_once(tmp_path_factory, "recorded", recorded) / name


@pytest.fixture(scope="module")
def diagnosed(recording, tmp_path_factory):
    """The folder of its diagnosis, its intermediate results, and what was printed."""
    model, said = recording.with_name("swing.nominal.xml"), io.StringIO()

    def run(folder):
        out = folder / "run"

        def kept(files):
            (out / STAGES).rename(folder / STAGES)

        with pytest.MonkeyPatch.context() as patch, contextlib.redirect_stdout(said):
            patch.setattr(CheckpointFiles, "delete", kept)
            main(Diagnose((recording,), str(model), out=out))
        (folder / "said.txt").write_text(said.getvalue())

    folder = made_once(tmp_path_factory, "diagnosed", run)
    return folder / "run", folder / STAGES, (folder / "said.txt").read_text()


@pytest.mark.slow
def test_a_diagnosis_writes_all_that_it_promises(recording, diagnosed):
    model = recording.with_name("swing.nominal.xml")
    out, _, said = diagnosed
    verdict = Verdict.from_json((out / "diagnosis.json").read_text())
    assert verdict.kind == "effects"
    (found,) = verdict.effects
    assert (found.name, found.place) == ("servo_gain", "swing")
    factor = found.parameters["factor"]
    assert factor.value == pytest.approx(0.9, abs=0.02)
    assert factor.low < 0.9 < factor.high
    assert factor.low < factor.value < factor.high
    assert verdict.fit.corrected < 0.3 * verdict.fit.nominal
    assert {path.name for path in out.iterdir()} >= {
        "report.html", "overlay.rrd", "audit.json", "config.json", "provenance.json",
        "seen.json",
    }  # fmt: skip
    config = json.loads((out / "config.json").read_text())
    assert config["recordings"] == [str(recording)]
    assert "servo" in said
    with pytest.raises(RunFolderError, match="exists already"):
        main(Diagnose((recording,), str(model), out=out))


@pytest.mark.slow
def test_an_interrupted_diagnosis_is_resumed(
    recording, diagnosed, tmp_path, capsys, monkeypatch
):
    model = recording.with_name("swing.nominal.xml")
    out, saved = tmp_path / "run", CheckpointFiles.save

    def interrupted(files, key, content):
        saved(files, key, content)
        if key.endswith("001"):
            raise KeyboardInterrupt

    with monkeypatch.context() as patch:
        patch.setattr(CheckpointFiles, "save", interrupted)
        with pytest.raises(KeyboardInterrupt):
            main(Diagnose((recording,), str(model), out=out))
    assert not (out / "diagnosis.json").exists()
    main(Diagnose(resume=out))
    said = capsys.readouterr().err
    assert "search round 1" in said
    assert "report 3/3" in said
    whole, *_ = diagnosed
    resumed, verdict = (
        Verdict.from_json((path / "diagnosis.json").read_text())
        for path in (out, whole)
    )
    assert replace(resumed, seconds=0.0) == replace(verdict, seconds=0.0)
    written = {path.name for path in out.iterdir()}
    assert written == {path.name for path in whole.iterdir()}
    capsys.readouterr()
    main(Diagnose(resume=out))  # a run that is complete is only shown again
    assert "search round" not in capsys.readouterr().err


def test_recordings_that_the_audit_refuses_leave_no_folder(recording, tmp_path):
    short = tmp_path / "short.parquet"
    options = {"robot": "pendulum", "motion": "multisine"}
    record(Record(**options, duration=1.0, out=short))
    with pytest.raises(BadRecordingError):
        main(
            Diagnose(
                (short,),
                str(short.with_name("short.nominal.xml")),
                out=tmp_path / "run",
            )
        )
    assert not (tmp_path / "run").exists()


@pytest.mark.slow
def test_an_arm_from_a_urdf_is_diagnosed_to_the_end(tmp_path, capsys):
    """An arm has no feet: its overlay shows curves without a robot."""
    path = tmp_path / "arm.parquet"
    record(Record(robot="so101", motion="steps", duration=3.0, out=path))
    model = path.with_name("arm.nominal.urdf")
    main(Diagnose((path,), str(model), out=tmp_path / "run"))
    written = {path.name for path in (tmp_path / "run").iterdir()}
    assert written >= {"diagnosis.json", "report.html", "overlay.rrd"}
    assert "not written" not in capsys.readouterr().err


@pytest.mark.slow
def test_a_verdict_outlives_an_overlay_that_fails(
    diagnosed, tmp_path, capsys, monkeypatch
):
    """In a run that goes on after its search, when its folder has no verdict yet."""
    whole, stages, _ = diagnosed
    out = tmp_path / "run"
    shutil.copytree(stages, out / STAGES)
    for name in ("config.json", "provenance.json"):
        shutil.copy(whole / name, out)

    def fail(*arguments):
        raise RuntimeError("no colours\nleft")

    monkeypatch.setattr("experiments.diagnose.write_overlay", fail)
    main(Diagnose(resume=out))
    written = {path.name for path in out.iterdir()}
    assert written >= {"diagnosis.json", "report.html", "corrected.json"}
    assert "overlay.rrd" not in written
    said = capsys.readouterr()
    assert said.err.endswith(
        "groundwalk: overlay.rrd is not written: no colours left\n"
    )
    assert "verdict" in said.out


@pytest.mark.slow
def test_what_was_there_before_is_no_finding(recording, tmp_path, capsys):
    model = recording.with_name("swing.nominal.xml")
    out = tmp_path / "run"
    main(Diagnose((recording,), str(model), reference=(recording,), out=out))
    verdict = Verdict.from_json((out / "diagnosis.json").read_text())
    assert verdict.kind == "none"
    assert "servo_gain at swing" in verdict.limits[-1]
    assert not (out / "corrected.json").exists()
    page = (out / "report.html").read_text()
    assert "since the reference recordings?" in page
    assert "Nothing has changed that these recordings could show." in page
    assert "lack" not in page[page.index("<h1>") :]
    assert "nothing has changed since the reference" in capsys.readouterr().out
    main(Diagnose(resume=out))
    assert "nothing has changed since the reference" in capsys.readouterr().out


def test_a_reference_of_another_robot_is_refused(recording, tmp_path):
    other = tmp_path / "arm.parquet"
    record(Record(robot="so101", motion="steps", duration=1.0, out=other))
    model = recording.with_name("swing.nominal.xml")
    with pytest.raises(BadRecordingError, match="joint"):
        main(Diagnose((recording,), str(model), reference=(other,)))


def test_a_model_of_no_reference_is_refused(recording):
    model = str(recording.with_name("swing.nominal.xml"))
    with pytest.raises(BadValueError, match="without a reference"):
        Diagnose((recording,), model, reference_robot=model)


def test_a_recording_of_another_robot_is_refused_and_nothing_is_written(
    recording, tmp_path
):
    with pytest.raises(BadRecordingError, match="swing"):
        main(Diagnose((recording,), "nao", out=tmp_path / "run"))
    assert not (tmp_path / "run").exists()


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"recordings": ()}, "no recording"),
        ({"kp": -1.0}, "kp must be a number from 0 up, not -1.0"),
        ({"kp": 8.0, "kd": float("inf")}, "kd must be"),
        ({"kp": 8.0, "max_torque": 0.0}, "above 0"),
        ({"kd": 1.0}, "without kp"),
        ({"seed": -1}, "at least 0"),
    ],
)
def test_impossible_questions_are_refused(recording, change, said):
    with pytest.raises(BadValueError, match=said):
        Diagnose(**{"recordings": (recording,), "robot": "nao"} | change)


def test_gains_of_the_command_line_hold_for_all_servos(recording):
    gains = Diagnose((recording,), "nao", kp=8.0).gains
    assert (gains.kp, gains.kd, gains.max_torque) == (8.0, 0.0, sys.float_info.max)
    assert Diagnose((recording,), "nao").gains is None


def test_a_type_of_servo_gives_all_gains(recording):
    gains = Diagnose((recording,), "nao", servo="mx-64@12V,P=16").gains
    assert gains.kp == pytest.approx(16 * 0.158 * 12 * 1.622 / 3.949)
    assert (gains.kd, gains.armature) == (0.0, 0.01195)
    with pytest.raises(BadValueError, match="either a servo type or kp"):
        Diagnose((recording,), "nao", servo="mx-64", kp=8.0)
    with pytest.raises(UnknownNameError, match="did you mean 'mx-64'"):
        Diagnose((recording,), "nao", servo="mx64")

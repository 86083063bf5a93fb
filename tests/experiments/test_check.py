"""`groundwalk check`: on a recording that is good, on poor ones, and on bad input."""

import csv
import json
import sys

import numpy as np
import pytest
from html_page import Page
from made_once import made_once

from diagnosis.check import evidence
from experiments.check import CheckRecordings, check_recordings, main
from experiments.record import Record
from experiments.record import main as record
from groundwalk.errors import BadRecordingError, BadValueError, RunFolderError
from worlds import read_recording


@pytest.fixture(scope="module")
def recordings(tmp_path_factory):
    """Recordings of the pendulum, lively ones and slow ones, and its model."""

    def recorded(folder):
        for motion, seed in (("multisine", 1), ("ramps", 2)):
            options = {"robot": "pendulum", "motion": motion, "duration": 8.0}
            record(Record(folder / f"{motion}.parquet", seed=seed, **options))

    return made_once(tmp_path_factory, "checked", recorded)


def checked(folder, *motions, **options):
    paths = tuple(folder / f"{motion}.parquet" for motion in motions)
    model = str(folder / "multisine.nominal.xml")
    return CheckRecordings(paths, model, **options)


@pytest.fixture(scope="module")
def found(recordings):
    return check_recordings(checked(recordings, "multisine"))


@pytest.mark.slow
def test_sizes_lie_between_noise_and_what_the_servo_can_do(found):
    assert found.usable
    torque = found.size("torque_offset@swing").told
    assert torque.unit == "N m"
    # 8 N m/rad turn 0.05 mrad, a tenth of the noise, into 0.4 mN m
    assert 4e-4 < torque.value < 0.4
    assert found.noise["position.swing"].value == pytest.approx(6e-4, rel=0.5)


KEYS = (
    *("torque_offset@swing", "coulomb_friction@swing", "viscous_friction@swing"),
    *("backlash@swing", "servo_gain@swing", "command_latency@commands"),
)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("module", "name", "value"),
    [
        (evidence, "APART", 1.5),
        (evidence, "APART", 3.0),
        (evidence, "LEAST_S", 0.5),
        (evidence, "LEAST_S", 2.0),
        (evidence, "MILDEST", 1),
        (evidence, "MILDEST", 4),
        (evidence, "POWERS", (0.25, 6.0)),
        (evidence, "POWERS", (0.7, 2.2)),
        (sys.modules["diagnosis.check.check"], "SIMULATED_S", 4.0),
        (sys.modules["diagnosis.check.check"], "SIMULATED_S", 16.0),
    ],
)
def test_a_factor_of_two_hardly_changes_sizes(
    recordings, found, monkeypatch, module, name, value
):
    """A constant is changed, or its distance from 1, or an exponent about 1."""
    monkeypatch.setattr(module, name, value)
    other = check_recordings(checked(recordings, "multisine"))
    for key in KEYS:
        size, usual = other.size(key).told.value, found.size(key).told.value
        assert size == pytest.approx(usual, rel=0.35), key


@pytest.mark.slow
def test_how_far_the_sim_is_off(recordings, found, tmp_path, capsys):
    assert found.off["position.swing"] == pytest.approx(1.0, abs=0.2)
    hidden = ("coulomb_friction@swing:torque=0.3",)
    rough = Record(
        tmp_path / "rough.parquet", robot="pendulum", duration=4.0, hidden=hidden
    )
    record(rough)
    off = check_recordings(CheckRecordings((rough.out,))).off
    assert off["position.swing"] > 10
    main(checked(recordings, "multisine"))
    assert "the sim is off by" in capsys.readouterr().out


@pytest.mark.slow
def test_more_recordings_tell_smaller_effects(recordings, found):
    both = check_recordings(checked(recordings, "multisine", "ramps"))
    key = "joint_spring@swing"
    assert both.size(key).told.value < found.size(key).told.value


def test_what_is_hidden_does_not_change_what_would_be_told(recordings, found, tmp_path):
    path = tmp_path / "rubs.parquet"
    hidden = ("viscous_friction@swing:coefficient=0.1",)
    options = {"robot": "pendulum", "motion": "multisine", "duration": 8.0}
    record(Record(path, hidden=hidden, **options))
    model = str(recordings / "multisine.nominal.xml")
    rubs = check_recordings(CheckRecordings((path,), model))
    for key in ("armature@swing", "viscous_friction@swing", "servo_damping@swing"):
        ratio = rubs.size(key).told.value / found.size(key).told.value
        assert ratio == pytest.approx(1.0, abs=0.3)


def test_proposed_motions_make_sizes_smaller(found):
    for one in found.proposed:
        for key, amount in one.sizes.items():
            now = found.size(key)
            if amount is None or now.told is None or now.below:
                continue
            assert amount.value <= 1.05 * now.told.value
    best = found.proposed[0]
    assert any(
        amount is not None
        and (told := found.size(key).told) is not None
        and amount.value < 0.8 * told.value
        for key, amount in best.sizes.items()
    )


def test_everything_is_printed_and_written(recordings, tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    main(checked(recordings, "multisine", "ramps", out=tmp_path / "run"))
    said = capsys.readouterr().out
    for words in ("multisine  8 s", "1 of 1", "dry friction", "swing", "chirp.csv"):
        assert words in said
    written = {path.name for path in (tmp_path / "run").iterdir()}
    assert written >= {"report.html", "result.md", "result.json", "next"}
    plain = json.loads((tmp_path / "run" / "result.json").read_text())
    assert plain["usable"]
    assert {one["motion"] for one in plain["next"]} >= {"chirp", "holds"}
    page = Page((tmp_path / "run" / "report.html").read_text())
    assert not page.wrong
    assert "The smallest sizes that would be told" in page.text
    rows = list(csv.reader((tmp_path / "run/next/chirp.csv").read_text().splitlines()))
    assert rows[0] == ["time", "command.swing"]
    commands = np.array(rows[1:], float)
    assert np.abs(commands[:, 1]).max() <= 3.0
    with pytest.raises(RunFolderError, match="exists already"):
        main(checked(recordings, "multisine", out=tmp_path / "run"))


def test_twins_are_told_as_one(found):
    """A late command and a late reading move a robot alike, as its servo is inside."""
    late = {"command_latency@commands", "sensor_delay@encoders"}
    (pair,) = (one for one in found.alike if {one.one, one.other} == late)
    assert "no recording" in pair.why
    assert found.size("command_latency@commands").told is not None


def test_without_out_nothing_is_written(recordings, tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    main(checked(recordings, "multisine", json=True))
    plain = json.loads(capsys.readouterr().out)
    assert plain["audit"]["traces"][0]["name"] == "multisine"
    assert list(tmp_path.iterdir()) == []


def test_a_recording_that_cannot_be_used_is_shown_and_refused(
    recordings, tmp_path, capsys
):
    whole = read_recording(recordings / "multisine.parquet")
    lines = ["time,position.swing,command.swing"]
    names = ("time", "position.swing", "command.swing")
    table = zip(*(whole.columns[name][:30].tolist() for name in names), strict=True)
    lines += [",".join(map(str, row)) for row in table]
    path = tmp_path / "short.csv"
    path.write_text("\n".join(lines) + "\n")
    about = {"format": 1, "robot": "pendulum", "base": "fixed", "source": "a test"}
    path.with_suffix(".json").write_text(json.dumps(about))
    model = str(recordings / "multisine.nominal.xml")
    with pytest.raises(BadRecordingError, match="cannot be diagnosed"):
        main(CheckRecordings((path,), model, kp=8.0, kd=0.2, max_torque=4.0))
    assert "refuse: short lasts 0.29 s" in capsys.readouterr().out
    with pytest.raises(BadRecordingError):
        main(CheckRecordings((path,), model, kp=8.0, kd=0.2, json=True))
    plain = json.loads(capsys.readouterr().out)
    assert not plain["usable"]
    assert plain["gain"] is None


@pytest.mark.parametrize(
    ("options", "says"),
    [
        ({"recordings": ()}, "no recording"),
        ({"max_speed": 0.0}, "max_speed"),
        ({"kd": 0.1}, "kp"),
        ({"threads": -1}, "threads"),
    ],
)
def test_bad_options_get_one_line(recordings, options, says):
    given = {"recordings": (recordings / "multisine.parquet",), "robot": "x.xml"}
    with pytest.raises(BadValueError, match=says):
        CheckRecordings(**(given | options))

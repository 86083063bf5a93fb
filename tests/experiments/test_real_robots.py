from dataclasses import replace

import pytest
from made_up_diagnoses import KINDS

from diagnosis.effects import all_effects
from diagnosis.verdict import ChannelFit, Estimate, Found, Pulse, Recordings
from experiments import real_robots
from experiments.diagnosis_report.console import console_lines
from experiments.diagnosis_report.text import answer
from experiments.real_robot_study.cases import ROBOTS, Published, RealRobot, Sane
from experiments.real_robot_study.page import (
    claims_of,
    number_of_values,
    write_real_page,
)
from experiments.real_robots import RealRobots, main
from experiments.runs.folder import RunFolder
from groundwalk.errors import BadValueError

KNOWN = Published("viscous_friction", "coefficient", 3.0, "oil")
ROBOT = RealRobot("A robot", "folder", "nao", "there", "about it", published=(KNOWN,))


def pulse(k=0, source="actuator input"):
    jumps = {"torque": 0.98, "position": 0.01, "command": 0.0}
    if source == "position sensor":
        jumps = {"torque": 0.01, "position": 0.97, "command": 0.0}
    return Pulse("run", "slide", k, k + 0.5, 6.0, "N m", source, jumps, 0.99)


def oil(low, high):
    value = Estimate((low + high) / 2, low, high, "N m s/rad")
    return Found("viscous_friction", "LKneePitch", {"coefficient": value}, 0.9)


def verdict(**changes):
    return replace(KINDS["effects"], **changes)


@pytest.mark.parametrize(
    ("found", "holds"), [(oil(2.0, 4.0), True), (oil(3.1, 4.0), False)]
)
def test_published_values_are_looked_for_in_the_intervals(found, holds):
    (claim,) = claims_of(ROBOT, verdict(effects=(found,)))
    assert claim.holds is holds
    (claim,) = claims_of(ROBOT, verdict())
    assert (claim.holds, claim.found) == (False, "not found")


@pytest.mark.parametrize(("torque_nm", "holds"), [(20.0, True), (25.0, False)])
def test_what_was_published_may_be_a_part_of_what_is_found(torque_nm, holds):
    """Dry friction that varies over the range is dry friction in its middle."""
    dry = Published("coulomb_friction", "torque", 20.4, "dry friction")
    torque = Estimate(torque_nm, torque_nm - 1, torque_nm + 1, "N m")
    parameters = {"torque": torque, "factor": Estimate(0.6, 0.5, 0.7, "1/rad")}
    found = Found("angle_friction", "LKneePitch", parameters, 0.9)
    robot = replace(ROBOT, published=(dry, KNOWN))
    claims = claims_of(robot, verdict(effects=(found,)))
    assert [one.holds for one in claims] == [holds, False]


@pytest.mark.parametrize(
    ("pulses", "holds"),
    [
        ((pulse(0), pulse(1)), True),
        ((pulse(0),), False),
        ((pulse(0), pulse(1, "torque sensor")), False),
        ((pulse(0), pulse(1), pulse(2)), False),
        ((), False),
    ],
)
def test_all_pulses_must_be_found_at_the_actuator(pulses, holds):
    robot = replace(ROBOT, published=(), pulses=2)
    (claim,) = claims_of(robot, verdict(pulses=pulses))
    assert claim.holds is holds


@pytest.mark.parametrize(
    ("times", "holds"), [((2.1, 9.0), True), ((2.1, 1.9), False), ((1.9, 9.0), False)]
)
def test_twice_as_well_is_twice_as_well_at_every_joint(times, holds):
    fit = verdict().fit
    channels = {
        f"position.{k}": ChannelFit(
            nominal=1.0, corrected=1 / ratio, floor=0.01, unit="rad"
        )
        for k, ratio in enumerate(times)
    }
    fit = replace(fit, channels=channels)
    robot = replace(ROBOT, published=(), twice=True)
    (claim,) = claims_of(robot, verdict(fit=fit))
    assert claim.holds is holds


def test_impossible_values_are_told():
    fit = replace(verdict().fit, channels={})
    sane = {"viscous_friction.coefficient": Sane(0.0, 1.0, "hand-made")}
    robot = replace(ROBOT, published=(), sane=sane)
    (right,) = claims_of(robot, verdict(effects=(oil(0.4, 0.6),), fit=fit))
    (wrong,) = claims_of(robot, verdict(effects=(oil(1.4, 1.6),), fit=fit))
    assert (right.holds, wrong.holds) == (True, False)
    assert wrong.found == "viscous_friction@LKneePitch 1.5"


def test_values_that_places_share_count_once():
    gain = Found("servo_gain", "a", {"factor": Estimate(0.9, 0.8, 1.0, "1")}, 0.9)
    other = replace(gain, place="b", shared_with=("a",))
    assert number_of_values((replace(gain, shared_with=("b",)), other)) == 1
    assert number_of_values((gain, replace(gain, place="b"), oil(1, 2))) == 3


def test_joints_at_which_nothing_is_named_are_told():
    robot = replace(ROBOT, published=(), sane={})
    assert claims_of(robot, verdict()) == []
    robot = replace(robot, sane={"backlash.gap": Sane(0.0, 1.0, "hand-made")})
    (claim,) = claims_of(robot, verdict())
    assert not claim.holds
    assert "nothing at LHipRoll" in claim.found


@pytest.mark.parametrize("kind", KINDS)
def test_the_page_tells_all(kind, tmp_path):
    shown = replace(KINDS[kind], pulses=(pulse(0), pulse(1)))
    folder = RunFolder.create("diagnose", RealRobots("emps", out=tmp_path / "run"))
    write_real_page(folder, replace(ROBOT, pulses=2), shown)
    page = (tmp_path / "run" / "result.md").read_text()
    assert page.startswith("# A robot\n")
    assert "| run | slide | 1.000 | 1.500 | 6.0 N m | actuator input |" in page
    for effect in shown.effects:
        assert f"| {effect.place} | {effect.name} |" in page
    for limit in shown.limits:
        assert limit in page


def page_of(shown, tmp_path, name):
    folder = RunFolder.create("diagnose", RealRobots("emps", out=tmp_path / name))
    write_real_page(folder, ROBOT, shown)
    return (tmp_path / name / "result.md").read_text()


def test_the_page_tells_what_is_left(tmp_path):
    fit = verdict().fit
    much = replace(fit, corrected=7.0 * fit.floor, ceiling=3.0 * fit.floor)
    shown = verdict(effects=(oil(-0.1, 0.3),), fit=much)
    page = page_of(shown, tmp_path, "much")
    assert "7.0 times the noise is left, and a regression without physics" in page
    assert "may be nothing: viscous_friction at LKneePitch" in page
    little = replace(fit, corrected=1.1 * fit.floor)
    page = page_of(verdict(effects=(oil(0.1, 0.3),), fit=little), tmp_path, "little")
    assert "times the noise is left" not in page
    assert "may be nothing" not in page


def test_parts_of_the_same_recording_are_a_doubt(tmp_path):
    fit = replace(verdict().fit, corrected=7.0 * verdict().fit.floor)
    same = Recordings(("a[0-2 s]",), ("a[2-3 s]",), ("a[3-4 s]",))
    other = replace(same, test=("b",))
    said = "parts of recordings that were fitted"
    assert said in page_of(verdict(fit=fit, recordings=same), tmp_path, "same")
    assert said not in page_of(verdict(fit=fit, recordings=other), tmp_path, "other")


@pytest.mark.parametrize(
    ("source", "said"),
    [
        ("actuator input", "came in at the input of the actuator"),
        ("torque sensor", "never felt them"),
        ("position sensor", "97 % of their edges are in the measured position"),
    ],
)
def test_reports_say_where_pulses_came_in(source, said):
    shown = verdict(pulses=(pulse(0, source), pulse(1, source)))
    (sentence,) = (text for text in answer(shown) if "pulses of 6 N m" in text)
    assert said in sentence
    assert "every 1 s" in sentence
    assert not any("pulse" in text for text in answer(verdict()))


def test_the_console_stays_short():
    alike = tuple(oil(k, k + 1.0) for k in range(20))
    told = [text for label, text in console_lines(verdict(effects=alike), []) if label]
    assert sum("viscous friction at 20 places" in text for text in told) == 1
    names = [*all_effects()][:20]
    many = tuple(
        replace(one, name=name) for one, name in zip(alike, names, strict=True)
    )
    lines = console_lines(verdict(effects=many), [])
    assert len(lines) <= 10
    assert ("", "and 18 more: the report has them all") in lines


def test_the_report_is_the_one_that_judges(tmp_path, monkeypatch, capsys):
    """The report of the diagnosis is kept under another name."""

    def diagnosed(config):
        folder = RunFolder.create("diagnose", config)
        folder.write_text("report.html", "the diagnosis' own")
        return folder, verdict()

    monkeypatch.setattr(real_robots, "run_diagnosis", diagnosed)
    recordings = tmp_path / ROBOTS["emps"].folder
    recordings.mkdir()
    (recordings / "one.parquet").touch()
    main(RealRobots("emps", data=tmp_path, out=tmp_path / "run"))
    told = capsys.readouterr().out
    assert ROBOTS["emps"].title in (tmp_path / "run" / "report.html").read_text()
    assert (tmp_path / "run" / "diagnosis.html").read_text() == "the diagnosis' own"
    assert "report.html" in told
    assert "diagnosis.html" in told


@pytest.mark.parametrize("name", ROBOTS)
def test_without_recordings_nothing_is_done(name, tmp_path):
    with pytest.raises(BadValueError, match="has no recordings"):
        main(RealRobots(name, data=tmp_path, out=tmp_path / "run"))
    assert not (tmp_path / "run").exists()

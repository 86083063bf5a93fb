"""CSV tables: what is guessed from names and values, and what a user says."""

import math

import numpy as np
import pytest

from groundwalk.errors import ForeignFileError, GroundwalkError, UnknownNameError
from worlds.foreign.column_names import meaning
from worlds.foreign.mapping import apply, plan, unused
from worlds.foreign.tables import read_table

DEG = math.pi / 180


def table(path, text):
    path.write_text(text)
    return read_table(path)


def columns(path, text, *said):
    read = table(path / "log.csv", text)
    return dict(apply(read, plan(read, said)).columns)


@pytest.mark.parametrize(
    ("name", "column", "unit"),
    [
        ("time", "time", ""),
        ("t_ms", "time", "ms"),
        ("Time [s]", "time", "s"),
        ("timestamp(us)", "time", "us"),
        ("stamp_ns", "time", "ns"),
        ("position.elbow", "position.elbow", ""),
        ("q0", "position.0", ""),
        ("q[3]", "position.3", ""),
        ("joint_pos_elbow", "position.elbow", ""),
        ("elbow_pos_deg", "position.elbow", "deg"),
        ("shoulder_pan.pos", "position.shoulder_pan", ""),
        ("LKneePitch_cmd", "command.LKneePitch", ""),
        ("q_des_3 [rad]", "command.3", "rad"),
        ("action_elbow", "command.elbow", ""),
        ("goal_position_2", "command.2", ""),
        ("dq3", "velocity.3", ""),
        ("qd_1", "velocity.1", ""),
        ("elbow vel (deg/s)", "velocity.elbow", "deg/s"),
        ("elbow_vel_deg_s", "velocity.elbow", "deg/s"),
        ("tau_0_mNm", "torque.0", "mNm"),
        ("effort3 [N m]", "torque.3", "Nm"),
        ("tau_cmd_1", "command_torque.1", ""),
    ],
)
def test_names_that_say_something(name, column, unit):
    found = meaning(name)
    assert (found.column, found.unit) == (column, unit)


@pytest.mark.parametrize(
    "name", ["temperature", "motor_current", "joint_1", "time_left"]
)
def test_names_that_say_nothing(name):
    assert meaning(name) is None


def test_units_in_names(tmp_path):
    text = "t_ms,q_deg,cmd_deg,dq_deg_s,tau_mNm\n0,10,20,5,300\n10,40,20,5,300\n"
    found = columns(tmp_path, text)
    np.testing.assert_allclose(found["time"], [0, 0.01])
    np.testing.assert_allclose(found["position.joint"], [10 * DEG, 40 * DEG])
    np.testing.assert_allclose(found["command.joint"], [20 * DEG] * 2)
    np.testing.assert_allclose(found["velocity.joint"], [5 * DEG] * 2)
    np.testing.assert_allclose(found["torque.joint"], [0.3] * 2)


@pytest.mark.parametrize(
    ("step", "unit"), [(0.005, "s"), (5, "ms"), (5_000, "us"), (5_000_000, "ns")]
)
def test_the_unit_of_times_shows_in_their_steps(tmp_path, step, unit):
    rows = "\n".join(f"{k * step},{k / 10},0" for k in range(4))
    read = table(tmp_path / "log.csv", f"t,q1,cmd1\n{rows}\n")
    entries = plan(read)
    assert entries[0].unit == unit
    assert all(one.guessed for one in entries)
    np.testing.assert_allclose(apply(read, entries).columns["time"][1], 0.005)


def test_steps_that_no_recording_has_leave_the_unit_open(tmp_path):
    text = "t,q1,cmd1\n0,0,0\n1e-5,0,0\n"
    with pytest.raises(ForeignFileError, match=r"--map time=t\*s"):
        columns(tmp_path, text)
    assert columns(tmp_path, text, "time=t*s")["time"].tolist() == [0, 1e-5]


def test_large_angles_without_a_unit_are_refused(tmp_path):
    text = "t_s,q1,cmd1\n0,90,0\n1,0,0\n"
    with pytest.raises(ForeignFileError, match=r"reaches 90.*position.1=q1\*deg"):
        columns(tmp_path, text)
    found = columns(tmp_path, text, "position.1=q1*deg")
    assert found["position.1"][0] == pytest.approx(math.pi / 2)
    small = columns(tmp_path, text.replace("90", "3"))
    assert small["position.1"][0] == 3.0


def test_a_unit_that_one_column_has_is_that_of_the_joint(tmp_path):
    found = columns(tmp_path, "t_s,q1_deg,cmd1,dq1\n0,90,45,9\n1,0,0,0\n")
    assert found["command.1"][0] == pytest.approx(math.pi / 4)
    assert found["velocity.1"][0] == pytest.approx(9 * DEG)


def test_what_the_user_says_counts(tmp_path):
    text = "zeit,winkel,soll,t,q1\n0,90,45,5,6\n10,90,45,5,6\n"
    said = (
        "time=zeit*ms",
        "position.arm=winkel*deg",
        "command.arm=soll*deg",
        "position.1=none",
    )
    read = table(tmp_path / "log.csv", text)
    entries = plan(read, said)
    assert not any(one.guessed for one in entries)
    assert unused(read, entries) == ("t", "q1")
    found = apply(read, entries).columns
    assert list(found) == ["time", "position.arm", "command.arm"]
    np.testing.assert_allclose(found["position.arm"], math.pi / 2)


@pytest.mark.parametrize(
    ("header", "words"),
    [
        ("q1,cmd1", "--map time=COLUMN"),
        ("t_s,cmd1", "--map position.JOINT=COLUMN"),
        ("t_s,q1", "--map command.JOINT=COLUMN"),
        ("t_s,q1,pos1,cmd1", "--map position.1=pos1"),
        ("t_s,q1,q_d_1,cmd1", "desired q"),
        ("t_s,q1,cmd0", "--map command.1=cmd0"),
        ("t_s,stamp,q1,cmd1", "--map time=stamp"),
    ],
)
def test_what_is_ambiguous_says_what_to_give(tmp_path, header, words):
    zeros = ",".join("0" for _ in header.split(","))
    with pytest.raises(ForeignFileError) as caught:
        columns(tmp_path, f"{header}\n{zeros}\n")
    assert words in str(caught.value)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    ("said", "words"),
    [
        ("position.1", "must be like"),
        ("positon.1=q1", "did you mean 'position.1'"),
        ("position.1=q2", "did you mean 'q1'"),
        ("position.1=q1*dog", "did you mean 'deg'"),
        ("time=q1*deg", "known are ms, ns, s, us"),
    ],
)
def test_entries_that_are_wrong(tmp_path, said, words):
    with pytest.raises(GroundwalkError, match=words):
        columns(tmp_path, "t_s,q1,cmd1\n0,0,0\n", said)


def test_semicolons_and_decimal_commas(tmp_path):
    found = columns(tmp_path, "t_s;q1;cmd1\n0,0;0,5;1\n0,01;0,25;\n")
    assert found["position.1"].tolist() == [0.5, 0.25]
    assert found["command.1"][0] == 1.0
    assert np.isnan(found["command.1"][1])


def test_rows_of_one_time_become_one(tmp_path):
    found = columns(tmp_path, "t_s,q1,cmd1\n0,1,0\n0,2,0\n1,3,0\n")
    assert found["position.1"].tolist() == [1.0, 3.0]


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("", "first line"),
        ("t_s,q1,cmd1\n", "no row"),
        ("1,2,3\n4,5,6\n", "holds numbers"),
        ("t_s,q1,q1\n0,0,0\n", "two columns"),
        ("t_s,q1,cmd1\n0,0,0\n0,0\n", "row 1 .* 2 cells"),
        ("t_s,q1,cmd1\n0,0,0\n0.1,off,0\n", "'q1', row 1 .*'off'"),
    ],
)
def test_damaged_tables(tmp_path, text, words):
    with pytest.raises(ForeignFileError, match=words):
        columns(tmp_path, text)


def test_a_table_that_is_not_there(tmp_path):
    with pytest.raises(ForeignFileError, match="no such file"):
        read_table(tmp_path / "none.csv")
    read = table(tmp_path / "log.csv", "t_s,q1,cmd1\n0,0,0\n")
    with pytest.raises(UnknownNameError, match="did you mean 'q1'"):
        read.numbers("q")

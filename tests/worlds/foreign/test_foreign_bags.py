"""ROS 2 bags: files that rosbags writes, one put together by hand, and real ones."""

import sqlite3
from pathlib import Path

import numpy as np
import pytest
from foreign_files import (
    MS,
    joint_state,
    numbers,
    states,
    trajectory,
    write_bag,
)

from groundwalk.errors import ForeignFileError, UnknownNameError
from worlds.foreign import BagOptions, read_bag

BAGS = Path(__file__).parents[3] / ".." / "shared" / "data" / "bags"

COMMANDS = [
    ("/targets", 5 * MS, joint_state(0, ["knee", "hip"], [0.5, 0.25])),
    ("/targets", 20 * MS, joint_state(0, ["hip", "knee"], [1.0, 2.0])),
]
TARGETS = BagOptions(command_topic="/targets")


@pytest.mark.parametrize("mcap", [False, True])
@pytest.mark.parametrize("folder", [False, True])
def test_positions_and_torques_of_the_only_topic(tmp_path, mcap, folder):
    messages = states(effort=[(0.5 * k, 7) for k in range(5)])
    file = write_bag(tmp_path / "arm", messages, mcap)
    found = read_bag(tmp_path / "arm" if folder else file)
    assert found.joints == ("hip", "knee")
    np.testing.assert_array_equal(found.columns["time"], np.arange(5) * 10 * MS * 1e-9)
    np.testing.assert_array_equal(found.columns["position.knee"], -np.arange(5.0))
    np.testing.assert_array_equal(found.columns["torque.hip"], 0.5 * np.arange(5))
    assert not any(name.startswith("velocity") for name in found.columns)


def test_a_command_holds_from_its_arrival_on(tmp_path):
    """Rows at 0, 10, 20 ... ms; commands at 5 and at 20 ms, in their own order."""
    path = write_bag(tmp_path / "arm", [*states(), *COMMANDS])
    found = read_bag(path, TARGETS)
    assert found.columns["command.hip"].tolist()[1:] == [0.25, 1.0, 1.0, 1.0]
    assert found.columns["command.knee"].tolist()[1:] == [0.5, 2.0, 2.0, 2.0]
    assert np.isnan(found.columns["command.hip"][0])
    assert any("/targets" in note for note in found.notes)


def test_commands_get_onto_the_clock_of_the_headers(tmp_path):
    """The recorder's clock is 7 s ahead: so are the times at which commands arrive."""
    late = 7_000 * MS
    commands = [(topic, at + late, message) for topic, at, message in COMMANDS]
    path = write_bag(tmp_path / "arm", [*states(lag_ns=late), *commands])
    found = read_bag(path, TARGETS)
    assert found.columns["time"][1] == pytest.approx(0.01)
    assert found.columns["command.hip"].tolist()[1:] == [0.25, 1.0, 1.0, 1.0]


def test_times_since_1970_are_counted_from_the_first_row(tmp_path):
    messages = states(start_ns=1_700_000_000_123_456_789, effort=[(1, 1)] * 5)
    found = read_bag(write_bag(tmp_path / "arm", messages))
    np.testing.assert_array_equal(found.columns["time"], np.arange(5) * 10 * MS * 1e-9)


@pytest.mark.parametrize(
    ("stamps_ns", "words"),
    [
        ([0, 0, 0, 0], "are 0"),
        ([MS, 3 * MS, 2 * MS, 30 * MS], "go back"),
        ([MS, 2 * MS, 3 * MS, 4 * MS], "span"),
    ],
)
def test_useless_stamps_are_not_used(tmp_path, stamps_ns, words):
    messages = [
        ("/s", 10 * k * MS, joint_state(stamp, ["a"], [k], [], [1.0]))
        for k, stamp in enumerate(stamps_ns)
    ]
    path = write_bag(tmp_path / "arm", messages)
    found = read_bag(path)
    np.testing.assert_array_equal(found.columns["time"], np.arange(4) * 10 * MS * 1e-9)
    assert words in found.notes[0]
    with pytest.raises(ForeignFileError, match=words):
        read_bag(path, BagOptions(clock="header"))


def test_a_row_a_time(tmp_path):
    messages = states(effort=[(1, 1)] * 5)
    twice = ("/joint_states", 21 * MS, joint_state(20 * MS, ["hip", "knee"], [9, 9]))
    found = read_bag(write_bag(tmp_path / "arm", [*messages, twice]))
    assert found.columns["position.hip"].tolist() == [0, 1, 2, 3, 4]
    assert "1 rows" in " ".join(found.notes)


def test_numbers_without_names_need_names(tmp_path):
    messages = [*states(), ("/forward/commands", 0, numbers([0.5, 0.25]))]
    path = write_bag(tmp_path / "arm", messages)
    with pytest.raises(ForeignFileError, match="--joints"):
        read_bag(path)
    found = read_bag(path, BagOptions(joints=("knee", "hip")))
    assert found.columns["command.knee"].tolist() == [0.5] * 5
    with pytest.raises(ForeignFileError, match="did you mean 'knee'"):
        read_bag(path, BagOptions(joints=("kne", "hip")))


def test_trajectories_of_one_point_are_commands(tmp_path):
    path = write_bag(
        tmp_path / "a", [*states(), ("/t", 0, trajectory(0, ["hip"], [2]))]
    )
    found = read_bag(path)
    assert found.columns["command.hip"].tolist() == [2.0] * 5
    assert "command.knee" not in found.columns
    two = [*states(), ("/t", 0, trajectory(0, ["hip"], [2], [3]))]
    with pytest.raises(ForeignFileError, match="2 points"):
        read_bag(write_bag(tmp_path / "b", two))


def test_targets_that_are_efforts_are_torque_targets(tmp_path):
    wanted = ("/w", 0, joint_state(0, ["hip"], effort=[3.0]))
    found = read_bag(
        write_bag(tmp_path / "arm", [*states(), wanted]),
        BagOptions(state_topic="/joint_states"),
    )
    assert found.columns["command_torque.hip"].tolist() == [3.0] * 5


def test_torques_of_another_topic_are_interpolated(tmp_path):
    torques = [("/torques", k * 20 * MS, numbers([2.0 * k, 0.0])) for k in range(3)]
    options = BagOptions(effort_topic="/torques", joints=("hip", "knee"))
    found = read_bag(write_bag(tmp_path / "arm", [*states(), *torques]), options)
    assert found.columns["torque.hip"].tolist() == [0.0, 1.0, 2.0, 3.0, 4.0]


def test_several_topics_must_be_told_apart(tmp_path):
    third = ("/other", 0, joint_state(0, ["hip"], [0.0]))
    path = write_bag(tmp_path / "arm", [*states(), *COMMANDS, third])
    with pytest.raises(ForeignFileError, match="--state-topic"):
        read_bag(path)
    with pytest.raises(ForeignFileError, match="--command-topic"):
        read_bag(path, BagOptions(state_topic="/joint_states"))
    told = BagOptions(state_topic="/joint_states", command_topic="/targets")
    assert read_bag(path, told).columns["command.hip"][-1] == 1.0
    with pytest.raises(UnknownNameError, match="did you mean '/targets'"):
        read_bag(path, BagOptions(state_topic="/joint_states", command_topic="/target"))


def test_what_no_recording_can_be_made_of(tmp_path):
    with pytest.raises(ForeignFileError, match="what drove"):
        read_bag(write_bag(tmp_path / "undriven", states(effort=[(0, 0)] * 5)))
    with pytest.raises(ForeignFileError, match="no topic"):
        read_bag(write_bag(tmp_path / "stateless", [("/n", 0, numbers([1.0]))]))
    other = ("/joint_states", 60 * MS, joint_state(60 * MS, ["claw"], [0.0]))
    with pytest.raises(ForeignFileError, match="claw"):
        read_bag(write_bag(tmp_path / "two_sets", [*states(), other]))


@pytest.mark.parametrize("mcap", [False, True])
@pytest.mark.parametrize("kept", [0.0, 0.3, 0.9])
def test_a_damaged_bag_gives_one_line(tmp_path, mcap, kept):
    messages = states(rows=400, effort=[(1, 1)] * 400)
    path = write_bag(tmp_path / "arm", messages, mcap)
    content = path.read_bytes()
    path.write_bytes(content[: int(kept * len(content))])
    with pytest.raises(ForeignFileError) as caught:
        read_bag(path)
    assert str(path) in str(caught.value)
    assert "\n" not in str(caught.value)
    assert ("mcap recover" in str(caught.value)) == (mcap and kept > 0)


def test_rows_that_are_not_in_the_database_yet(tmp_path):
    path = write_bag(tmp_path / "arm", states(effort=[(1, 1)] * 5))
    beside = path.with_name(f"{path.name}-wal")
    beside.write_bytes(b"")
    assert read_bag(path).joints == ("hip", "knee")
    beside.write_bytes(b"rows")
    for one in (path, path.parent):
        with pytest.raises(ForeignFileError, match="wal_checkpoint"):
            read_bag(one)


def by_hand():
    """One message, its bytes put together by hand after the standard (XCDR 1)."""
    texts = b"\x04\x00\x00\x00hip\x00\x05\x00\x00\x00knee\x00"
    return (
        b"\x00\x01\x00\x00"  # little-endian
        + b"\x01\x00\x00\x00\x02\x00\x00\x00"  # stamp
        + b"\x02\x00\x00\x00a\x00"  # frame, ends at byte 14 of the payload
        + b"\x00\x00\x02\x00\x00\x00"  # aligned to 4; two names
        + texts  # ends at byte 37
        + b"\x00\x00\x00\x02\x00\x00\x00"  # aligned to 4: 40; two positions
        + b"\x00\x00\x00\x00"  # aligned to 8: 48
        + np.array([1.5, -2.0]).tobytes()
        + b"\x00\x00\x00\x00"  # no velocities
        + b"\x02\x00\x00\x00"  # two efforts, at byte 72
        + np.array([0.25, 4.0]).tobytes()
    )


def bare_database(path, content):
    """A database as early ROS 2 wrote it, with one message and nothing beside it."""
    with sqlite3.connect(path) as bag:
        bag.execute(
            "create table topics (id integer primary key, name text, type text, "
            "serialization_format text)"
        )
        bag.execute(
            "create table messages (id integer primary key, topic_id integer, "
            "timestamp integer, data blob)"
        )
        kind = "sensor_msgs/msg/JointState"
        bag.execute("insert into topics values (1, '/s', ?, 'cdr')", [kind])
        bag.execute("insert into messages values (1, 1, 12, ?)", [content])
    bag.close()
    return path


def test_a_message_by_hand_in_a_bare_database(tmp_path):
    found = read_bag(bare_database(tmp_path / "bare.db3", by_hand()))
    assert found.columns["time"] == pytest.approx([1.000000002], rel=1e-15)
    assert found.columns["position.hip"].tolist() == [1.5]
    assert found.columns["position.knee"].tolist() == [-2.0]
    assert found.columns["torque.knee"].tolist() == [4.0]


def test_a_cut_message_is_named(tmp_path):
    path = bare_database(tmp_path / "bare.db3", by_hand()[:60])
    with pytest.raises(ForeignFileError, match=r"message 0 of /s is damaged"):
        read_bag(path)


@pytest.mark.skipif(not BAGS.is_dir(), reason="no real bags in ../shared/data")
@pytest.mark.parametrize(
    ("name", "joints", "rows"), [("ur10_exciting", 6, 3441), ("panda_exciting", 7, 727)]
)
def test_real_bags(name, joints, rows):
    path = BAGS / f"{name}.db3"
    found = read_bag(path)
    with sqlite3.connect(f"file:{path}?mode=ro&immutable=1", uri=True) as bag:
        stamps = bag.execute("select distinct timestamp from messages").fetchall()
    bag.close()
    assert len(found.joints) == joints
    assert len(stamps) == rows
    np.testing.assert_array_equal(
        found.columns["time"], np.sort(stamps, 0)[:, 0] * 1e-9
    )
    for quantity in ("position", "velocity", "torque"):
        columns = [found.columns[f"{quantity}.{joint}"] for joint in found.joints]
        assert np.isfinite(columns).all()

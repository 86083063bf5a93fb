"""Reads joint messages out of ROS 2 bags (.db3, .mcap, folders), without ROS."""

from collections.abc import Callable, Iterable, Mapping
from contextlib import AbstractContextManager
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TypeVar

import numpy as np
import numpy.typing as npt
from rosbags.interfaces import Connection
from rosbags.rosbag2 import Reader
from rosbags.typesys import Stores, get_typestore

from groundwalk.arrays import FloatArray
from groundwalk.errors import ForeignFileError, UnknownNameError

JOINT_STATE = "sensor_msgs/msg/JointState"
NUMBERS = "std_msgs/msg/Float64MultiArray"
TRAJECTORY = "trajectory_msgs/msg/JointTrajectory"

StampArray = npt.NDArray[np.int64]
"""Times [ns] in whole numbers."""


@dataclass(frozen=True)
class Topic:
    """A topic of a bag: its name, its type of message, and how many there are."""

    name: str
    kind: str
    messages: int


@dataclass(frozen=True, eq=False)
class JointMessages:
    """The m messages of one topic about n joints, in the order of their arrival.

    Attributes:
      topic: where they come from.
      received_ns: (m,) when the recorder received them.
      stamp_ns: (m,) time stamps of their headers; None if they have no header.
      joints: names, in the order of the first message; () if they carry no names.
      values: (m, n) by quantity, "position", "velocity" and "effort"; those that no
        message fills are left out. NaN where one message lacks what others have.
    """

    topic: Topic
    received_ns: StampArray
    stamp_ns: StampArray | None
    joints: tuple[str, ...]
    values: Mapping[str, FloatArray]


@dataclass(frozen=True)
class _One:
    """What a message says: its stamp [ns], names of joints, numbers by quantity."""

    stamp_ns: int | None
    joints: tuple[str, ...]
    numbers: Mapping[str, FloatArray]


def bag_topics(path: Path) -> tuple[Topic, ...]:
    """The topics of a bag that hold messages of a kind that is read here.

    Args:
      path: a .db3 or .mcap file, or a bag's folder.

    Raises:
      ForeignFileError: it is no bag, or damaged.
    """

    def topics(bag: Reader) -> tuple[Topic, ...]:
        counts: dict[tuple[str, str], int] = {}
        for one in bag.connections:
            key = (one.topic, one.msgtype)
            counts[key] = counts.get(key, 0) + one.msgcount
        return tuple(
            Topic(name, kind, count)
            for (name, kind), count in sorted(counts.items())
            if kind in _READERS and count
        )

    return _inside(path, topics)


def read_topic(path: Path, topic: Topic) -> JointMessages:
    """Read all messages of a topic.

    Raises:
      ForeignFileError: the bag is damaged, or its messages are not of the same joints.
    """

    def read(bag: Reader) -> JointMessages:
        ours = [one for one in bag.connections if _is_of(one, topic)]
        return _collected(path, topic, bag.messages(ours))

    return _inside(path, read)


Found = TypeVar("Found")


def _is_of(connection: Connection, topic: Topic) -> bool:
    return (connection.topic, connection.msgtype) == (topic.name, topic.kind)


def _inside(path: Path, work: Callable[[Reader], "Found"]) -> "Found":
    """Open a bag and do `work` with it; whatever is wrong becomes one line."""
    _refuse_unwritten(path)
    try:
        bag: AbstractContextManager[Reader] = Reader(path)
        with bag as opened:
            return work(opened)
    except ForeignFileError:
        raise
    except Exception as error:
        # The library lets errors of every kind through when bytes are missing.
        reason = str(error).partition("\n")[0] or type(error).__name__
        ended = "magic" not in reason and "footer" not in reason
        hint = "" if ended else "; `mcap recover` repairs files whose end is missing"
        raise ForeignFileError(
            f"{path}: cannot be read as a ROS 2 bag: {reason.rstrip('.')}{hint}"
        ) from error


def _refuse_unwritten(path: Path) -> None:
    """Refuse a database whose last rows are still in the file that SQLite keeps beside.

    They would silently be missing.
    """
    for file in path.glob("*.db3") if path.is_dir() else [path]:
        beside = file.with_name(f"{file.name}-wal")
        if beside.is_file() and beside.stat().st_size:
            raise ForeignFileError(
                f"{file}: rows of it are still in {beside.name}; write them into it "
                f"with sqlite3 {file.name} 'pragma wal_checkpoint(truncate)'"
            )


def _collected(
    path: Path, topic: Topic, messages: Iterable[tuple[Connection, int, bytes]]
) -> JointMessages:
    store = get_typestore(Stores.LATEST)
    received, read = [], []
    in_order = sorted(messages, key=lambda message: message[1])
    for row, (_, stamp_ns, content) in enumerate(in_order):
        try:
            message = store.deserialize_cdr(content, topic.kind)
            read.append(_READERS[topic.kind](message))
        except ForeignFileError as error:
            raise ForeignFileError(
                f"{path}, message {row} of {topic.name}: {error}"
            ) from error
        except Exception as error:
            raise ForeignFileError(
                f"{path}: message {row} of {topic.name} is damaged"
            ) from error
        received.append(stamp_ns)
    joints = read[0].joints
    stamps = [one.stamp_ns for one in read if one.stamp_ns is not None]
    where = f"{path}, {topic.name}"
    return JointMessages(
        topic,
        np.array(received, np.int64),
        np.array(stamps, np.int64) if len(stamps) == len(read) else None,
        joints,
        _stacked(where, joints, read),
    )


def _stacked(
    where: str, joints: tuple[str, ...], read: list[_One]
) -> dict[str, FloatArray]:
    """(m, n) by quantity, of m messages, with the joints in the first one's order."""
    orders = {joints: list(range(len(joints)))}
    for row, one in enumerate(read):
        if one.joints not in orders:
            if sorted(one.joints) != sorted(joints):
                raise ForeignFileError(
                    f"{where}: message 0 is of {_listed(joints)}, message {row} of "
                    f"{_listed(one.joints)}; only one set of joints a topic is read"
                )
            orders[one.joints] = [one.joints.index(joint) for joint in joints]
    return {
        quantity: values
        for quantity in ("position", "velocity", "effort")
        if (values := _rows(where, quantity, read, orders)) is not None
    }


def _rows(
    where: str, quantity: str, read: list[_One], orders: Mapping[Any, list[int]]
) -> FloatArray | None:
    sizes = [
        one.numbers[quantity].size if quantity in one.numbers else 0 for one in read
    ]
    count = len(read[0].joints) or max(sizes)
    if not any(sizes):
        return None
    rows = np.full((len(read), count), np.nan)
    for row, (one, size) in enumerate(zip(read, sizes, strict=True)):
        if size == count:
            order = orders[one.joints]
            rows[row] = one.numbers[quantity][order or slice(None)]
        elif size:
            raise ForeignFileError(
                f"{where}: message {row} has {size} numbers of {quantity} for "
                f"{count} joints"
            )
    return rows


def _listed(joints: tuple[str, ...]) -> str:
    return ", ".join(joints) or "no joints"


def _joint_state(message: Any) -> _One:
    numbers = {
        "position": message.position,
        "velocity": message.velocity,
        "effort": message.effort,
    }
    return _One(_stamp_ns(message), tuple(message.name), numbers)


def _numbers(message: Any) -> _One:
    return _One(None, (), {"position": message.data})


def _trajectory(message: Any) -> _One:
    """A trajectory of one point; a controller would go through more in its own way."""
    if len(message.points) != 1:
        raise ForeignFileError(
            f"it has {len(message.points)} points; only trajectories of one point are "
            "commands that hold"
        )
    (point,) = message.points
    numbers = {"position": point.positions, "effort": point.effort}
    return _One(_stamp_ns(message), tuple(message.joint_names), numbers)


def _stamp_ns(message: Any) -> int:
    stamp = message.header.stamp
    return int(stamp.sec) * 1_000_000_000 + int(stamp.nanosec)


_READERS: Mapping[str, Callable[[Any], _One]] = {
    JOINT_STATE: _joint_state,
    NUMBERS: _numbers,
    TRAJECTORY: _trajectory,
}


def find_topic(name: str, topics: Iterable[Topic], kind: str) -> Topic:
    """The topic of a name; UnknownNameError, which lists the others, if it lacks."""
    known = {topic.name: topic for topic in topics}
    if name not in known:
        raise UnknownNameError(f"{kind} topic", name, known)
    return known[name]

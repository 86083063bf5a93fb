"""Reads the joint states of ROS 2 bags that are SQLite files, without ROS."""

import sqlite3
import struct

import numpy as np

from diagnosis.plant.plant import Plant
from diagnosis.traces.trace import Trace

NANOSECOND = 1e-9
HEADER_BYTES = 4
"""Bytes at the start of a message that name its encoding; alignment counts from their
end."""


class _Message:
    """One message in little-endian CDR, read from its beginning."""

    def __init__(self, content: bytes):
        self._content, self._at = content, HEADER_BYTES

    def number(self):
        """An unsigned number of four bytes."""
        self._align(4)
        (value,) = struct.unpack_from("<I", self._content, self._at)
        self._at += 4
        return value

    def text(self):
        """A text, which ends with a zero."""
        size = self.number()
        self._at += size
        return self._content[self._at - size : self._at - 1].decode()

    def doubles(self):
        """A list of numbers of eight bytes each."""
        count = self.number()
        if count:
            self._align(8)
        found = np.frombuffer(self._content, "<f8", count, self._at)
        self._at += 8 * count
        return found

    def _align(self, size):
        self._at += -(self._at - HEADER_BYTES) % size


def joint_state(content):
    """Names, positions, velocities and efforts of a `sensor_msgs/msg/JointState`."""
    message = _Message(content)
    message.number(), message.number(), message.text()  # stamp and frame
    names = [message.text() for _ in range(message.number())]
    return names, message.doubles(), message.doubles(), message.doubles()


def trace_of_bag(path, plant: Plant, renamed=None) -> Trace:
    """A recording of positions and efforts, in the order of the plant's joints.

    `renamed` turns the bag's names of joints into the plant's.
    """
    with sqlite3.connect(f"file:{path}?mode=ro&immutable=1", uri=True) as bag:
        query = "select timestamp, data from messages order by timestamp"
        rows = bag.execute(query).fetchall()
    states = [joint_state(content) for _, content in rows]
    names = [renamed(name) if renamed else name for name in states[0][0]]
    order = [names.index(joint) for joint in plant.joints]
    time_s = np.array([stamp for stamp, _ in rows]) * NANOSECOND
    time_s, first = np.unique(time_s, return_index=True)
    position, effort = (
        np.array([state[k] for state in states])[first][:, order] for k in (1, 3)
    )
    return Trace(path.stem, time_s, position, plant.servo, torque_nm=effort)

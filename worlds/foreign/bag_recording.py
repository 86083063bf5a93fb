"""Makes a recording out of a ROS 2 bag: which topics, on which clock."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

import numpy as np
import numpy.typing as npt

from groundwalk.arrays import FloatArray
from groundwalk.errors import ForeignFileError, nearest_name
from worlds.foreign.bags import (
    JOINT_STATE,
    NUMBERS,
    JointMessages,
    StampArray,
    Topic,
    bag_topics,
    find_topic,
    read_topic,
)
from worlds.foreign.recording import ForeignRecording, joint_columns, since_start

NO_TOPIC = "none"
"""Name that a user gives to a topic which is not to be read."""

Clock = Literal["auto", "header", "received"]
"""Which times count: stamps of the headers, times of receipt, or the better ones."""

_SAME_SPAN = 0.1
"""Share by which the span of the headers' stamps may differ from that of the receipt.
Clocks differ by less than a thousandth; a stamp that stands still, or counts something
else than time, by more."""


@dataclass(frozen=True)
class BagOptions:
    """What a user says about a bag.

    Attributes:
      state_topic: of the measured positions; "" to take the only one there is.
      command_topic: of the commands; "" to take the only one there is, "none" for none.
      effort_topic: of the measured torques; "" for those of the state, "none" for none.
      joints: joints of a topic that holds numbers without names, in their order.
      clock: times of the state's rows.
    """

    state_topic: str = ""
    command_topic: str = ""
    effort_topic: str = ""
    joints: tuple[str, ...] = ()
    clock: Clock = "auto"


def read_bag(path: Path, options: BagOptions | None = None) -> ForeignRecording:
    """Read positions, commands and torques of a bag's joints.

    Each distinct time of the state topic is a row. A command holds from when it arrives
    until the next one; before the first one it is missing. Torques of a topic of their
    own are interpolated.

    Args:
      path: a .db3 or .mcap file, or a bag's folder.
      options: which topics to read; by default they are guessed.

    Raises:
      ForeignFileError: the bag is damaged or holds no joints, or it is open which
        topics are meant.
      UnknownNameError: a topic is not there.

    Example:
      >>> read_bag(Path("arm.mcap"), BagOptions(command_topic="/targets")).joints
    """
    options = options or BagOptions()
    topics = bag_topics(path)
    state_topic = _state_topic(path, topics, options)
    command_topic = _command_topic(path, topics, state_topic, options)
    state = read_topic(path, state_topic)
    if "position" not in state.values:
        raise ForeignFileError(f"{path}: {state_topic.name} holds no positions")
    rows = _Rows.of(path, state, options)
    columns, notes = rows.measured(), list(rows.notes)
    if command_topic is not None:
        columns |= rows.commands(read_topic(path, command_topic))
        notes.append(f"commands from {command_topic.name}, held from their arrival on")
    if options.effort_topic not in (NO_TOPIC, "", state_topic.name):
        effort_topic = find_topic(options.effort_topic, topics, "effort")
        columns |= rows.torques(read_topic(path, effort_topic))
        notes.append(f"torques from {effort_topic.name}, interpolated")
    elif options.effort_topic != NO_TOPIC:
        efforts = rows.of_state("torque", "effort")
        columns |= efforts
        if efforts:
            notes.append(f"torques from the efforts of {state_topic.name}")
    if not any(one.startswith(("command", "torque")) for one in columns):
        others = [topic.name for topic in topics if topic != state_topic]
        raise ForeignFileError(
            f"{path}: no command and no effort says what drove the joints; other "
            f"topics that could: {', '.join(others) or 'none'}"
        )
    source = f"ROS 2 bag {path.name}: {'; '.join(notes)}"
    return ForeignRecording(path.stem, columns, source, tuple(notes))


@dataclass(frozen=True, eq=False)
class _Rows:
    """The rows of the recording: the state's messages, each time once.

    Attributes:
      path: of the bag, for errors.
      state: all messages of the state's topic.
      joints: joints of a topic without names.
      time_ns: (rows,) increasing.
      first: (rows,) which message of the state each row is.
      lag_ns: how much later than its stamp a message is received, in the middle. So
        commands, whose times of receipt are all that is sure, get onto the same clock.
      notes: what was chosen, in words.
    """

    path: Path
    state: JointMessages
    joints: tuple[str, ...]
    time_ns: StampArray
    first: npt.NDArray[np.int64]
    lag_ns: int
    notes: tuple[str, ...]

    @classmethod
    def of(cls, path: Path, state: JointMessages, options: BagOptions) -> "_Rows":
        """Choose the clock of the rows: the headers', if it is sensible."""
        stamps_ns, fault, lag_ns = state.stamp_ns, _fault(state), 0
        if options.clock == "header" and fault:
            raise ForeignFileError(
                f"{path}: {state.topic.name}: its headers' stamps {fault}"
            )
        if stamps_ns is None or options.clock == "received" or fault:
            stamps_ns = state.received_ns
            why = f", as the headers' stamps {fault}" if fault else ""
            clock = f"of receipt{why}"
        else:
            lag_ns = int(np.median(state.received_ns - stamps_ns))
            clock = "of the headers"
        time_ns, first = np.unique(stamps_ns, return_index=True)
        notes = [f"positions from {state.topic.name}, times {clock}"]
        if len(first) < len(stamps_ns):
            notes.append(f"{len(stamps_ns) - len(first)} rows have the time of another")
        return cls(path, state, options.joints, time_ns, first, lag_ns, tuple(notes))

    def measured(self) -> dict[str, FloatArray]:
        """Columns of times, positions and, if there are any, velocities."""
        values = self.state.values["position"][self.first]
        return {
            "time": since_start(self.time_ns),
            **joint_columns("position", self.state.joints, values),
            **self.of_state("velocity", "velocity"),
        }

    def of_state(self, column: str, quantity: str) -> dict[str, FloatArray]:
        """Columns of a quantity of the state; none if a driver fills it with zeros."""
        values = self.state.values.get(quantity)
        if values is None or not np.any(np.nan_to_num(values)):
            return {}
        return joint_columns(column, self.state.joints, values[self.first])

    def commands(self, command: JointMessages) -> dict[str, FloatArray]:
        """Columns of position targets, or of torque targets if there are none."""
        names = self._names(command)
        arrival_ns = command.received_ns - self.lag_ns
        last = np.searchsorted(arrival_ns, self.time_ns, side="right") - 1
        for quantity, column in (("position", "command"), ("effort", "command_torque")):
            if quantity in command.values:
                held = command.values[quantity][np.maximum(last, 0)]
                held[last < 0] = np.nan
                return joint_columns(column, names, held)
        raise ForeignFileError(f"{self.path}: {command.topic.name} holds no targets")

    def torques(self, effort: JointMessages) -> dict[str, FloatArray]:
        """Columns of measured torques from a topic of their own."""
        names = self._names(effort)
        quantity = "position" if effort.topic.kind == NUMBERS else "effort"
        if quantity not in effort.values:
            raise ForeignFileError(f"{self.path}: {effort.topic.name} holds no efforts")
        at_ns = effort.received_ns - self.lag_ns
        values = [
            np.interp(self.time_ns, at_ns, one, left=np.nan, right=np.nan)
            for one in effort.values[quantity].T
        ]
        return joint_columns("torque", names, np.stack(values, axis=1))

    def _names(self, messages: JointMessages) -> tuple[str, ...]:
        """The joints of messages, which may carry no names."""
        known, topic = self.state.joints, messages.topic.name
        count = max((one.shape[1] for one in messages.values.values()), default=0)
        unnamed = known if count == len(known) == 1 else self.joints
        names = messages.joints or unnamed
        if len(names) != count:
            raise ForeignFileError(
                f"{self.path}: {topic} holds {count} numbers without names; name their "
                "joints in their order with --joints"
            )
        for joint in names:
            if joint not in known:
                close = nearest_name(joint, known)
                hint = f"did you mean {close!r}? " if close else ""
                raise ForeignFileError(
                    f"{self.path}: {topic} has a joint {joint!r} that "
                    f"{self.state.topic.name} lacks: {hint}it has {', '.join(known)}"
                )
        return names


def _state_topic(path: Path, topics: Sequence[Topic], options: BagOptions) -> Topic:
    states = [topic for topic in topics if topic.kind == JOINT_STATE]
    if options.state_topic:
        return find_topic(options.state_topic, states, "state")
    named = (options.command_topic, options.effort_topic)
    left = [topic for topic in states if topic.name not in named]
    if len(left) == 1:
        return left[0]
    if not left:
        raise ForeignFileError(f"{path}: no topic holds {JOINT_STATE}")
    raise ForeignFileError(
        f"{path}: {len(left)} topics hold {JOINT_STATE}: "
        f"{', '.join(topic.name for topic in left)}; name the measured one with "
        "--state-topic, and the commands with --command-topic"
    )


def _command_topic(
    path: Path, topics: Sequence[Topic], state: Topic, options: BagOptions
) -> Topic | None:
    others = [topic for topic in topics if topic != state]
    if options.command_topic == NO_TOPIC:
        return None
    if options.command_topic:
        return find_topic(options.command_topic, others, "command")
    left = [topic for topic in others if topic.name != options.effort_topic]
    if len(left) > 1:
        raise ForeignFileError(
            f"{path}: {len(left)} topics could be the commands: "
            f"{', '.join(topic.name for topic in left)}; name one with "
            f"--command-topic, or {NO_TOPIC}"
        )
    return left[0] if left else None


def _fault(state: JointMessages) -> str:
    """Why the stamps of the headers are of no use; "" if they are."""
    stamps, received = state.stamp_ns, state.received_ns
    if stamps is None:
        return "are missing"
    if not stamps.any():
        return "are 0"
    if np.any(np.diff(stamps) < 0):
        return "go back"
    span, true_span = int(stamps[-1] - stamps[0]), int(received[-1] - received[0])
    if abs(span - true_span) > _SAME_SPAN * true_span:
        return f"span {span * 1e-9:.3g} s, the receipt {true_span * 1e-9:.3g} s"
    return ""

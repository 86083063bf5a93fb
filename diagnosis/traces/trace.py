"""A recording as arrays in the joint order of the robot model it is compared with."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, fields, replace
from typing import Any, Literal

import numpy as np
from scipy.ndimage import find_objects, label

from diagnosis.plant.servo import Servo
from diagnosis.traces.motion import Motion
from groundwalk.arrays import BoolArray, FloatArray
from groundwalk.errors import BadRecordingError
from worlds.recordings.load import Load

DriveBy = Literal["servos", "torques"]
"""What drives the joints in a replay of a recording: simulated servos that follow the
recorded commands, or the measured torques."""

BEFORE_ROWS = 60
"""Most rows that a part of a recording keeps of what was before it. A state is known
from neighbours on both sides, and most delays are shorter (60 ms at 1,000 rows a
second); if one is longer, the first of these rows' commands counts until then."""

JOINT_FIELDS = {
    "position": "position_rad",
    "velocity": "velocity_rad_s",
    "command": "command_rad",
    "command_torque": "command_torque_nm",
    "torque": "torque_nm",
}
"""Fields of `Trace` by the joints' quantity that a recording has for them."""

VECTOR_FIELDS = {
    "gyroscope": "gyroscope_rad_s",
    "accelerometer": "accelerometer_m_s2",
    "foot_force": "foot_force_n",
    "base.position": "base_position_m",
    "base.orientation": "base_orientation",
    "base.linear_velocity": "base_linear_velocity_m_s",
    "base.angular_velocity": "base_angular_velocity_rad_s",
}
"""Fields of `Trace` by the vector that a recording has for them."""


@dataclass(frozen=True, eq=False)
class Trace:
    """One recording, or a contiguous part of one, with T rows at uneven times.

    The j columns of joints are in the order of the robot model's joints. NaN is a
    missing value, None a channel that was not recorded. Row k was measured at
    `time_s[k]` before `command_rad[k]` took effect, which holds until
    `time_s[k + 1]`. Sliding joints have m for rad and N for N m.

    Attributes:
      name: name of the recording, with the time span if it is a part.
      part_of: name of the recording of which this is a part; "" for a whole one.
      before: of a part, rows of the recording just before it, which are not compared:
        they tell the state in which the part begins, and what was commanded before.
      servo: the servos of this recording; gains may differ between recordings.
      loads: known masses that the robot carried in this recording, beyond those of its
        model, by the body's name.
      position_rad, velocity_rad_s, torque_nm: (T, j) measured at the joints.
      command_rad, command_torque_nm: (T, j) position and torque targets.
      added_nm: (T, j) torques that act on the joints in addition to the servos'.
      gyroscope_rad_s, accelerometer_m_s2: (T, 3) in the sensor's frame.
      foot_force_n: (T, feet) vertical force under each foot.
      base_position_m, base_linear_velocity_m_s: (T, 3) world frame.
      base_orientation: (T, 4) quaternion w, x, y, z, base to world.
      base_angular_velocity_rad_s: (T, 3) body frame.
      motion: smoothed motion, if the torque that it needs is compared with the measured
        torque; None if a replayed motion is compared with the measured one.
      every: only each row whose number is a multiple of this is compared. If torques
        are, the first row of each block stands for its mean.

    Example:
      >>> plant, traces = read_traces(["a.parquet"], "nao")
      >>> traces[0].position_rad.shape
    """

    name: str
    time_s: FloatArray
    position_rad: FloatArray
    servo: Servo
    velocity_rad_s: FloatArray | None = None
    command_rad: FloatArray | None = None
    command_torque_nm: FloatArray | None = None
    torque_nm: FloatArray | None = None
    added_nm: FloatArray | None = None
    gyroscope_rad_s: FloatArray | None = None
    accelerometer_m_s2: FloatArray | None = None
    foot_force_n: FloatArray | None = None
    base_position_m: FloatArray | None = None
    base_orientation: FloatArray | None = None
    base_linear_velocity_m_s: FloatArray | None = None
    base_angular_velocity_rad_s: FloatArray | None = None
    motion: Motion | None = None
    loads: Mapping[str, Load] = field(default_factory=dict)
    part_of: str = ""
    before: "Trace | None" = None
    every: int = 1

    @property
    def recording(self) -> str:
        """Name of the recording, also of a part."""
        return self.part_of or self.name

    @property
    def ticks(self) -> int:
        """Number of rows."""
        return len(self.time_s)

    @property
    def compared(self) -> slice:
        """The rows that are compared."""
        every = self.every if self.motion is None else self.motion.block_rows
        return slice(0, self.ticks, every)

    @property
    def rows(self) -> int:
        """Number of rows that are compared."""
        return len(range(self.ticks)[self.compared])

    @property
    def duration_s(self) -> float:
        """Time from the first to the last row [s]."""
        return float(self.time_s[-1] - self.time_s[0])

    @property
    def tick_s(self) -> float:
        """Median time between rows [s]."""
        return float(np.median(np.diff(self.time_s)))

    @property
    def unheld(self) -> bool:
        """Whether no joint has a servo and a position command: torques drive them."""
        return self.command_rad is None or not self.servo.kp_nm_rad.any()

    @property
    def loose(self) -> bool:
        """Whether some joint has no servo that holds it, so that errors may grow."""
        return self.unheld or not self.servo.kp_nm_rad.all()

    def of(self, columns: Sequence[int]) -> "Trace":
        """The trace with only the joints of these indices; other channels all stay."""
        chosen = list(columns)
        changes = {
            name: values[:, chosen]
            for name in (*JOINT_FIELDS.values(), "added_nm")
            if (values := getattr(self, name)) is not None
        }
        motion = self.motion and self.motion.of(chosen)
        before = self.before and self.before.of(chosen)
        servo = self.servo.of(chosen)
        return replace(self, servo=servo, motion=motion, before=before, **changes)

    def part(self, start: int, stop: int) -> "Trace":
        """Rows `start` to `stop - 1`, with their time span added to the name."""
        name = f"{self.name}[{self.time_s[start]:.3g}-{self.time_s[stop - 1]:.3g} s]"
        first = max(start - BEFORE_ROWS, 0)
        before = self._rows(first, start) if start else self.before
        own = self._rows(start, stop)
        return replace(own, name=name, part_of=self.recording, before=before)

    def led(self) -> "Trace":
        """The trace with the rows `before` it in front, as if it had begun earlier."""
        if self.before is None:
            return self
        earlier = self.before._columns()
        changes: dict[str, Any] = {
            name: np.concatenate([earlier[name], values])
            for name, values in self._columns().items()
        }
        return replace(self, before=None, motion=None, **changes)

    def _rows(self, start: int, stop: int) -> "Trace":
        """Rows `start` to `stop - 1`, and nothing before them."""
        rows: dict[str, Any] = {
            name: each[start:stop] for name, each in self._columns().items()
        }
        motion = self.motion and self.motion.part(start, stop)
        return replace(self, motion=motion, before=None, **rows)

    def _columns(self) -> dict[str, FloatArray]:
        """The arrays with a row for each time, by the names of their fields."""
        every = {one.name: getattr(self, one.name) for one in fields(self)}
        return {n: each for n, each in every.items() if isinstance(each, np.ndarray)}


def driven_by_torques(trace: Trace) -> Trace:
    """The same trace without servos, so that measured torques drive the joints.

    A servo hides much of what its joint lacks, and anything unknown about it is
    mistaken for physics of the joint.

    Raises:
      BadRecordingError: the recording has no measured torques.
    """
    if trace.torque_nm is None:
        raise BadRecordingError(
            f"{trace.name}: no torque was measured that could drive the joints"
        )
    torque = trace.torque_nm
    if trace.added_nm is not None:
        torque = torque + trace.added_nm
    servo = Servo.ideal(torque.shape[1])
    return replace(trace, servo=servo, torque_nm=torque, added_nm=None)


def with_motor_torques(trace: Trace) -> Trace:
    """Let a trace's torques drive its joints without servos beside those with servos.

    A joint without a servo gets its torque target, or without any its measured torque;
    without both it is passive.
    """
    torques = trace.command_torque_nm, trace.torque_nm
    known = [values for values in torques if values is not None]
    alone = trace.servo.kp_nm_rad == 0
    if trace.unheld or not alone.any() or not known:
        return trace
    torque = np.where(np.isfinite(known[0]).any(axis=0), known[0], known[-1])
    more = np.where(alone, filled(torque), 0.0)
    return replace(
        trace, added_nm=more + (0 if trace.added_nm is None else trace.added_nm)
    )


def filled(values: FloatArray) -> FloatArray:
    """Replace each missing value (NaN) in (T, j) by the last one in its column.

    Those at the start become the column's first value; an empty column becomes 0.
    """
    rows = np.arange(len(values))[:, None]
    last = np.maximum.accumulate(np.where(np.isnan(values), -1, rows), axis=0)
    first = np.argmax(~np.isnan(values), axis=0)
    last = np.where(last < 0, first, last)
    return np.nan_to_num(np.take_along_axis(values, last, axis=0))


def stretches(flags: BoolArray) -> list[tuple[int, int]]:
    """The `runs` of (T,) flags; a single row that is not flagged interrupts none."""
    closed = flags.copy()
    closed[1:-1] |= flags[:-2] & flags[2:]
    return runs(closed)


def runs(flags: BoolArray) -> list[tuple[int, int]]:
    """First row of each run of (T,) flagged rows, and the row after its last one."""
    return [(rows.start, rows.stop) for (rows,) in find_objects(label(flags)[0])]


def asked(traces: Sequence[Trace]) -> bool:
    """Whether torques are compared, and those of servos are what their law asks for."""
    motions = [trace.motion for trace in traces]
    return any(motion is not None and motion.by_servo for motion in motions)

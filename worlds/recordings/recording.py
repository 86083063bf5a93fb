"""`Recording`: one rollout written down, in memory, with the columns of format 1.

docs/recordings.md lists the columns; units are SI and radians. At least one column of
`command`, `command_torque` or `torque` is there; every other one but `time` and
`position` is optional, but a vector comes whole. Values may be missing (NaN here, null
in a file). Row k holds what was measured at `time[k]` before `command[k]` took effect;
the command holds until `time[k + 1]`. Names and values of columns are checked here.
Metadata: `worlds.recordings.metadata`.
"""

import difflib
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from groundwalk.arrays import BoolArray, FloatArray
from groundwalk.errors import BadRecordingError, UnknownNameError
from worlds.recordings.metadata import RecordingMetadata

TIME = "time"
SUPPORT = "support"
ORIENTATION = "base.orientation"
POSITION = "position"
DRIVES = ("command", "command_torque", "torque")
"""Quantities that show what drove a joint: position target, torque target and measured
torque. A recording has at least one of their columns, such as command.knee."""
JOINT_QUANTITIES = (POSITION, "velocity", *DRIVES)
VECTORS = {
    "base.position": ("x", "y", "z"),
    ORIENTATION: ("w", "x", "y", "z"),
    "base.linear_velocity": ("x", "y", "z"),
    "base.angular_velocity": ("x", "y", "z"),
    "gyroscope": ("x", "y", "z"),
    "accelerometer": ("x", "y", "z"),
    "foot_force": ("left", "right"),
    "foot_force.left": ("front_left", "front_right", "rear_left", "rear_right"),
    "foot_force.right": ("front_left", "front_right", "rear_left", "rear_right"),
}


def vector_columns(vector: str) -> tuple[str, ...]:
    """Column names of a vector, such as gyroscope.x, .y and .z of "gyroscope"."""
    return tuple(f"{vector}.{component}" for component in VECTORS[vector])


FIXED = (
    TIME,
    SUPPORT,
    *(name for vector in VECTORS for name in vector_columns(vector)),
)


def joints_with(quantity: str, names: Iterable[str]) -> tuple[str, ...]:
    """The joints that have a column `<quantity>.<joint>` in `names`, in their order."""
    prefix = f"{quantity}."
    return tuple(name[len(prefix) :] for name in names if name.startswith(prefix))


def check_names(names: Sequence[str]) -> None:
    """Check that columns with these names can make up a recording."""
    _check_each(names)
    _check_required(names)
    _check_joints(names)
    _check_vectors(names)


def nearest(name: str, known: Iterable[str]) -> str:
    """Hint for an error message: "; did you mean 'x'?", or "" if no name is similar."""
    close = difflib.get_close_matches(name, list(known), n=1)
    return f"; did you mean {close[0]!r}?" if close else ""


def _check_each(names: Sequence[str]) -> None:
    for name, times in Counter(names).items():
        if times > 1:
            raise BadRecordingError(f"column {name!r} is there {times} times")
        quantity, _, joint = name.partition(".")
        is_of_joint = quantity in JOINT_QUANTITIES and joint and joint.isprintable()
        if name not in FIXED and not is_of_joint:
            of_joint = [f"{quantity}.{joint}" for quantity in JOINT_QUANTITIES]
            hint = nearest(name, (*FIXED, *of_joint)) or (
                f"; columns are {TIME}, {SUPPORT}, those of the vectors "
                f"{', '.join(VECTORS)}, and {', '.join(JOINT_QUANTITIES)} of a joint, "
                f"such as '{POSITION}.knee'"
            )
            raise BadRecordingError(f"unknown column {name!r}{hint}")


def _check_required(names: Sequence[str]) -> None:
    if TIME not in names:
        raise BadRecordingError(f"no column {TIME!r}")
    if not joints_with(POSITION, names):
        raise BadRecordingError(f"no column '{POSITION}.<joint>'")
    if not any(joints_with(quantity, names) for quantity in DRIVES):
        raise BadRecordingError(
            "no column says what drove the joints; one of "
            f"{', '.join(f'{quantity}.<joint>' for quantity in DRIVES)} is needed"
        )


def _check_joints(names: Sequence[str]) -> None:
    measured = dict.fromkeys(joints_with(POSITION, names))
    for quantity in JOINT_QUANTITIES:
        for joint in joints_with(quantity, names):
            if joint not in measured:
                raise BadRecordingError(
                    f"column '{quantity}.{joint}' has no '{POSITION}.{joint}' "
                    f"beside it{nearest(joint, measured)}"
                )


def _check_vectors(names: Sequence[str]) -> None:
    for vector in VECTORS:
        columns = vector_columns(vector)
        missing = [name for name in columns if name not in names]
        if missing and len(missing) < len(columns):
            raise BadRecordingError(
                f"column {missing[0]!r} is missing; {vector} is only of use whole "
                f"({', '.join(columns)})"
            )


UNIT_TOLERANCE = 1e-3
"""Largest allowed |norm - 1| of a quaternion; rounding to three decimals is allowed."""


def bad_value(column: str, row: int, problem: str) -> BadRecordingError:
    """Make the error for one wrong value; its `row` counts from 0."""
    return BadRecordingError(
        f"column {column!r}, row {row} (counted from 0): {problem}"
    )


def frozen_columns(columns: Mapping[str, npt.ArrayLike]) -> dict[str, FloatArray]:
    """Turn columns into read-only arrays of floats, all (ticks,).

    An array that can be written to is copied.
    """
    frozen = {name: _frozen(name, values) for name, values in columns.items()}
    lengths = {name: values.size for name, values in frozen.items()}
    first, rows = next(iter(lengths.items()), (TIME, 0))
    for name, length in lengths.items():
        if length != rows:
            raise BadRecordingError(
                f"column {name!r} has {length} rows, column {first!r} has {rows}"
            )
    return frozen


def check_values(columns: Mapping[str, FloatArray]) -> None:
    """Check the values of a recording's columns; NaN is a missing value.

    Times must be there and increase, values be finite, quaternions have unit length,
    and `support` be -1, 0 or 1; BadRecordingError tells column and row of the first
    fault.
    """
    if not columns[TIME].size:
        raise BadRecordingError("no rows")
    _refuse(TIME, np.isnan(columns[TIME]), "a time is missing")
    for name, values in columns.items():
        _refuse(name, np.isinf(values), "{} is not finite", values)
    time_s = columns[TIME]
    not_later = np.concatenate([[False], time_s[1:] <= time_s[:-1]])
    _refuse(TIME, not_later, "{} s is not later than the row before", time_s)
    if ORIENTATION + ".w" in columns:
        _check_unit(np.stack([columns[name] for name in vector_columns(ORIENTATION)]))
    if SUPPORT in columns:
        support = columns[SUPPORT]
        allowed = np.isin(support, (-1.0, 0.0, 1.0)) | np.isnan(support)
        _refuse(SUPPORT, ~allowed, "{} is none of -1, 0, 1", support)


def _frozen(name: str, values: npt.ArrayLike) -> FloatArray:
    given = np.asarray(values)
    if given.dtype.kind not in "fiu":
        raise BadRecordingError(f"column {name!r} holds {given.dtype}, not numbers")
    if given.ndim != 1:
        raise BadRecordingError(
            f"column {name!r} has the shape {given.shape}, not one value a row"
        )
    array: FloatArray = given.astype(np.float64, copy=given.flags.writeable)
    array.flags.writeable = False
    return array


def _refuse(
    column: str, bad: BoolArray, problem: str, values: FloatArray | None = None
) -> None:
    """Raise an error for the first row that is True in `bad` (rows,), if any.

    A {} in `problem` stands for the value of that row.
    """
    if bad.any():
        row = int(np.argmax(bad))
        value = None if values is None else float(values[row])
        raise bad_value(column, row, problem.format(value))


def _check_unit(quaternion: FloatArray) -> None:
    with np.errstate(over="ignore"):  # an infinite norm is refused below
        norm = np.sqrt(np.sum(quaternion**2, axis=0))
    # A quaternion with a missing component has the norm NaN, which passes.
    _refuse(
        vector_columns(ORIENTATION)[0],
        np.abs(norm - 1.0) > UNIT_TOLERANCE,
        "the quaternion has the norm {}, not 1",
        norm,
    )


@dataclass(frozen=True, eq=False)
class Recording:
    """One rollout as read-only columns of equal length, with metadata on its origin.

    The constructor checks all columns and metadata against format 1, and raises
    `BadRecordingError` with column and row of the first fault.

    Example:
      >>> columns = {"time": time_s, "position.swing": measured_rad, ...
      "command.swing": command_rad} >>> recording = Recording(columns,
      RecordingMetadata("arm.xml", "fixed", "in water"))
    """

    columns: dict[str, FloatArray]
    """Values by column name, each of shape (ticks,); NaN is a missing value."""
    metadata: RecordingMetadata

    def __post_init__(self) -> None:
        """Check the columns' names and values, and the joints in the metadata."""
        check_names(list(self.columns))
        object.__setattr__(self, "columns", frozen_columns(self.columns))
        check_values(self.columns)
        for joint in self.metadata.servo:
            if joint not in self.joints:
                raise BadRecordingError(
                    f"metadata has a servo for {joint!r}, which is no joint here"
                    f"{nearest(joint, self.joints)}"
                )

    @property
    def time_s(self) -> FloatArray:
        """Time of each tick [s], shape (ticks,)."""
        return self.columns[TIME]

    @property
    def ticks(self) -> int:
        """Number of rows; there is one for each control tick."""
        return self.time_s.size

    @property
    def duration_s(self) -> float:
        """Time from the first tick to the last one [s]."""
        return float(self.time_s[-1] - self.time_s[0])

    @property
    def joints(self) -> tuple[str, ...]:
        """The recorded joints, in the order of their position columns."""
        return self.joints_with(POSITION)

    def joints_with(self, quantity: str) -> tuple[str, ...]:
        """The joints with a column of a quantity, in the order of the columns.

        Quantities are position, velocity, command, command_torque and torque.
        """
        if quantity not in JOINT_QUANTITIES:
            raise UnknownNameError("joint quantity", quantity, JOINT_QUANTITIES)
        return joints_with(quantity, self.columns)

    def joint_values(self, quantity: str, joints: Sequence[str]) -> FloatArray:
        """(ticks, joints) values of a quantity of some joints, in SI units."""
        known = self.joints_with(quantity)
        for joint in joints:
            if joint not in known:
                raise UnknownNameError(f"joint with a {quantity}", joint, known)
        if not joints:
            return np.empty((self.ticks, 0))
        return np.stack([self.columns[f"{quantity}.{joint}"] for joint in joints], 1)

    def has(self, vector: str) -> bool:
        """Whether a vector, such as "foot_force", was recorded."""
        if vector not in VECTORS:
            raise UnknownNameError("vector", vector, VECTORS)
        return vector_columns(vector)[0] in self.columns

    def vector(self, vector: str) -> FloatArray:
        """(ticks, components) values of a vector, such as "gyroscope", in SI units."""
        if not self.has(vector):
            raise UnknownNameError(
                "vector of this recording", vector, filter(self.has, VECTORS)
            )
        return np.stack([self.columns[name] for name in vector_columns(vector)], axis=1)

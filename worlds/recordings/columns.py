"""Names and values of a recording's columns: those that exist, and checks of both."""

import difflib
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence

import numpy as np
import numpy.typing as npt

from groundwalk.arrays import BoolArray, FloatArray
from groundwalk.errors import BadRecordingError

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
    """Turn columns into read-only arrays of floats, all of the same length.

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

"""Checks the values in the columns of a recording."""

from collections.abc import Mapping

import numpy as np
import numpy.typing as npt

from groundwalk.arrays import BoolArray, FloatArray
from groundwalk.errors import BadRecordingError
from worlds.recordings.columns import ORIENTATION, SUPPORT, TIME, vector_columns

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

    Raises:
      BadRecordingError: a column holds no numbers, is not one-dimensional, or its
        length differs from that of the first column.
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

    Raises:
      BadRecordingError: there are no rows; a time is missing or not later than the
        one before; a value is infinite, a quaternion not of unit length, or a value of
        `support` none of -1, 0, 1.
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

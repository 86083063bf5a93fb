"""Which columns of a foreign table become which of a recording, and in which units."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from groundwalk.arrays import FloatArray
from groundwalk.errors import ForeignFileError, UnknownNameError, nearest_name
from worlds.foreign.column_names import ColumnMeaning, meaning
from worlds.foreign.recording import ForeignRecording
from worlds.foreign.tables import ForeignTable
from worlds.foreign.units import TIMES, factor, known_unit, units_of
from worlds.recordings.recording import DRIVES, FIXED, JOINT_QUANTITIES, POSITION, TIME

NOTHING = "none"
"""In place of a column: the entry of this name is left out."""

ONE_JOINT = "joint"
"""Name of the joint of a table whose columns name none."""

_LARGEST_RAD = 2.0 * np.pi
"""Positions without a unit are taken as radians up to here; degrees soon exceed it."""
_STEPS_S = (2.5e-4, 0.25)
"""Steps of time that recordings have [s]: they span less than a factor of 1000, so that
only one of s, ms, us and ns fits."""


@dataclass(frozen=True)
class Entry:
    """One column of the recording.

    Attributes:
      column: its name in format 1.
      source: the column of the table.
      unit: unit of the table's numbers; "" while it is open.
      guessed: whether anything in it was guessed, not said by the user.
      reason: why it is so, in words.
    """

    column: str
    source: str
    unit: str = ""
    guessed: bool = False
    reason: str = "--map"


def plan(table: ForeignTable, said: Sequence[str] = ()) -> tuple[Entry, ...]:
    """Decide on the columns of a recording: those said by the user, the rest guessed.

    Args:
      table: the table.
      said: entries such as "position.elbow=q2*deg", or "torque.elbow=none".

    Raises:
      ForeignFileError: something is ambiguous or missing; says what to give.
      UnknownNameError: a column or a unit is unknown.

    Example:
      >>> plan(table, ["position.elbow=q2*deg", "time=stamp*ms"])
    """
    ours = [_parsed(text, table) for text in said]
    twice = [
        one.column for one in ours if [o.column for o in ours].count(one.column) > 1
    ]
    if twice:
        raise ForeignFileError(f"--map {twice[0]} is given twice")
    entries = [one for one in ours if one.source != NOTHING]
    entries += _guessed(table, ours)
    _check_complete(table, entries)
    values = {one.column: table.numbers(one.source) for one in entries}
    return tuple(_with_unit(table, one, entries, values) for one in entries)


def unused(table: ForeignTable, entries: Sequence[Entry]) -> tuple[str, ...]:
    """The columns of a table that no entry takes."""
    taken = {one.source for one in entries}
    return tuple(name for name in table.names if name not in taken)


def apply(table: ForeignTable, entries: Sequence[Entry]) -> ForeignRecording:
    """Make the recording that the entries describe; rows of one time become one."""
    columns = {
        one.column: table.numbers(one.source) * factor(one.unit, one.column)
        for one in entries
    }
    notes: tuple[str, ...] = ()
    time_s = columns[TIME]
    first = np.concatenate([[True], np.diff(time_s) != 0.0])
    if not first.all():
        notes = (f"{np.count_nonzero(~first)} rows have the time of the row before",)
        columns = {name: values[first] for name, values in columns.items()}
    if abs(columns[TIME][0]) > 1e6:  # before it meets anything that rounds it
        columns[TIME] = columns[TIME] - columns[TIME][0]
    source = f"table {table.path.name}"
    return ForeignRecording(table.path.stem, columns, source, notes)


def _parsed(text: str, table: ForeignTable) -> Entry:
    """An entry as the user types it: COLUMN=NAME or COLUMN=NAME*UNIT."""
    column, equals, source = (part.strip() for part in text.partition("="))
    if not equals or not source:
        raise ForeignFileError(
            f"--map {text!r} must be like position.elbow=q2, or position.elbow=q2*deg"
        )
    quantity, _, joint = column.partition(".")
    if column not in FIXED and not (quantity in JOINT_QUANTITIES and joint):
        known = [*FIXED, *(f"{one}.{joint or 'knee'}" for one in JOINT_QUANTITIES)]
        raise UnknownNameError("column of recordings", column, known)
    if source == NOTHING or source in table.names:
        return Entry(column, source)
    name, _, unit = source.rpartition("*")
    if name.strip() not in table.names:
        raise UnknownNameError(
            f"column of {table.path}", name.strip() or source, table.names
        )
    spelled = known_unit(unit, column)
    if spelled is None:
        raise UnknownNameError(f"unit of {column}", unit, units_of(column))
    return Entry(column, name.strip(), spelled)


def _guessed(table: ForeignTable, ours: Sequence[Entry]) -> list[Entry]:
    """Entries for the columns that the user said nothing about."""
    said = {one.column for one in ours}
    taken = {one.source for one in ours}
    found: dict[str, tuple[str, ColumnMeaning]] = {}
    for name in table.names:
        what = meaning(name)
        if name in taken or what is None or not table.is_numeric(name):
            continue
        column = (
            what.column
            if what.joint or what.quantity == TIME
            else what.column + ONE_JOINT
        )
        if column in said:
            continue
        if what.open_between:
            raise ForeignFileError(
                f"{table.path}: column {name!r} may be {what.open_between}; say "
                f"--map velocity.JOINT={name}, command.JOINT={name}, or leave it out "
                f"with --map {column}={NOTHING}"
            )
        if column in found:
            raise ForeignFileError(
                f"{table.path}: both {found[column][0]!r} and {name!r} could be "
                f"{column}; name one with --map {column}={name}"
            )
        found[column] = name, what
    return [
        Entry(column, name, what.unit, guessed=True, reason="its name")
        for column, (name, what) in found.items()
    ]


def _check_complete(table: ForeignTable, entries: Sequence[Entry]) -> None:
    """Refuse what lacks a time, a position or a drive, or a joint without position."""
    columns = {one.column: one.source for one in entries}
    listed = ", ".join(table.names)
    if TIME not in columns:
        raise ForeignFileError(
            f"{table.path}: no column looks like the time; name it with --map "
            f"time=COLUMN*s. Its columns are {listed}"
        )
    positions = [one for one in columns if one.startswith(f"{POSITION}.")]
    if not positions:
        raise ForeignFileError(
            f"{table.path}: no column looks like a position; name each with --map "
            f"position.JOINT=COLUMN*rad. Its columns are {listed}"
        )
    for column, source in columns.items():
        quantity, _, joint = column.partition(".")
        wanted = f"{POSITION}.{joint}"
        if quantity in JOINT_QUANTITIES and wanted not in columns:
            close = nearest_name(wanted, positions) or positions[0]
            raise ForeignFileError(
                f"{table.path}: {source!r} is taken as {column}, but nothing as "
                f"{wanted}; the nearest is {close}: give --map {quantity}."
                f"{close.partition('.')[2]}={source}, or --map {column}={NOTHING}"
            )
    if not any(one.partition(".")[0] in DRIVES for one in columns):
        raise ForeignFileError(
            f"{table.path}: no column looks like a command or a torque; name one with "
            f"--map command.JOINT=COLUMN*rad. Its columns are {listed}"
        )


def _with_unit(
    table: ForeignTable,
    entry: Entry,
    entries: Sequence[Entry],
    values: Mapping[str, FloatArray],
) -> Entry:
    """An entry whose unit is known: said, in the column's name, or shown by values."""
    if entry.unit:
        return entry
    what = meaning(entry.source)
    named = (
        known_unit(what.unit, entry.column) if what is not None and what.unit else None
    )
    if named:
        return replace(entry, unit=named)
    quantity, _, joint = entry.column.partition(".")
    if quantity == TIME:
        unit, why = _time_unit(table, entry, values[TIME]), "its steps"
    elif quantity in (POSITION, "command"):
        unit, why = _angle_unit(table, joint, entries, values)
    elif quantity == "velocity":
        angle, why = _angle_unit(table, joint, entries, values)
        unit = f"{angle}/s"
    elif quantity in JOINT_QUANTITIES:
        unit, why = "Nm", "the usual unit"
    else:
        return replace(entry, unit="SI")
    return replace(entry, unit=unit, guessed=True, reason=f"{entry.reason}, {why}")


def _time_unit(table: ForeignTable, entry: Entry, values: FloatArray) -> str:
    steps = np.diff(values)
    step = float(np.median(steps[steps > 0.0])) if (steps > 0.0).any() else 0.0
    low_s, high_s = _STEPS_S
    fitting = [unit for unit, scale in TIMES.items() if low_s <= step * scale < high_s]
    if len(fitting) != 1:
        raise ForeignFileError(
            f"{table.path}: the unit of {entry.source!r} is open, its steps are "
            f"{step:.6g}; name it with --map time={entry.source}*s (or ms, us, ns)"
        )
    return fitting[0]


def _angle_unit(
    table: ForeignTable,
    joint: str,
    entries: Sequence[Entry],
    values: Mapping[str, FloatArray],
) -> tuple[str, str]:
    """Unit of a joint's angles, and why: from one that has it, or from the values."""
    own = [
        one
        for one in entries
        if one.column in (f"{POSITION}.{joint}", f"command.{joint}")
    ]
    for one in own:
        what = meaning(one.source)
        unit = one.unit or (what.unit if what is not None else "")
        if unit and known_unit(unit, f"{POSITION}.{joint}"):
            return unit, f"as {one.source}"
    largest = max(
        float(np.nanmax(np.abs(values[one.column]), initial=0.0)) for one in own
    )
    if largest > _LARGEST_RAD:
        one = own[0]
        raise ForeignFileError(
            f"{table.path}: {one.source!r} has no unit and reaches {largest:.4g}, "
            f"much for radians; name it with --map {one.column}={one.source}*deg, or "
            "with *rad if it is that"
        )
    return "rad", "it stays below one turn"

"""Makes recordings out of the JSON of BAM, Rhoban's test bench for servos."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from groundwalk.arrays import BoolArray, FloatArray
from groundwalk.errors import BadValueError, ForeignFileError
from groundwalk.json_data import is_number, parse_json
from worlds.foreign.recording import ForeignRecording

JOINT = "pendulum"
"""Name of the bench's one joint; the files have none."""

_FIELDS = {"position": "position", "speed": "velocity", "goal_position": "command"}
_OPTIONAL = ("speed",)
_ABOUT = {"mass": "kg", "length": "m", "kp": "(firmware)", "vin": "V"}
_SHORTEST_S = 0.1


def read_bam(path: Path) -> list[ForeignRecording]:
    """Read a log: one recording for each stretch of time in which the motor is on.

    Positions are in rad, 0 hanging down; speeds in rad/s. What BAM calls load is no
    torque and is left out. With its motor off the pendulum falls freely, while a
    recording says that it follows commands: so these rows are left out, and stretches
    below 0.1 s.

    Raises:
      ForeignFileError: the file is no log of BAM, or the motor is never on.
    """
    data = _data(path)
    entries = data["entries"]
    time_s = _times(path, data)
    columns = {
        f"{quantity}.{JOINT}": _values(path, entries, key)
        for key, quantity in _FIELDS.items()
        if key not in _OPTIONAL or all(key in entry for entry in entries)
    }
    enabled = np.array([bool(entry.get("torque_enable", True)) for entry in entries])
    parts = [part for part in _stretches(enabled) if _lasts(time_s[part])]
    if not parts:
        raise ForeignFileError(f"{path}: the motor is not on for {_SHORTEST_S} s")
    about = [
        f"{key} {data[key]:g} {unit}"
        for key, unit in _ABOUT.items()
        if is_number(data.get(key))
    ]
    motor = data.get("motor")
    source = ", ".join(
        [f"BAM {path.name}", *([f"motor {motor}"] if motor else []), *about]
    )
    off = int(np.count_nonzero(~enabled))
    notes = (f"the motor is off in {off} rows, which are left out",) if off else ()
    return [
        ForeignRecording(
            path.stem if len(parts) == 1 else f"{path.stem}_{number}",
            {
                "time": time_s[part],
                **{name: values[part] for name, values in columns.items()},
            },
            source,
            notes,
        )
        for number, part in enumerate(parts, 1)
    ]


def _data(path: Path) -> Mapping[str, Any]:
    try:
        data = parse_json(path.read_bytes(), "it")
    except BadValueError as error:
        raise ForeignFileError(f"{path}: {error}") from None
    entries = data.get("entries") if isinstance(data, dict) else None
    if not isinstance(entries, list) or not entries:
        raise ForeignFileError(f"{path}: no log of BAM: it has no 'entries'")
    for row, entry in enumerate(entries):
        if not isinstance(entry, dict):
            raise ForeignFileError(f"{path}: entries[{row}] is no object")
    return dict(data)


def _times(path: Path, data: Mapping[str, Any]) -> FloatArray:
    """Times [s]; logs without time stamps have a fixed step `dt`."""
    entries = data["entries"]
    if "timestamp" not in entries[0] and is_number(data.get("dt")):
        rows = np.arange(len(entries), dtype=np.float64)
        times: FloatArray = rows * float(data["dt"])
        return times
    return _values(path, entries, "timestamp")


def _values(path: Path, entries: list[Mapping[str, Any]], key: str) -> FloatArray:
    for row, entry in enumerate(entries):
        if not is_number(entry.get(key)):
            raise ForeignFileError(
                f"{path}: {key!r} of entries[{row}] must be a number, not "
                f"{entry.get(key)!r}"
            )
    return np.array([entry[key] for entry in entries], np.float64)


def _stretches(enabled: BoolArray) -> list[slice]:
    """The contiguous parts in which a flag (rows,) is set."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], enabled, [False]])))
    return [slice(int(a), int(b)) for a, b in edges.reshape(-1, 2)]


def _lasts(time_s: FloatArray) -> bool:
    return bool(time_s[-1] - time_s[0] >= _SHORTEST_S)

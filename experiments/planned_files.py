"""Writes planned motions as files that can be played, and reads such files."""

import csv
import io
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from diagnosis.motions.plan import PlannedMotion
from groundwalk.arrays import FloatArray
from groundwalk.errors import BadRecordingError
from groundwalk.files import write_text


def write_planned(folder: Path, motions: Sequence[PlannedMotion]) -> list[Path]:
    """Write the commands of motions, one CSV file each, into a folder.

    Columns are `time` [s] and `command.<joint>` [rad], those of recordings.
    """
    paths = []
    for one in motions:
        command = one.trace.command_rad
        assert command is not None
        path = folder / f"{one.motion.name}.csv"
        write_text(path, _csv(one.joints, one.trace.time_s, command))
        paths.append(path)
    return paths


def _csv(joints: Sequence[str], time_s: FloatArray, command_rad: FloatArray) -> str:
    text = io.StringIO()
    rows = csv.writer(text, lineterminator="\n")
    rows.writerow(["time", *(f"command.{joint}" for joint in joints)])
    for time, command in zip(time_s.tolist(), command_rad.tolist(), strict=True):
        rows.writerow([f"{time:.6g}", *(f"{value:.6g}" for value in command)])
    return text.getvalue()


def read_planned(path: Path, joints: Sequence[str]) -> tuple[FloatArray, FloatArray]:
    """Times (T,) [s] and commands (T, j) [rad] of a file, in the order of `joints`.

    Raises:
      BadRecordingError: it is no such file, or has other joints.
    """
    try:
        lines = list(csv.reader(path.read_text().splitlines()))
        header, table = lines[0], np.array(lines[1:], float)
    except (UnicodeDecodeError, ValueError, IndexError) as error:
        raise BadRecordingError(
            f"{path}: no commands can be read; a file to play is CSV with columns time "
            "and command.<joint>"
        ) from error
    wanted = ["time", *(f"command.{joint}" for joint in joints)]
    for name in wanted:
        if name not in header:
            raise BadRecordingError(f"{path}: it has no column {name}")
    columns = table[:, [header.index(name) for name in wanted]]
    if len(columns) < 2 or not np.isfinite(columns).all():
        raise BadRecordingError(f"{path}: a command is missing")
    if not (np.diff(columns[:, 0]) > 0).all():
        raise BadRecordingError(f"{path}: time does not run forward")
    return columns[:, 0], columns[:, 1:]

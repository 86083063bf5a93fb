"""Makes the labels of real recordings wrong: gains, zeros, times, names, scales.

Each function returns a changed copy of a recording. The physics that a diagnosis must
then find is the inverse of what was done, as each docstring says.
"""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from experiments.concealed.doctored.parts import rows
from groundwalk.arrays import FloatArray
from worlds.recordings import Recording
from worlds.recordings.recording import TIME


def declare_gain(recording: Recording, joint: str, factor: float) -> Recording:
    """Declare a servo `factor` times as stiff: the true one has 1/factor of that."""
    servo = dict(recording.metadata.servo)
    servo[joint] = replace(servo[joint], kp=factor * servo[joint].kp)
    return replace(recording, metadata=replace(recording.metadata, servo=servo))


def hurry_commands(recording: Recording, ticks: int) -> Recording:
    """Write all commands `ticks` rows earlier: they take effect as much later.

    The last rows, for which there is no command then, are left out.
    """
    kept = recording.ticks - ticks
    commands = {
        name: values[ticks:]
        for name, values in recording.columns.items()
        if name.startswith("command.")
    }
    return _with(rows(recording, 0, kept), commands)


def shift_zero(recording: Recording, joint: str, offset_rad: float) -> Recording:
    """Add an offset to all angles of a joint, its commands included.

    Measured angle less true angle is then the offset. Commands are angles of the same
    encoder: without them the servo would seem to miss its targets by the offset.
    """
    names = (f"position.{joint}", f"command.{joint}")
    moved = {
        name: recording.columns[name] + offset_rad
        for name in names
        if name in recording.columns
    }
    return _with(recording, moved)


def scale_torque(recording: Recording, joint: str, factor: float) -> Recording:
    """Multiply a joint's measured torque: it is `factor` times the true one."""
    name = f"torque.{joint}"
    return _with(recording, {name: factor * recording.columns[name]})


def swap_joints(recording: Recording, one: str, other: str) -> Recording:
    """Exchange what is measured at two joints; commands and torques stay."""
    swapped = {}
    for quantity in ("position", "velocity"):
        names = f"{quantity}.{one}", f"{quantity}.{other}"
        if all(name in recording.columns for name in names):
            swapped[names[0]] = recording.columns[names[1]]
            swapped[names[1]] = recording.columns[names[0]]
    return _with(recording, swapped)


def scale_time(recording: Recording, factor: float) -> Recording:
    """Multiply all times: the robot seems slower if the factor is above 1."""
    return _with(recording, {TIME: factor * recording.time_s})


def tick_s(recording: Recording) -> float:
    """The usual time between two rows [s]."""
    return float(np.median(np.diff(recording.time_s)))


def _with(recording: Recording, changed: Mapping[str, FloatArray]) -> Recording:
    return replace(recording, columns={**recording.columns, **changed})

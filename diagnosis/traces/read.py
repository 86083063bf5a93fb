"""Reads recordings as traces (arrays), and loads the robot model they belong to."""

from collections import Counter
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from diagnosis.plant.load import load_plant
from diagnosis.plant.loads import check_loads
from diagnosis.plant.plant import Base, Plant
from diagnosis.plant.servo import Gains, with_gains
from diagnosis.traces.reference import Reference
from diagnosis.traces.trace import JOINT_FIELDS, VECTOR_FIELDS, Trace
from groundwalk.arrays import FloatArray
from groundwalk.errors import BadRecordingError
from worlds import read_recording
from worlds.recordings.metadata import ServoGains
from worlds.recordings.recording import Recording, nearest


def read_traces(
    paths: Sequence[str | Path], source: str | Path, servo: Gains | None = None
) -> tuple[Plant, list[Trace]]:
    """Read recordings of one robot and make its nominal model.

    Args:
      paths: recordings, or folders of them, with the same joints and kind of base.
      source: a robot's name, or a path to its MJCF (.xml) or URDF (.urdf).
      servo: servo gains for recordings that state none.

    Raises:
      BadRecordingError: there is no recording, one cannot be read, they do not fit
        together, or they do not fit the robot.
      UnknownNameError: there is no such robot.
      BadModelError: the robot's file is no model.

    Example:
      >>> plant, traces = read_traces(["air.parquet"], "nao")
      >>> plant.joints[:2], traces[0].position_rad.shape
    """
    files = recording_files(paths)
    if not files:
        raise BadRecordingError("no recordings are given")
    recordings = [read_recording(path) for path in files]
    _check_alike(files, recordings)
    gains = [_gains(recording, servo) for recording in recordings]
    first = recordings[0]
    base: Base = "floating" if first.metadata.base == "floating" else "fixed"
    plant = load_plant(source, base, first.joints, gains[0])
    for path, one in zip(files, recordings, strict=True):
        check_loads(one.metadata.loads, plant, str(path))
    plant = plant.bearing([one.metadata.loads for one in recordings])
    traces = [
        replace(
            trace_of(recording, plant, name),
            servo=with_gains(plant.servo, plant.joints, own),
        )
        for recording, name, own in zip(recordings, _names(files), gains, strict=True)
    ]
    return plant, traces


def read_reference(
    paths: Sequence[str | Path],
    source: str | Path,
    plant: Plant,
    servo: Gains | None = None,
) -> Reference | None:
    """Read reference recordings: those of the same robot while it was healthy.

    Arguments and errors are those of `read_traces`; `source` is the model of the robot
    as it was then, `plant` that of the recordings that are diagnosed. None without
    paths.

    Raises:
      BadRecordingError: one has other joints or another base than the plant.

    Example:
      >>> plant, traces = read_traces([Path("today.parquet")], "nao")
      >>> healthy = read_reference([Path("last_year.parquet")], "nao", plant)
    """
    if not paths:
        return None
    own, traces = read_traces(paths, source, servo)
    if own.base != plant.base:
        raise BadRecordingError(
            f"{paths[0]}: the base of the reference is {own.base}, that of the "
            f"recordings {plant.base}"
        )
    differing = sorted(set(own.joints) ^ set(plant.joints))
    if differing:
        raise BadRecordingError(
            f"{paths[0]}: only one of the reference and the recordings has joint "
            f"{differing[0]!r}"
        )
    if own.joints != plant.joints:
        raise BadRecordingError(
            f"{paths[0]}: the joints of the reference are in another order than those "
            "of the recordings"
        )
    return Reference(own, traces)


def recording_files(paths: Sequence[str | Path]) -> list[Path]:
    """Paths of recordings, in which each folder is replaced by the recordings in it."""
    found = []
    for path in map(Path, paths):
        inside = sorted(
            one for one in path.glob("*") if one.suffix.lower() in (".csv", ".parquet")
        )
        if path.is_dir() and not inside:
            raise BadRecordingError(f"{path}: no recording (.parquet, .csv) is in it")
        found += inside if path.is_dir() else [path]
    return found


def _gains(recording: Recording, servo: Gains | None) -> Gains:
    """Servo gains by joint: the recording's own, or `servo` where it states none."""
    if isinstance(servo, ServoGains):
        servo = dict.fromkeys(recording.joints, servo)
    return {**(servo or {}), **(recording.metadata.servo or {})}


def trace_of(recording: Recording, plant: Plant, name: str) -> Trace:
    """Arrange a recording in a robot model's order of joints; missing values stay NaN.

    A quantity that only some joints have is NaN at the others. Foot forces are left
    out unless the robot model has two feet.

    Raises:
      BadRecordingError: the recording's joints or base are not the plant's.
    """
    for joint in recording.joints:
        if joint not in plant.joints:
            hint = nearest(joint, plant.joints)
            raise BadRecordingError(f"{name}: the plant has no joint {joint!r}{hint}")
    missing = [joint for joint in plant.joints if joint not in recording.joints]
    if missing:
        raise BadRecordingError(f"{name}: no position of joint {missing[0]!r}")
    if recording.metadata.base != plant.base:
        raise BadRecordingError(
            f"{name}: its base is {recording.metadata.base}, the plant's {plant.base}"
        )
    channels: dict[str, Any] = {
        field: _of_joints(recording, quantity, plant.joints)
        for quantity, field in JOINT_FIELDS.items()
        if quantity != "position"
    }
    for vector, field in VECTOR_FIELDS.items():
        if recording.has(vector) and (vector != "foot_force" or len(plant.feet) == 2):
            channels[field] = recording.vector(vector)
    return Trace(
        name=name,
        time_s=recording.time_s,
        position_rad=recording.joint_values("position", plant.joints),
        servo=with_gains(plant.servo, plant.joints, recording.metadata.servo),
        loads=recording.metadata.loads,
        **channels,
    )


def _of_joints(
    recording: Recording, quantity: str, joints: Sequence[str]
) -> FloatArray | None:
    have = recording.joints_with(quantity)
    if not have:
        return None
    missing = np.full(recording.ticks, np.nan)
    columns = [
        recording.columns.get(f"{quantity}.{joint}", missing) for joint in joints
    ]
    return np.stack(columns, axis=1)


def _check_alike(paths: Sequence[Path], recordings: Sequence[Recording]) -> None:
    first = recordings[0]
    for path, other in zip(paths, recordings, strict=True):
        differing = sorted(set(first.joints) ^ set(other.joints))
        if differing:
            raise BadRecordingError(
                f"{path}: only one of it and {paths[0]} has joint {differing[0]!r}; "
                "diagnose recordings with different joints one by one"
            )
        if other.metadata.base != first.metadata.base:
            raise BadRecordingError(
                f"{path}: its base is {other.metadata.base}, that of {paths[0]} is "
                f"{first.metadata.base}; diagnose them one by one"
            )


def _names(paths: Sequence[Path]) -> list[str]:
    """File names without endings; with their folder where two would be the same."""
    stems = Counter(path.stem for path in paths)
    names = [
        path.stem if stems[path.stem] == 1 else f"{path.parent.name}/{path.stem}"
        for path in paths
    ]
    twice = [name for name, times in Counter(names).items() if times > 1]
    if twice:
        raise BadRecordingError(f"the recording {twice[0]} is given twice")
    return names

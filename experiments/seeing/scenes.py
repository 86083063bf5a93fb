"""Makes scenes (recording, robot and ground) from recordings and their metadata."""

import dataclasses
import re
from collections import Counter
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING

import robots
from diagnosis import load_plant
from experiments.runs.folder import RECORDINGS
from groundwalk.errors import (
    BadModelError,
    BadRecordingError,
    BadValueError,
    UnknownNameError,
)
from terrain import Heightfield, TerrainSpec
from worlds import Recording, RecordingMetadata, read_recording
from worlds.recordings.stated_model import stated_model
from worlds.scenes.mechanism import mechanism
from worlds.scenes.scene import Scene

if TYPE_CHECKING:
    from diagnosis.plant.plant import Base


def read_recordings(folder: Path) -> dict[str, Recording]:
    """Read every Parquet recording of a folder, which need not exist, by scene name.

    The name is "sim/tuned" for the file `sim_tuned.parquet`; those of the sim come
    first.
    """
    paths = sorted(
        folder.glob("*.parquet"),
        key=lambda path: (not path.stem.startswith("sim"), path.stem),
    )
    names = scene_names(path.stem.replace("_", "/", 1) for path in paths)
    return dict(zip(names, map(read_with_model, paths), strict=True))


def read_run(folder: Path) -> dict[str, Recording]:
    """Read every recording of a run, and of the runs in its subfolders, by scene name.

    A name is "sim/tuned", or in a subfolder "nao/sim/tuned": the folder of `groundwalk
    humanoids` has a run for each robot.
    """
    recordings = read_recordings(folder / RECORDINGS)
    inside = sorted(path.parent for path in folder.glob(f"*/{RECORDINGS}"))
    stems = scene_names(path.name for path in inside)
    for stem, path in zip(stems, inside, strict=True):
        for name, recording in read_recordings(path / RECORDINGS).items():
            recordings[f"{stem}/{name}"] = recording
    return recordings


def read_with_model(path: Path) -> Recording:
    """Read a recording; its model file may also be in the folder of the recording."""
    recording = read_recording(path)
    metadata = dataclasses.replace(
        recording.metadata, robot=stated_model(path, recording)
    )
    return dataclasses.replace(recording, metadata=metadata)


def scene_names(texts: Iterable[str]) -> list[str]:
    """Turn texts into different names that Rerun's entity paths may contain."""
    taken: Counter[str] = Counter()
    names = []
    for text in texts:
        parts = re.sub(r"[^A-Za-z0-9_./-]+", "-", text).split("/")
        name = "/".join(part.lstrip("_.-") or "unnamed" for part in parts)
        taken[name] += 1
        names.append(name if taken[name] == 1 else f"{name}-{taken[name]}")
    return names


def make_scenes(recordings: Mapping[str, Recording]) -> list[Scene]:
    """Make scenes of recordings by name, with robot and ground of their metadata."""
    scenes = []
    for name, recording in recordings.items():
        try:
            robot, ground = _robot(recording), _ground(recording.metadata)
        except (UnknownNameError, BadModelError, BadValueError) as error:
            raise BadRecordingError(f"recording {name}: {error}") from error
        scenes.append(Scene(name, recording, robot, ground))
    return scenes


def _robot(recording: Recording) -> robots.Description:
    """The robot of a recording: a biped, or any model with hinge and slide joints."""
    robot = recording.metadata.robot
    base: Base = "floating" if recording.metadata.base == "floating" else "fixed"
    try:
        return robots.get(robot)
    except (UnknownNameError, BadModelError) as walks:
        try:
            plant = load_plant(robot, base, recording.joints)
        except UnknownNameError:
            raise walks from None
        return mechanism(plant.model, plant.name)


def _ground(metadata: RecordingMetadata) -> Heightfield | None:
    """Make the ground that the metadata name; None if they name none."""
    if metadata.terrain is None:
        return None
    whole = {"parameters": {}, "seed": 0, **metadata.terrain}
    return TerrainSpec.from_json(whole).make()

"""Recordings as scenes: with the robot and the ground that they name."""

import re
from collections import Counter
from collections.abc import Iterable, Mapping
from pathlib import Path

import robots
from groundwalk.errors import BadRecordingError, BadValueError, UnknownNameError
from terrain import Heightfield, TerrainSpec
from worlds import Recording, RecordingMetadata, read_recording
from worlds.scenes.scene import Scene


def read_recordings(folder: Path) -> dict[str, Recording]:
    """Read every Parquet recording of a folder.

    Args:
      folder: with files such as `sim_tuned.parquet`; it need not be there.

    Returns:
      Recordings by scene name, "sim/tuned" for that file; those of the sim first.
    """
    paths = sorted(folder.glob("*.parquet"), key=_order)
    names = scene_names(path.stem.replace("_", "/", 1) for path in paths)
    return dict(zip(names, map(read_recording, paths), strict=True))


def scene_names(texts: Iterable[str]) -> list[str]:
    """Texts as names that scenes can have, no two of them the same."""
    taken: Counter[str] = Counter()
    names = []
    for text in texts:
        parts = re.sub(r"[^A-Za-z0-9_./-]+", "-", text).split("/")
        name = "/".join(part.lstrip("_.-") or "unnamed" for part in parts)
        taken[name] += 1
        names.append(name if taken[name] == 1 else f"{name}-{taken[name]}")
    return names


def make_scenes(recordings: Mapping[str, Recording]) -> list[Scene]:
    """Set recordings on their grounds, with their robots.

    Args:
      recordings: by the scene's name; what a recording's metadata say counts.

    Raises:
      BadRecordingError: a robot or a ground is none that is known here.
    """
    return [_scene(name, recording) for name, recording in recordings.items()]


def _scene(name: str, recording: Recording) -> Scene:
    try:
        description = robots.get(recording.metadata.robot)
        ground = _ground(recording.metadata)
    except (UnknownNameError, BadValueError) as error:
        raise BadRecordingError(f"recording {name}: {error}") from error
    return Scene(name, recording, description, ground)


def _ground(metadata: RecordingMetadata) -> Heightfield | None:
    """What was walked on, made again; None where the recording does not say."""
    if metadata.terrain is None:
        return None
    whole = {"parameters": {}, "seed": 0, **metadata.terrain}
    return TerrainSpec.from_json(whole).make()


def _order(path: Path) -> tuple[bool, str]:
    return not path.stem.startswith("sim"), path.stem

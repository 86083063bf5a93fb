"""Finds the robot model that a recording states in its metadata."""

from pathlib import Path

from worlds.recordings.recording import Recording

MODEL_FILES = (".xml", ".urdf")
"""Endings of the files of robot models."""


def stated_model(path: Path, recording: Recording) -> str:
    """The name or file of the model that the recording read from `path` states.

    A model file is looked for beside the recording first, so that the two can be moved
    together, then from the current folder on.

    Example:
      >>> stated_model(Path("logs/a.parquet"), read_recording(Path("logs/a.parquet")))
      'logs/a.nominal.urdf'
    """
    stated = recording.metadata.robot
    beside = path.parent / stated
    is_file = beside.suffix.lower() in MODEL_FILES and beside.is_file()
    return str(beside) if is_file else stated

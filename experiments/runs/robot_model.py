"""The robot model of a verb that reads recordings: a given one, or theirs."""

from collections.abc import Sequence
from pathlib import Path

from diagnosis import Plant, load_plant
from diagnosis.plant.differences import differences
from diagnosis.plant.plant import Base
from diagnosis.traces.read import recording_files
from groundwalk.errors import BadRecordingError, GroundwalkError
from worlds import Recording, read_recording
from worlds.recordings.stated_model import stated_model


def robot_model(recordings: Sequence[Path], given: str) -> str:
    """The name or file of the model: `given`, or else that which all recordings state.

    Raises:
      BadRecordingError: none is given, and there is none that recordings state, or they
        state different ones.

    Example:
      >>> robot_model([Path("a.parquet")], "")
      'a.nominal.urdf'
    """
    if given:
        return given
    files = recording_files(recordings)
    read = [read_recording(path) for path in files]
    stated = list(map(stated_model, files, read))
    for path, own in zip(files, stated, strict=True):
        if not _same(own, stated[0]):
            raise BadRecordingError(
                f"{files[0]} states the model {stated[0]}, {path} {own}: give the one "
                "to be used with --robot"
            )
    try:
        _plant(stated[0], read[0])
    except GroundwalkError as error:
        raise BadRecordingError(
            f"no model is given, and {stated[0]!r}, which {files[0]} states, is none "
            f"({_short(error)}): give one with --robot"
        ) from error
    return stated[0]


def model_note(recordings: Sequence[Path], used: str) -> str:
    """In what the model used differs from the one that the first recording states.

    Empty if they do not differ, or if the stated one cannot be found.
    """
    first = recording_files(recordings)[0]
    recording = read_recording(first)
    stated = stated_model(first, recording)
    if _same(stated, used):
        return ""
    try:
        told = differences(_plant(stated, recording), _plant(used, recording))
    except GroundwalkError:
        return ""
    if not told:
        return ""
    return (
        f"{first} states the model {stated}, from which {used} differs in "
        f"{', '.join(told)}"
    )


def _plant(model: str, recording: Recording) -> Plant:
    base: Base = "floating" if recording.metadata.base == "floating" else "fixed"
    return load_plant(model, base, recording.joints)


def _same(one: str, other: str) -> bool:
    """Whether two texts are the same name, or files with the same content."""
    paths = Path(one), Path(other)
    if one == other or not all(path.is_file() for path in paths):
        return one == other
    return paths[0].read_bytes() == paths[1].read_bytes()


def _short(error: GroundwalkError) -> str:
    """An error's text without its list of known names, which is long."""
    return str(error).partition(": known are")[0]

"""Which program a file or folder comes from."""

from pathlib import Path
from typing import Literal

from groundwalk.errors import ForeignFileError

Kind = Literal["table", "bag", "lerobot", "bam", "pace"]

_ENDINGS: dict[str, Kind] = {
    ".csv": "table",
    ".tsv": "table",
    ".txt": "table",
    ".db3": "bag",
    ".mcap": "bag",
    ".json": "bam",
    ".npz": "pace",
    ".pt": "pace",
}

_MARKS: dict[str, Kind] = {"meta/info.json": "lerobot", "metadata.yaml": "bag"}
"""Files by which folders that are one source are known."""


def sources_in(path: Path) -> list[Path]:
    """A source itself, or the files of known kinds in a folder that is none, by name.

    Raises:
      ForeignFileError: a folder is no source, and holds none.

    Example:
      >>> sources_in(Path("logs"))
      [PosixPath('logs/chirp.csv'), PosixPath('logs/ramps.csv')]
    """
    if not path.is_dir() or any((path / one).is_file() for one in _MARKS):
        return [path]
    found = sorted(one for one in path.iterdir() if one.suffix.lower() in _ENDINGS)
    if not found:
        raise ForeignFileError(
            f"{path}: neither a bag (metadata.yaml), nor a LeRobot data set "
            f"(meta/info.json), nor a file that is read ({', '.join(_ENDINGS)}) is in "
            "this folder"
        )
    return found


def kind_of(path: Path) -> Kind:
    """The kind of a source, from its ending or from what a folder holds.

    Raises:
      ForeignFileError: it is not there, or of no kind that is read.
    """
    if not path.exists():
        raise ForeignFileError(f"{path}: no such file or folder")
    if path.is_dir():
        for mark, kind in _MARKS.items():
            if (path / mark).is_file():
                return kind
        raise ForeignFileError(
            f"{path}: neither a bag (metadata.yaml) nor a LeRobot data set "
            "(meta/info.json) is in this folder"
        )
    ending = path.suffix.lower()
    if ending == ".bag":
        raise ForeignFileError(
            f"{path}: a bag of ROS 1; make one of ROS 2 of it: rosbags-convert --src "
            f"{path.name} --dst {path.stem}"
        )
    if ending not in _ENDINGS:
        raise ForeignFileError(
            f"{path}: no known kind of file; read are {', '.join(_ENDINGS)}, and the "
            "folders of bags and of LeRobot data sets"
        )
    return _ENDINGS[ending]

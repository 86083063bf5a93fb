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


def kind_of(path: Path) -> Kind:
    """The kind of a source, from its ending or from what a folder holds.

    Raises:
      ForeignFileError: it is not there, or of no kind that is read.
    """
    if not path.exists():
        raise ForeignFileError(f"{path}: no such file or folder")
    if path.is_dir():
        if (path / "meta" / "info.json").is_file():
            return "lerobot"
        if (path / "metadata.yaml").is_file():
            return "bag"
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

"""Files that a URDF names, and the URDFs of example-robot-data."""

import os
from collections import Counter
from functools import cache
from importlib.metadata import PackageNotFoundError, files
from pathlib import Path

from groundwalk.errors import BadModelError

_COLLECTION = "example-robot-data"
_PACKAGE, _FILE = "package://", "file://"


@cache
def example_robots() -> dict[str, Path]:
    """URDF files of the installed example-robot-data by name.

    The name is the file's stem, such as "go2"; where two files share it, their
    folder's name stands before it, such as "anymal_b_simple_description/anymal".
    """
    try:
        listed = files(_COLLECTION) or []
    except PackageNotFoundError:
        return {}
    found = [file for file in listed if file.suffix == ".urdf"]
    times = Counter(file.stem for file in found)
    return {
        file.stem if times[file.stem] == 1 else f"{file.parts[-3]}/{file.stem}": Path(
            str(file.locate())
        )
        for file in found
    }


def mesh_path(urdf: Path, name: str) -> Path:
    """Where a file is that a URDF names.

    A `package://NAME/...` is looked for where ROS would, in the folders of the
    environment's ROS_PACKAGE_PATH, and then in the folders that the URDF lies in, one
    of which is usually the package or holds it.

    Raises:
      BadModelError: there is no such file.
    """
    if not name.startswith(_PACKAGE):
        path = Path(name.removeprefix(_FILE))
        tried = [path if path.is_absolute() else urdf.parent / path]
    else:
        package, _, rest = name.removeprefix(_PACKAGE).partition("/")
        roots = [Path(root) for root in _ros_folders()] + list(urdf.resolve().parents)
        inside = [root / package / rest for root in roots]
        tried = inside + [root / rest for root in roots if root.name == package]
    for path in tried:
        if path.is_file():
            return path
    raise BadModelError(
        f"{urdf}: {name} is not found; set ROS_PACKAGE_PATH to the folder that holds "
        "its package"
    )


def _ros_folders() -> list[str]:
    paths = os.environ.get("ROS_PACKAGE_PATH", "").split(os.pathsep)
    return [path for path in paths if path]

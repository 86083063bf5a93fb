"""Finds files that a URDF names, and the URDFs in the package example-robot-data."""

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
    """URDF files of the Python package example-robot-data, by name; none without it.

    A name is the file's stem, such as "go2"; if two files have the same stem, the name
    starts with their folder's, such as "anymal_b_simple_description/anymal".
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
    """Find a file that a URDF names by a path, or file:// or package:// address.

    An address `package://NAME/...` is searched in the folders of the environment
    variable ROS_PACKAGE_PATH, as in ROS; then in the folders above the URDF, one of
    which is usually the package or contains it; last where example-robot-data is
    installed, so that a copy of one of its URDFs works anywhere.
    """
    if not name.startswith(_PACKAGE):
        path = Path(name.removeprefix(_FILE))
        tried = [path if path.is_absolute() else urdf.parent / path]
    else:
        package, _, rest = name.removeprefix(_PACKAGE).partition("/")
        roots = [*_ros_folders(), *urdf.resolve().parents, *_example_folders()]
        inside = [root / package / rest for root in roots]
        tried = inside + [root / rest for root in roots if root.name == package]
    for path in tried:
        if path.is_file():
            return path
    raise BadModelError(
        f"{urdf}: {name} is not found; set ROS_PACKAGE_PATH to the folder that holds "
        "its package"
    )


def _ros_folders() -> list[Path]:
    paths = os.environ.get("ROS_PACKAGE_PATH", "").split(os.pathsep)
    return [Path(path) for path in paths if path]


@cache
def _example_folders() -> tuple[Path, ...]:
    """Installed folders in which packages of example-robot-data lie; () without it."""
    some = next(iter(example_robots().values()), None)
    if some is None:
        return ()
    package = next((one for one in some.parents if one.name == _COLLECTION), None)
    return () if package is None else (package.parent, package / "robots")

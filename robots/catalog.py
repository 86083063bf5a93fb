"""Makes descriptions of robots from their names or files."""

import dataclasses
import tomllib
from functools import cache
from pathlib import Path

from groundwalk.errors import BadModelError, UnknownNameError
from robots.description import Description
from robots.from_urdf.adaptation import Adaptation, read_adaptation
from robots.from_urdf.adapter import adapted
from robots.read_description import read_description

_FOLDER = Path(__file__).parent
_URDF, _TOML = ".urdf", ".toml"


def names() -> list[str]:
    """List the names of the built-in robots.

    Example:
      >>> "nao" in robots.names()
      True
    """
    return sorted(path.stem for path in _FOLDER.glob(f"*{_TOML}"))


@cache
def get(name: str) -> Description:
    """Describe a robot by its name, or from a file.

    A file is a URDF (.urdf) of a robot on two legs, or a TOML file (.toml) like
    robots/nao.toml or that completes a URDF. GroundwalkError if there is no such robot,
    or the file holds no robot that walks on two legs; the message says why.

    Example:
      >>> get("nao").joints[:2]
      ('LHipYawPitch', 'LHipRoll')
    """
    path = Path(name)
    if path.suffix.lower() not in (_URDF, _TOML):
        if name not in names():
            raise UnknownNameError("robot", name, names())
        path = _FOLDER / f"{name}{_TOML}"
    if not path.is_file():
        raise BadModelError(f"{path}: no such file")
    if path.suffix.lower() == _URDF:
        return adapted(name, Adaptation(urdf=path.name), path.parent)
    if "urdf" in _keys(path):
        return adapted(name, read_adaptation(path), path.parent)
    description = read_description(path)
    own = path.parent != _FOLDER
    return dataclasses.replace(description, name=name) if own else description


def _keys(path: Path) -> set[str]:
    try:
        return set(tomllib.loads(path.read_text()))
    except (OSError, tomllib.TOMLDecodeError) as error:
        raise BadModelError(f"{path} is no robot: {error}") from error

"""The robots that there are, by name."""

from functools import cache
from pathlib import Path

from groundwalk.errors import UnknownNameError
from robots.description import Description
from robots.read_description import read_description

_FOLDER = Path(__file__).parent


def names() -> list[str]:
    """Every name that `get` knows."""
    return sorted(path.stem for path in _FOLDER.glob("*.toml"))


@cache
def get(name: str) -> Description:
    """The robot of that name.

    Raises:
      UnknownNameError: there is none.
    """
    if name not in names():
        raise UnknownNameError("robot", name, names())
    return read_description(_FOLDER / f"{name}.toml")

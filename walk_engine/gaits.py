"""The gaits that have a name."""

from groundwalk.errors import UnknownNameError
from walk_engine.gait import PARAMETERS, Gait

_WALK2014 = Gait(tuple(parameter.default for parameter in PARAMETERS))

_GAITS = {
    # The constants of the 2014 code release, asked to walk as fast as it allowed.
    "walk2014": _WALK2014,
    # The same at a modest speed: where a search starts.
    "start": _WALK2014.replace(max_forward=0.23),
}


def names() -> tuple[str, ...]:
    """The names that `get` knows."""
    return tuple(_GAITS)


def get(name: str) -> Gait:
    """The gait of that name.

    Raises:
      UnknownNameError: there is none of that name.
    """
    if name not in _GAITS:
        raise UnknownNameError("gait", name, _GAITS)
    return _GAITS[name]

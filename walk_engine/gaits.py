"""Built-in gaits: "walk2014", and the slower "start", from which searches begin."""

from groundwalk.errors import UnknownNameError
from walk_engine.gait import PARAMETERS, Gait

_WALK2014 = Gait(tuple(parameter.default for parameter in PARAMETERS))

_GAITS = {
    # The constants of the 2014 code release, at the largest speed that it allowed.
    "walk2014": _WALK2014,
    # The same constants at a modest speed.
    "start": _WALK2014.replace(max_forward=0.23),
}


def names() -> tuple[str, ...]:
    """Names of the built-in gaits."""
    return tuple(_GAITS)


def get(name: str) -> Gait:
    """Look up a built-in gait by its name; else UnknownNameError.

    Example:
      >>> get("start")["max_forward"]
      0.23
    """
    if name not in _GAITS:
        raise UnknownNameError("gait", name, _GAITS)
    return _GAITS[name]

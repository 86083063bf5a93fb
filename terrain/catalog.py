"""The families of terrain by name."""

import dataclasses
from collections.abc import Mapping
from types import MappingProxyType

from groundwalk.errors import UnknownNameError
from terrain.bumps import Bumps
from terrain.flat import Flat
from terrain.ground import Ground
from terrain.heightfield import Heightfield
from terrain.lumps import Lumps
from terrain.seeds import Seed
from terrain.slope import Slope
from terrain.stairs import Stairs
from terrain.waves import Waves

FAMILIES: Mapping[str, type[Ground]] = MappingProxyType(
    {
        "flat": Flat,
        "lumps": Lumps,
        "bumps": Bumps,
        "slope": Slope,
        "stairs": Stairs,
        "waves": Waves,
    }
)
"""Every family by name, in the order in which stress tests list them. A new family is
a file with its class, and its import and its line here."""


def names() -> tuple[str, ...]:
    """Names of all families, in alphabetical order."""
    return tuple(sorted(FAMILIES))


def configuration(name: str, /, **parameters: object) -> Ground:
    """Configure a family of terrain.

    Args:
      name: one of `names()`.
      **parameters: fields of the family's dataclass; others keep their defaults.

    Returns:
      The family's frozen dataclass, for example `Lumps`.

    Raises:
      UnknownNameError: there is no such family, or it has no such parameter.
      BadValueError: a parameter has a value that it cannot take.
    """
    if name not in FAMILIES:
        raise UnknownNameError("terrain", name, FAMILIES)
    family = FAMILIES[name]
    known = {field.name for field in dataclasses.fields(family)}
    for parameter in parameters:
        if parameter not in known:
            raise UnknownNameError(f"parameter of terrain {name!r}", parameter, known)
    return family(**parameters)  # type: ignore[arg-type]  # checked at run time


def make(name: str, /, seed: Seed, **parameters: object) -> Heightfield:
    """Make the ground of a family that belongs to a seed.

    Args:
      name: one of `names()`.
      seed: a whole number of 0 or more, or a seed sequence.
      **parameters: see `configuration`, also for the errors.
    """
    return configuration(name, **parameters).make(seed)

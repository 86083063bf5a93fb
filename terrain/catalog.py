"""Finds families of terrain (flat, lumps, bumps, slope, stairs, waves) by name."""

import dataclasses
from collections.abc import Mapping

from groundwalk.errors import UnknownNameError
from terrain.bumps import Bumps
from terrain.ground import Ground, Seed
from terrain.heightfield import Heightfield
from terrain.lumps import Lumps
from terrain.regular import Flat, Slope, Stairs, Waves

FAMILIES: Mapping[str, type[Ground]] = {
    "flat": Flat,
    "lumps": Lumps,
    "bumps": Bumps,
    "slope": Slope,
    "stairs": Stairs,
    "waves": Waves,
}
"""Every family of terrain by name, in the order in which terrain-stress lists them. To
add a family, write its class and add it here."""


def names() -> tuple[str, ...]:
    """List the names of all families of terrain, in alphabetical order.

    Example:
      >>> terrain.names()
      ('bumps', 'flat', 'lumps', 'slope', 'stairs', 'waves')
    """
    return tuple(sorted(FAMILIES))


def configuration(name: str, /, **parameters: object) -> Ground:
    """Choose a family of terrain by name and its parameters, without heights yet.

    Raises:
      UnknownNameError: there is no such family, or it has no such parameter.
      BadValueError: a parameter has a value that it cannot take.

    Example:
      >>> terrain.configuration("stairs", steps=3).steps
      3
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
    """Make the ground of a family of terrain; the same seed makes the same ground.

    The seed is a whole number of 0 or more, or a NumPy `SeedSequence`; parameters that
    are not given keep their defaults.

    Raises:
      UnknownNameError: there is no such family, or it has no such parameter.
      BadValueError: a parameter or the seed has a value that it cannot take.

    Example:
      >>> terrain.make("lumps", 7, amplitude_m=0.012).heights_m.shape
      (161, 241)
    """
    return configuration(name, **parameters).make(seed)

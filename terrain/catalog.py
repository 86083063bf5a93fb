"""Terrains by name, parameters and seed: as a value, in JSON, on a command line."""

import dataclasses
from collections.abc import Mapping
from dataclasses import dataclass, field

from groundwalk.errors import BadValueError, UnknownNameError
from groundwalk.json_data import from_plain, to_plain
from terrain.families import Bumps, Flat, Lumps, Slope, Stairs, Waves
from terrain.ground import Ground, Parameter, Seed, checked_seed
from terrain.heightfield import Heightfield

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

    UnknownNameError for another name or parameter, BadValueError for another value.

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
    are not given keep their defaults. UnknownNameError for another name or parameter,
    BadValueError for another value.

    Example:
      >>> terrain.make("lumps", 7, amplitude_m=0.012).heights_m.shape
      (161, 241)
    """
    return configuration(name, **parameters).make(seed)


@dataclass(frozen=True)
class TerrainSpec:
    """Name, parameters and seed of a terrain: enough to make the same ground again.

    Attributes:
      name: one of `terrain.names()`.
      parameters: parameters of the family of terrain. Defaults are filled in when the
        spec is made, so that it means the same ground even if they change later.
      seed: a whole number of 0 or more.

    Example:
      >>> spec = TerrainSpec("stairs", {"steps": 3}, seed=1)
      >>> TerrainSpec.from_json(spec.to_json()) == spec
      True
    """

    name: str
    parameters: Mapping[str, Parameter] = field(default_factory=dict, hash=False)
    seed: int = 0

    def __post_init__(self) -> None:
        """Check name, parameters and seed, and fill in missing parameters' defaults."""
        ground = configuration(self.name, **self.parameters)
        object.__setattr__(self, "parameters", dataclasses.asdict(ground))
        object.__setattr__(self, "seed", checked_seed(self.seed))

    def make(self) -> Heightfield:
        """Make the ground's heightfield, with the same bits every time."""
        return configuration(self.name, **self.parameters).make(self.seed)

    def to_json(self) -> dict[str, object]:
        """Convert the spec to an object that `json.dumps` can write."""
        plain: dict[str, object] = to_plain(self)
        return plain

    @classmethod
    def from_json(cls, data: object) -> "TerrainSpec":
        """Make a spec from an object that `to_json` returned; else GroundwalkError."""
        return from_plain(cls, data, "terrain")


def parse(text: str) -> tuple[str, dict[str, Parameter]]:
    """Read a terrain such as `lumps:amplitude_m=0.012,x_range_m=-1:8`.

    The result is the name, and the parameters for `terrain.make` and `TerrainSpec`;
    UnknownNameError for another name or parameter, BadValueError for another value.

    Example:
      >>> terrain.parse("stairs:steps=3")
      ('stairs', {'steps': 3})
    """
    name, colon, rest = text.partition(":")
    parameters: dict[str, Parameter] = {}
    for item in rest.split(",") if colon else ():
        parameter, equals, value = item.partition("=")
        if not equals:
            raise BadValueError(f"{item!r} in terrain {text!r} must be parameter=value")
        if parameter in parameters:
            raise BadValueError(f"{parameter} is given twice in terrain {text!r}")
        parameters[parameter] = _value(parameter, value)
    configuration(name, **parameters)
    return name, parameters


def _value(parameter: str, text: str) -> Parameter:
    """Read a parameter's value: a whole number, a number, or a range low:high."""
    try:
        if ":" in text:
            low, high = text.split(":")
            return float(low), float(high)
        return int(text) if text.lstrip("+-").isdecimal() else float(text)
    except ValueError:
        raise BadValueError(
            f"{parameter} must be a number or low:high, not {text!r}"
        ) from None

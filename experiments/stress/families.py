"""Families of ground for the terrain stress test, each a ladder of severities.

The ladders of shapes are defined in the classes of `terrain`, those of friction and
softness here.
"""

import dataclasses
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any

from groundwalk.errors import UnknownNameError
from robots import Description, biped
from terrain import TerrainSpec
from terrain.catalog import FAMILIES as GROUNDS
from terrain.ground import Ladder
from worlds import WorldOptions

FLAT = "flat"
"""Name of the family for comparison, which has no severity: hard, level ground."""


@dataclass(frozen=True)
class Family(Ladder):
    """A family of ground that is difficult to walk on, by its shape or its material.

    `options` gives, for a severity, the changed world options by name.
    """

    terrain: str = FLAT
    options: Callable[[float], dict[str, float]] = lambda severity: {}


FAMILIES: Mapping[str, Family] = MappingProxyType(
    {
        name: Family(**vars(ladder), terrain=terrain)
        for terrain, ground in GROUNDS.items()
        for name, ladder in ground.ladders.items()
    }
    | {
        "friction": Family(
            "coefficient", "1", 0.6, 0.02, options=lambda mu: {"friction": mu}
        ),
        "softness": Family(
            "sinkage on one foot",
            "m",
            0.004,
            0.06,
            options=lambda depth_m: {"sinkage_m": depth_m},
        ),
    }
)
"""Families of ground by name, in the order of the tables."""


@dataclass(frozen=True)
class Place:
    """A family of ground (or `FLAT`) at one severity, for a robot in a world.

    The severity is in the unit of the family; 0 for `FLAT`.
    """

    robot: str
    world: str
    family: str
    severity: float

    def __post_init__(self) -> None:
        """Refuse an unknown family of ground."""
        if self.family not in (FLAT, *FAMILIES):
            raise UnknownNameError("family of ground", self.family, FAMILIES)

    @property
    def label(self) -> str:
        """A short name of family and severity, such as "lumps-0.006"."""
        return f"{self.family}-{self.severity:.3g}" if self.severity else self.family

    def ground(self, leg_m: float, begin: float, seed: int) -> TerrainSpec:
        """The ground of one trial, for a leg of this length [m].

        It is flat around the start, with the radius `begin` in leg lengths.
        """
        name, parameters = FLAT, {}
        if self.family != FLAT:
            family = FAMILIES[self.family]
            name = family.terrain
            parameters = dict(family.parameters(self.severity, leg_m))
        around: dict[str, Any] = {
            "x_range_m": (-4 * leg_m, 11 * leg_m),
            "y_range_m": (-8 * leg_m, 8 * leg_m),
            "spacing_m": 0.1 * leg_m,
            "start_radius_m": begin * leg_m,
            "blend_m": 0.5 * leg_m,
        }
        return TerrainSpec(name, around | parameters, seed)

    def options(self, usual: WorldOptions) -> WorldOptions:
        """The world's usual options, with the friction or softness of this family."""
        if self.family == FLAT:
            return usual
        changes: dict[str, Any] = FAMILIES[self.family].options(self.severity)
        return dataclasses.replace(usual, **changes)


def leg_length_m(description: Description) -> float:
    """Length of a robot's straight leg from hip to sole [m]."""
    leg = biped(description).leg
    return leg.thigh_m + leg.tibia_m + leg.ankle_height_m

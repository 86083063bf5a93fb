"""Families of ground, and the ladders of severity that a gait climbs in each."""

import dataclasses
import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any

import numpy as np

from groundwalk.arrays import FloatArray
from groundwalk.errors import UnknownNameError
from robots import Description, biped
from terrain import TerrainSpec
from worlds import WorldOptions

FLAT = "flat"
"""The family without severity: hard, level ground, for comparison."""


@dataclass(frozen=True)
class Family:
    """One way in which ground can be hard to walk on.

    Attributes:
      quantity: what its severity is.
      unit: of the severity: "m", "rad" or "1".
      mildest, hardest: ends of the ladder; lengths as shares of the leg's length. The
        hardest may be the smaller number, as of friction.
      terrain: name and parameters of the ground at a severity, the leg's length given.
      options: what changes in the world at a severity.
    """

    quantity: str
    unit: str
    mildest: float
    hardest: float
    terrain: Callable[[float, float], tuple[str, dict[str, float]]] = (
        lambda severity, leg_m: (FLAT, {})
    )
    options: Callable[[float], dict[str, float]] = lambda severity: {}

    def ladder(self, rungs: int, leg_m: float) -> FloatArray:
        """(rungs,) severities in SI units from the mildest on, in equal ratios."""
        scale = leg_m if self.unit == "m" else 1.0
        return np.geomspace(self.mildest * scale, self.hardest * scale, rungs)


def _slope(heading_rad: float) -> Family:
    return Family(
        "angle", "rad", 0.03, 0.25,
        lambda angle, leg: (
            "slope", {"angle_rad": angle, "heading_rad": heading_rad}
        ),
    )  # fmt: skip


FAMILIES: Mapping[str, Family] = MappingProxyType(
    {
        "lumps": Family(
            "amplitude", "m", 0.008, 0.08,
            lambda height, leg: (
                "lumps", {"amplitude_m": height, "wavelength_m": 0.8 * leg}
            ),
        ),
        "bumps": Family(
            "height", "m", 0.016, 0.16,
            lambda height, leg: (
                "bumps",
                {
                    "height_m": height,
                    "radius_m": 0.32 * leg,
                    "density_per_m2": 2.5 / leg**2,
                },
            ),
        ),
        "slope_up": _slope(0.0),
        "slope_down": _slope(math.pi),
        "slope_side": _slope(math.pi / 2),
        "stairs": Family(
            "step height", "m", 0.008, 0.1,
            lambda height, leg: ("stairs", {"step_m": height, "tread_m": 1.2 * leg}),
        ),
        "waves": Family(
            "amplitude", "m", 0.008, 0.12,
            lambda height, leg: (
                "waves", {"amplitude_m": height, "wavelength_m": 1.6 * leg}
            ),
        ),
        "friction": Family(
            "coefficient", "1", 0.6, 0.02, options=lambda mu: {"friction": mu}
        ),
        "softness": Family(
            "sinkage on one foot", "m", 0.004, 0.06,
            options=lambda depth: {"sinkage_m": depth},
        ),
    }
)  # fmt: skip
"""By name, in the order of the tables."""


@dataclass(frozen=True)
class Place:
    """Where trials are walked: a family of ground at one severity, in a world.

    Attributes:
      robot: its name.
      world: "sim" or "real".
      family: one of `FAMILIES`, or `FLAT`.
      severity: in the family's unit; 0 for `FLAT`.
    """

    robot: str
    world: str
    family: str
    severity: float

    def __post_init__(self) -> None:
        """Refuse a family that there is none of."""
        if self.family not in (FLAT, *FAMILIES):
            raise UnknownNameError("family of ground", self.family, FAMILIES)

    @property
    def label(self) -> str:
        """The place in a few letters, such as "lumps-0.006"."""
        return f"{self.family}-{self.severity:.3g}" if self.severity else self.family

    def ground(self, leg_m: float, begin: float, seed: int) -> TerrainSpec:
        """The ground of one trial.

        Args:
          leg_m: the robot's leg length.
          begin: where it stops being flat, in leg lengths from the start.
          seed: of its randomness.
        """
        name: str = FLAT
        parameters: dict[str, float] = {}
        if self.family != FLAT:
            name, parameters = FAMILIES[self.family].terrain(self.severity, leg_m)
        around: dict[str, Any] = {
            "x_range_m": (-4 * leg_m, 11 * leg_m),
            "y_range_m": (-8 * leg_m, 8 * leg_m),
            "spacing_m": 0.1 * leg_m,
            "start_radius_m": begin * leg_m,
            "blend_m": 0.5 * leg_m,
        }
        return TerrainSpec(name, around | parameters, seed)

    def options(self, usual: WorldOptions) -> WorldOptions:
        """The world's options here."""
        if self.family == FLAT:
            return usual
        changes: dict[str, Any] = FAMILIES[self.family].options(self.severity)
        return dataclasses.replace(usual, **changes)


def leg_length_m(description: Description) -> float:
    """From hip to sole of a straight leg."""
    leg = biped(description).leg
    return leg.thigh_m + leg.tibia_m + leg.ankle_height_m

"""Size of a robot relative to the NAO, by which gaits for the NAO are scaled.

Two walks are similar (Froude) if lengths are in proportion to the legs and times to the
time constant of the inverted pendulum, sqrt(height / g). Then both robots have the same
joint angles at the same phases of a step, and forces in proportion to their weights.
"""

import math
from dataclasses import dataclass

from groundwalk.errors import BadValueError

NAO_HIP_M, NAO_CENTRE_M, NAO_KG = 0.248, 0.277, 5.305
"""Hip height [m], height of the centre of mass [m] and mass [kg] of nao.toml; heights
are above the soles with straight legs and hanging arms."""


@dataclass(frozen=True)
class Scale:
    """A robot's size as ratios to the NAO's.

    The ratio of lengths is that of the hips' heights above the sole, legs straight;
    that of times is the square root of the ratio of the heights of the centre of mass.
    """

    length: float = 1.0
    time: float = 1.0
    weight: float = 1.0

    def __post_init__(self) -> None:
        """Refuse factors that are not positive."""
        for name, value in vars(self).items():
            if not (math.isfinite(value) and value > 0):
                raise BadValueError(f"scale {name} is {value}; it must be positive")

    @classmethod
    def of_robot(cls, hip_m: float, centre_m: float, mass_kg: float) -> "Scale":
        """Size relative to the NAO, from heights above the sole with straight legs [m].

        `hip_m` is that of the hips, `centre_m` that of the centre of mass.
        """
        return cls(
            hip_m / NAO_HIP_M, math.sqrt(centre_m / NAO_CENTRE_M), mass_kg / NAO_KG
        )

    @property
    def speed(self) -> float:
        """Factor from velocities [m/s] of the NAO to those of this robot."""
        return self.length / self.time

    def of(self, unit: str) -> float:
        """Factor from values for the NAO to those for this robot, by their unit.

        Units are "m", "s", "m/s", "rad/s", "rad/m", "N", "1", "m/m" and "rad".
        """
        factors = {
            "m": self.length,
            "s": self.time,
            "m/s": self.speed,
            "rad/s": 1.0 / self.time,
            "rad/m": 1.0 / self.length,
            "N": self.weight,
            "1": 1.0,
            "m/m": 1.0,
            "rad": 1.0,
        }
        return factors[unit]


NAO_SIZE = Scale()

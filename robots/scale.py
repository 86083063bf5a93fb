"""How much larger than the NAO a robot is, so that one gait means the same to both.

Two walks are alike if lengths are in proportion to the legs and times to those of the
inverted pendulum, sqrt(height / g) (Froude's similarity). Then the same angles follow
one another at the same parts of a step, and forces are in proportion to the weight.
"""

import math
from dataclasses import dataclass

from groundwalk.errors import BadValueError

NAO_HIP_M, NAO_CENTRE_M, NAO_KG = 0.248, 0.277, 5.305
"""Of nao.toml, its legs straight and its arms hanging."""


@dataclass(frozen=True)
class Scale:
    """A robot's size in units of the NAO's.

    Attributes:
      length: hip above sole, legs straight.
      time: square root of the centre of mass's height above the soles.
      weight: the weight.
    """

    length: float = 1.0
    time: float = 1.0
    weight: float = 1.0

    def __post_init__(self) -> None:
        """Refuse what no robot has."""
        for name, value in vars(self).items():
            if not (math.isfinite(value) and value > 0):
                raise BadValueError(f"scale {name} is {value}; it must be positive")

    @classmethod
    def of_robot(cls, hip_m: float, centre_m: float, mass_kg: float) -> "Scale":
        """The size of a robot.

        Args:
          hip_m: height of the hip above the sole, the legs straight.
          centre_m: height of the centre of mass above the sole, standing.
          mass_kg: the mass.
        """
        return cls(
            hip_m / NAO_HIP_M, math.sqrt(centre_m / NAO_CENTRE_M), mass_kg / NAO_KG
        )

    @property
    def speed(self) -> float:
        """Of velocities."""
        return self.length / self.time

    def of(self, unit: str) -> float:
        """What a value in that unit is multiplied by.

        Args:
          unit: "m", "s", "m/s", "rad/s", "rad/m", "N", or one without size: "1", "m/m"
            and "rad".
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

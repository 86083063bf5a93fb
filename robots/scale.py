"""How much larger than the NAO a robot is, so that one gait means the same to both.

Two walks are alike if lengths are in proportion to the legs and times to those of the
inverted pendulum, sqrt(height / g) (Froude's similarity). Then the same angles follow
one another at the same parts of a step, and forces are in proportion to the weight.
"""

import math
from dataclasses import dataclass

from groundwalk.errors import BadValueError

NAO_HIP_M, NAO_CENTRE_M, NAO_KG = 0.248, 0.277, 5.305
"""Hip height [m], height of the centre of mass [m] and mass [kg] of nao.toml, with
straight legs and hanging arms."""


@dataclass(frozen=True)
class Scale:
    """A robot's size in units of the NAO's.

    Attributes:
      length: ratio of hip heights above the sole, legs straight.
      time: square root of the ratio of the centre of mass's heights above the soles.
      weight: ratio of the weights.
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
        """Compare a robot with the NAO.

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
        """Factor between velocities of the NAO and of this robot."""
        return self.length / self.time

    def of(self, unit: str) -> float:
        """Factor that turns a value for the NAO into one for this robot.

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

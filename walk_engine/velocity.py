"""Requests to the walk engine: walk at a velocity, halt, or stand up."""

from dataclasses import dataclass

import numpy as np

from groundwalk.arrays import BoolArray, FloatArray
from groundwalk.errors import BadValueError


@dataclass(frozen=True, eq=False)
class Velocity:
    """Requested walking velocity, for all robots (numbers) or each (arrays (n,)).

    A request of zero keeps a robot crouched and ready to walk. Speeds beyond the gait's
    `max_forward` or the engine's limits are clipped: infinity means as fast as allowed.

    Attributes:
      forward_m_s: speed in the direction in which the robot faces [m/s].
      left_m_s: speed to its left [m/s].
      turn_rad_s: rate of turn to the left [rad/s].
      stand: True asks to halt and to straighten the legs, whatever the velocity.

    Example:
      >>> Velocity(forward_m_s=0.1, turn_rad_s=0.2).forward_m_s
      0.1
    """

    forward_m_s: float | FloatArray = 0.0
    left_m_s: float | FloatArray = 0.0
    turn_rad_s: float | FloatArray = 0.0
    stand: bool | BoolArray = False

    def __post_init__(self) -> None:
        """Refuse speeds that are NaN."""
        for name in ("forward_m_s", "left_m_s", "turn_rad_s"):
            if np.isnan(getattr(self, name)).any():
                raise BadValueError(f"velocity {name} is NaN; it must be a number")

    @classmethod
    def forward(cls) -> "Velocity":
        """Request to walk straight ahead at the gait's `max_forward` speed."""
        return cls(forward_m_s=np.inf)

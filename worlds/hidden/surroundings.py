"""Signal delays, gyroscope bias and ground of a robot with hidden effects."""

import math
from dataclasses import dataclass, field

import numpy as np

from groundwalk.arrays import FloatArray
from groundwalk.gravity import GRAVITY_M_S2
from terrain import Heightfield, Lumps

_HALF_SIDE_M = 3.0
"""Half the side of the square ground [m]; walks of 6 s stay well within it."""
_BUMP_WAVELENGTH_M = 0.2
"""Shortest wavelength of bumps [m]: about the length of a NAO's foot."""
_BUMP_BLEND_M = 0.05


@dataclass(eq=False)
class Surroundings:
    """Signal delays, gyroscope bias and ground of a robot; all zero without effects.

    Commands reach the servos, and encoders are read, with a delay; the gyroscope's bias
    (3,) is in the base's frame. The ground, or a fixed base's mount, dips towards the
    front (x) by the pitch and rises towards the left (y) by the roll. `bumps_m` is the
    height of bumps under a floating robot, `friction` that of its soles; None for the
    nominal one.
    """

    command_delay_s: float = 0.0
    encoder_delay_s: float = 0.0
    gyroscope_bias_rad_s: FloatArray = field(default_factory=lambda: np.zeros(3))
    pitch_rad: float = 0.0
    roll_rad: float = 0.0
    bumps_m: float = 0.0
    friction: float | None = None

    def tilt(self) -> FloatArray:
        """(3, 3) rotation R_y(pitch) R_x(roll) from the ground's frame to upright."""
        cos, sin = math.cos(self.pitch_rad), math.sin(self.pitch_rad)
        about_y = np.array([[cos, 0, sin], [0, 1, 0], [-sin, 0, cos]])
        cos, sin = math.cos(self.roll_rad), math.sin(self.roll_rad)
        about_x = np.array([[1, 0, 0], [0, cos, -sin], [0, sin, cos]])
        return np.asarray(about_y @ about_x)

    def gravity_m_s2(self) -> FloatArray:
        """(3,) gravity [m/s^2] in the frame of the tilted ground or mount."""
        return np.asarray(self.tilt().T @ np.array([0, 0, -GRAVITY_M_S2]))

    def ground(self, seed: np.random.SeedSequence) -> Heightfield:
        """The ground under a floating robot: a plane, or random bumps everywhere."""
        low, high = -_HALF_SIDE_M, _HALF_SIDE_M
        if self.bumps_m == 0:
            return Heightfield(np.zeros((2, 2)), (low, low), high - low)
        lumps = Lumps(
            amplitude_m=self.bumps_m,
            wavelength_m=_BUMP_WAVELENGTH_M,
            x_range_m=(low, high),
            y_range_m=(low, high),
            start_radius_m=0.0,
            blend_m=_BUMP_BLEND_M,
        )
        return lumps.make(seed)

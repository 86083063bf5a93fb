"""Sizes servos of a robot of which only effort and speed of its motors are known.

Gains follow from a natural frequency and a damping ratio about a reflected inertia,
kp = I (w^2 + g / h) and kd = 2 z I w. For a leg's joint that is the whole robot on one
ankle, I = m h^2 with the centre of mass at h above the sole, an inverted pendulum that
gravity topples with m g h: in the stance all joints of the leg carry it in a row. For
any other joint it is what hangs on the joint. Frequencies are in units of the
pendulum's own, sqrt(g / h), so that a robot of any size stands as firmly as the NAO.
"""

import math
from dataclasses import dataclass

from groundwalk.errors import BadValueError
from groundwalk.gravity import GRAVITY_M_S2
from robots.description import Motor


@dataclass(frozen=True)
class Firmness:
    """How a servo holds its load.

    Attributes:
      frequency: natural frequency in units of the pendulum's.
      damping: damping ratio.
    """

    frequency: float
    damping: float


# The NAO of nao.toml, 5.305 kg with its centre of mass 0.277 m above its soles, has
# kp = 59.9 and kd = 1.216 in its pitch joints; at the shoulder 25.9 and 0.41 for an
# arm of 0.008 kg m^2.
IN_STANCE = Firmness(frequency=2.0, damping=0.19)
FREE = Firmness(frequency=9.0, damping=0.5)


@dataclass(frozen=True)
class Pendulum:
    """The robot as an inverted pendulum on one ankle.

    Attributes:
      mass_kg: the mass.
      height_m: of the centre of mass above the soles.
    """

    mass_kg: float
    height_m: float

    @property
    def frequency_rad_s(self) -> float:
        """sqrt(g / h)."""
        return math.sqrt(GRAVITY_M_S2 / self.height_m)

    @property
    def inertia_kg_m2(self) -> float:
        """About the ankle, the mass in one point."""
        return self.mass_kg * self.height_m**2


def servo(
    effort_nm: float,
    speed_rad_s: float,
    pendulum: Pendulum,
    hanging_kg_m2: float | None,
) -> Motor:
    """A servo with that effort as stall torque and that speed without load.

    The back-EMF of such a motor is a damping of effort / speed; the servo's is never
    less. Nothing is known of rotors: their inertia is left out.

    Args:
      effort_nm: largest torque.
      speed_rad_s: largest speed.
      pendulum: the robot.
      hanging_kg_m2: the load of a joint that is in no leg; None for a leg's.

    Raises:
      BadValueError: effort or speed is not positive.
    """
    if not (effort_nm > 0 and speed_rad_s > 0):
        raise BadValueError(
            f"effort {effort_nm} N m and speed {speed_rad_s} rad/s must be positive"
        )
    own = pendulum.frequency_rad_s
    if hanging_kg_m2 is None:
        firm, inertia, topple = IN_STANCE, pendulum.inertia_kg_m2, own**2
    else:
        firm, inertia, topple = FREE, hanging_kg_m2, 0.0
    w = firm.frequency * own
    return Motor(
        stall_torque_nm=effort_nm,
        no_load_speed_rad_s=speed_rad_s,
        kp_nm_rad=inertia * (w**2 + topple),
        kd_nm_s_rad=max(2 * firm.damping * inertia * w, effort_nm / speed_rad_s),
        rotor_kg_m2=0.0,
    )

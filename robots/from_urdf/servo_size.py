"""Chooses servo gains for a robot of whose motors only effort and speed are known.

A joint of a leg has to hold the whole robot as an inverted pendulum on one ankle: with
mass m and the centre of mass at h above the sole, the inertia is I = m h^2 and gravity
topples it with m g h per radian. For a natural frequency w and a damping ratio z the
gains are kp = I (w^2 + g / h) and kd = 2 z I w. Any other joint holds the links below
it, with their inertia I, and the term g / h is left out. The frequency w is a multiple
of sqrt(g / h), so that a robot of any size stands as firmly as the NAO.
"""

import math

from groundwalk.errors import BadValueError
from groundwalk.gravity import GRAVITY_M_S2
from robots.description import Motor

# Natural frequency as a multiple of sqrt(g / h), and damping ratio. They come from the
# NAO in nao.toml, 5.305 kg with its centre of mass 0.277 m above the soles: its legs'
# pitch joints have kp = 59.9 N m/rad and kd = 1.216 N m s/rad, its shoulders 25.9 and
# 0.41 for an arm of 0.008 kg m^2.
IN_STANCE, FREE = (2.0, 0.19), (9.0, 0.5)


def servo(
    effort_nm: float,
    speed_rad_s: float,
    mass_kg: float,
    height_m: float,
    hanging_kg_m2: float | None,
) -> Motor:
    """Make a servo whose stall torque and no-load speed are a URDF's joint limits.

    The back-EMF of such a motor is a damping of effort / speed; the servo's damping is
    never less. The rotor inertia is unknown and left out. Mass and height of the centre
    of mass above the soles are the robot's; `hanging_kg_m2` is the inertia of the links
    below the joint about its axis, None for a joint of a leg.
    """
    if not (effort_nm > 0 and speed_rad_s > 0):
        raise BadValueError(
            f"effort {effort_nm} N m and speed {speed_rad_s} rad/s must be positive"
        )
    own = math.sqrt(GRAVITY_M_S2 / height_m)
    if hanging_kg_m2 is None:
        (frequency, damping), inertia = IN_STANCE, mass_kg * height_m**2
        topple = own**2
    else:
        (frequency, damping), inertia, topple = FREE, hanging_kg_m2, 0.0
    w = frequency * own
    return Motor(
        stall_torque_nm=effort_nm,
        no_load_speed_rad_s=speed_rad_s,
        kp_nm_rad=inertia * (w**2 + topple),
        kd_nm_s_rad=max(2 * damping * inertia * w, effort_nm / speed_rad_s),
        rotor_kg_m2=0.0,
    )

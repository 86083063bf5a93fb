"""The options --servo, --kp, --kd and --max-torque, where recordings state no servo."""

import sys

from groundwalk.errors import BadRecordingError, BadValueError
from robots.servos.types import servo_of
from worlds import ServoGains


def servo_gains(
    kp: float | None, kd: float | None, max_torque: float | None, servo: str = ""
) -> ServoGains | None:
    """The gains of all servos that a user gives, by numbers or by type.

    None without kp and type. Without a damping it is 0, without a torque limit there is
    none. A type is one of `groundwalk list servos`, such as "sts3215@7.4V,P=16".

    Raises:
      BadValueError: kd [N m s/rad] or max_torque [N m] is given without kp [N m/rad],
        one of them is negative or not finite, or a type is given beside kp.
      UnknownNameError: there is no servo of this type.

    Example:
      >>> servo_gains(20.0, None, 3.0).kd
      0.0
    """
    if servo:
        if (kp, kd, max_torque) != (None, None, None):
            raise BadValueError("give either a servo type or kp, kd and max_torque")
        known = servo_of(servo)
        return ServoGains(
            known.kp_nm_rad,
            0.0,
            known.max_torque_nm,
            back_emf=known.back_emf_nm_s_rad,
            armature=known.rotor_kg_m2,
        )
    if kp is None:
        if (kd, max_torque) != (None, None):
            raise BadValueError("kd or max_torque is given without kp")
        return None
    limit = sys.float_info.max if max_torque is None else max_torque
    try:
        return ServoGains(kp, kd or 0.0, limit)
    except BadRecordingError as error:
        raise BadValueError(str(error)) from error

"""The options --kp, --kd and --max-torque, for recordings that state no servo."""

import sys

from groundwalk.errors import BadRecordingError, BadValueError
from worlds import ServoGains


def servo_gains(
    kp: float | None, kd: float | None, max_torque: float | None
) -> ServoGains | None:
    """The gains of all servos that a user gives; None without kp.

    Without a damping it is 0, without a torque limit there is none.

    Raises:
      BadValueError: kd [N m s/rad] or max_torque [N m] is given without kp [N m/rad],
        or one of them is negative or not finite.

    Example:
      >>> servo_gains(20.0, None, 3.0).kd
      0.0
    """
    if kp is None:
        if (kd, max_torque) != (None, None):
            raise BadValueError("kd or max_torque is given without kp")
        return None
    limit = sys.float_info.max if max_torque is None else max_torque
    try:
        return ServoGains(kp, kd or 0.0, limit)
    except BadRecordingError as error:
        raise BadValueError(str(error)) from error

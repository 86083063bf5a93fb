"""What torque servos ask for, from what was commanded and measured."""

import numpy as np

from diagnosis.traces.smoothing import smooth
from diagnosis.traces.trace import Trace, filled
from groundwalk.arrays import FloatArray


def servo_law(trace: Trace, late: float) -> FloatArray:
    """(T, j) torques that ideal servos would have given, without back-EMF.

    Args:
      trace: with position commands.
      late: when a torque was noted, in ticks: 0 after its row's command took effect, 1
        before it did, between them the mean.
    """
    assert trace.command_rad is not None
    servo, command = trace.servo, filled(trace.command_rad)
    before = np.vstack([command[:1], command[:-1]])
    velocity = np.stack(
        [smooth(trace.time_s, own).rate for own in trace.position_rad.T], axis=1
    )
    error = late * before + (1 - late) * command - trace.position_rad
    asked = servo.kp_nm_rad * error - servo.kd_nm_s_rad * velocity
    return np.asarray(np.clip(asked, -servo.max_torque_nm, servo.max_torque_nm))

"""Profiles over time of the movements in a step, as shares of the whole movement.

Time and period are arrays of one shape, or numbers. All profiles are clamped: they are
0 before the movement and keep their final value after it. A step that lasts longer than
its period therefore waits in its final pose. (rUNSWift's Walk2014 jumps to the final
value half a tick earlier.)
"""

import numpy as np

from groundwalk.arrays import FloatArray

Times = float | FloatArray


def linear_step(time_s: Times, period_s: Times) -> FloatArray:
    """Profile, 0 to 1, of constant speed over the period [s]; shapes broadcast."""
    return np.clip(np.divide(time_s, period_s), 0.0, 1.0)


def parabolic_step(
    time_s: Times, period_s: Times, dead_fraction: Times = 0.0
) -> FloatArray:
    """Profile from 0 to 1 with constant acceleration, then constant deceleration.

    Times are in [s] and broadcast; `dead_fraction` is the share of the period without
    motion, half of it at each end.
    """
    dead_s = period_s * np.multiply(0.5, dead_fraction)
    part = np.clip((time_s - dead_s) / (period_s - 2 * dead_s), 0.0, 1.0)
    left = 1.0 - part
    return np.where(part < 0.5, 2 * part * part, 1.0 - 2 * left * left)


def parabolic_return(phase: FloatArray) -> FloatArray:
    """Profile that rises from 0 at phase 0 to 1 at 0.5, and falls to 0 at phase 1.

    Phases have any shape. The profile consists of parabolas: its second derivatives by
    phase in the four quarters are 16, -16, -16 and 16.
    """
    to_end = 0.5 - np.abs(np.clip(phase, 0.0, 1.0) - 0.5)
    to_apex = 0.5 - to_end
    return np.where(to_end < 0.25, 8 * to_end * to_end, 1.0 - 8 * to_apex * to_apex)


def warped_phase(phase: FloatArray, apex_phase: Times) -> FloatArray:
    """Stretch phases in [0, 1] so that `apex_phase` becomes 0.5 and the ends stay.

    The map is linear on either side of the apex, where its slope jumps. The jump does
    not show in a profile that is at rest at 0.5, such as `parabolic_return`.
    """
    rising = phase / apex_phase
    falling = 1.0 + (phase - apex_phase) / (1.0 - np.asarray(apex_phase))
    return 0.5 * np.where(phase < apex_phase, rising, falling)

"""The torque that servos ask for, as effects of servos and commands change it.

Where servos with known gains drive the joints, their law says what torque they ask for
in a recorded motion: kp (command - q) - kd v. It is compared with the torque that the
motion needs. A servo that is not as declared needs another error, and so asks for
another torque by the declared law, for the same motion. What effects change is added to
the torque that the motion needs, which is known without the noise of the error. What
firmware does beside stiffness and damping (`effects.controllers`) is left out.
"""

from collections.abc import Sequence

import numpy as np

from diagnosis.effects.variants import Variants
from diagnosis.traces.trace import Trace
from groundwalk.arrays import BoolArray, FloatArray

LATE_S = 0.1
"""Delay of commands [s] whose effect is known in all rows that count: commands from
before a recording's first row are not known."""

LEAST = 0.02
"""Smallest share of a servo's stiffness: a motor that is off asks for any torque."""


class AskedTorques:
    """Computes what servos ask for, by their declared law, in recorded motions."""

    def __init__(
        self, traces: Sequence[Trace], in_model: FloatArray | float = 0.0
    ) -> None:
        """Take the commands, servos and motions of traces, which have all of them.

        `in_model` (j,) is the back-EMF [N m s/rad] that the model has as damping of its
        joints.
        """
        self._traces, self._in_model = list(traces), in_model

    def of(self, needed_nm: FloatArray, variants: Variants) -> FloatArray:
        """(n, rows, j) torques that servos ask for where motions need (n, rows, j)."""
        asked = np.empty_like(needed_nm)
        for row in range(variants.n):
            first = 0
            for trace in self._traces:
                own = slice(first, first + trace.ticks)
                asked[row, own] = self._of(trace, needed_nm[row, own], variants, row)
                first += trace.ticks
        return asked

    def _of(
        self, trace: Trace, needed_nm: FloatArray, variants: Variants, row: int
    ) -> FloatArray:
        """(T, j) torques by the declared law of servos that are a variant's."""
        joints = {name: one[row] for name, one in vars(variants.joints).items()}
        kp = trace.servo.kp_nm_rad
        kd = trace.servo.kd_nm_s_rad + trace.servo.back_emf_nm_s_rad
        assert trace.motion is not None
        v, since_s = trace.motion.velocity_rad_s, trace.time_s[:, None]
        off = (since_s >= joints["off_start_s"]) & (since_s < joints["off_end_s"])
        on = 1 - joints["off_share"] * off
        stiffness = joints["kp_factor"] * np.maximum(
            1 - joints["fade_1_s"] * since_s, 0
        )
        damping = on * joints["damping_factor"] * kd - self._in_model
        pull = (needed_nm + damping * v) / np.maximum(on * stiffness, LEAST)
        asked = pull - (kd - self._in_model) * v
        delay_s = float(variants.signals.command_delay_s[row])
        if delay_s:
            asked += kp * (centred(trace) - centred(trace, delay_s))
        return np.asarray(asked)


def centred(trace: Trace, delay_s: float = 0.0) -> FloatArray:
    """(T, j) commands that hold at each row's time, if they are late by `delay_s`.

    A command holds from its row to the next one, so that on average it is that of the
    middle between them. Of a part of a recording the commands before it count as well,
    of a whole one that of its first row.
    """
    assert trace.command_rad is not None
    time_s, command_rad = _led(trace)
    middles = time_s + np.diff(time_s, append=np.nan) / 2
    middles[-1] = time_s[-1] + trace.tick_s / 2
    early = trace.time_s - delay_s
    return np.stack([np.interp(early, middles, one) for one in command_rad.T], axis=1)


def late_commands_known(trace: Trace) -> BoolArray:
    """(T,) whether the commands from `LATE_S` before each row on are known."""
    return np.asarray(trace.time_s - LATE_S >= _led(trace)[0][0])


def _led(trace: Trace) -> tuple[FloatArray, FloatArray]:
    """Times (R,) and commands (R, j) of the rows before a part, and of its own."""
    before = trace.before
    assert trace.command_rad is not None
    if before is None or before.command_rad is None:
        return trace.time_s, trace.command_rad
    time_s = np.concatenate([before.time_s, trace.time_s])
    return time_s, np.concatenate([before.command_rad, trace.command_rad])


def by_servos(trace: Trace, in_model: FloatArray | float = 0.0) -> FloatArray:
    """(T, j) torques [N m] that the declared servos ask for at the measured motion.

    Of their back-EMF only what the model does not have as damping of its joints counts:
    `in_model` (j,) [N m s/rad], which the torque that a motion needs holds already.
    """
    kp, kd = trace.servo.kp_nm_rad, trace.servo.kd_nm_s_rad
    q = trace.position_rad
    v = np.stack([np.gradient(one, trace.time_s) for one in q.T], axis=1)
    pull = kp * (centred(trace) - q) - kd * v
    limit = trace.servo.max_torque_nm
    back_emf = trace.servo.back_emf_nm_s_rad - in_model
    return np.asarray(np.clip(pull, -limit, limit) - back_emf * v)

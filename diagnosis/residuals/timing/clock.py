"""Errors of the clock: time stamps that jitter make fast motions look noisy.

A position that is measured at another time than its row says is wrong by the speed
times the difference. If all joints are read at once the error is common to a row; if
one after the other, each has its own. Both sizes are measured (`jitter.py`), and
residuals are whitened with them: what a moving joint shows is weaker evidence, and what
one at rest shows is stronger.
"""

from collections.abc import Sequence
from copy import copy

import numpy as np

from diagnosis.residuals.channels import Channels
from diagnosis.traces.trace import Trace
from groundwalk.arrays import BoolArray, FloatArray

SPEED_OVER_S = 0.02
"""Time to either side over which the speed in a row is taken, against sensor noise."""


class ClockNoise:
    """Whitens residuals with the noise that a jittering clock adds to motion."""

    def __init__(self, speed: FloatArray, own_s: float, common_s: float) -> None:
        """Use (rows, c) speeds, in units of noise for each second, and rms jitters [s].

        `own_s` is that of each channel, `common_s` that of all in a row.
        """
        self._share = 1 / np.sqrt(1 + (own_s * speed) ** 2)
        wrong = common_s * speed * self._share
        square = np.sum(wrong**2, axis=1, keepdims=True)
        share = 1 - 1 / np.sqrt(1 + square)
        self._axis = wrong * np.sqrt(share / np.maximum(square, 1e-12))

    def part(self, rows: slice) -> "ClockNoise":
        """That of some rows."""
        some = copy(self)
        some._share, some._axis = self._share[rows], self._axis[rows]
        return some

    def without(self, residual: FloatArray) -> FloatArray:
        """(n, rows, c) residuals, whitened."""
        own = residual * self._share
        along = np.sum(own * self._axis, axis=2, keepdims=True)
        return np.asarray(own - along * self._axis)


def clock_noise(
    traces: Sequence[Trace], channels: Channels, scored: BoolArray
) -> ClockNoise | None:
    """The whitening for the jitter of some channels; None if there is none.

    `scored` (rows, c) says which entries of a residual count.
    """
    jitter_s = channels.own_jitter_s, channels.common_jitter_s
    if not any(jitter_s):
        return None
    return ClockNoise(np.where(scored, speeds(traces, channels), 0.0), *jitter_s)


def speeds(traces: Sequence[Trace], channels: Channels) -> FloatArray:
    """(rows, c) speeds of the channels in compared rows, in noise for each second.

    0 for what is no position of a joint.
    """
    parts = []
    for trace in traces:
        own = np.zeros((trace.ticks, len(channels.names)))
        places = [
            i for i, name in enumerate(channels.names) if name.startswith("position.")
        ]
        own[:, places] = _speed_rad_s(trace)[:, : len(places)]
        parts.append(own[trace.compared] / channels.noise)
    return np.concatenate(parts)


def _speed_rad_s(trace: Trace) -> FloatArray:
    """(T, j) speeds of the joints."""
    rows = np.arange(trace.ticks)
    apart = max(round(SPEED_OVER_S / trace.tick_s), 1)
    before, after = np.maximum(rows - apart, 0), np.minimum(rows + apart, rows[-1])
    lasted_s = (trace.time_s[after] - trace.time_s[before])[:, None]
    far = trace.position_rad[after] - trace.position_rad[before]
    return np.asarray(np.nan_to_num(far / lasted_s))

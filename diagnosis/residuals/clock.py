"""Errors of the clock: time stamps that jitter make fast motions look noisy.

A position that is measured at another time than its row says is wrong by the speed
times the difference. If all joints are read at once the error is common to a row; if
one after the other, each has its own. Both sizes are measured in what small mismatch of
the model leave, and residuals are whitened with them: what a moving joint shows is
weaker evidence, and what one at rest shows is stronger.
"""

from collections.abc import Sequence

import numpy as np

from diagnosis.residuals.channels import Channels
from diagnosis.traces.trace import Trace
from groundwalk.arrays import BoolArray, FloatArray

SPEED_OVER_S = 0.02
"""Time to either side over which the speed in a row is taken, against sensor noise."""

QUICK = np.array([1.0, -3.0, 3.0, -1.0])
"""Weights of four rows whose sum has no constant, slope or curvature in it: what is
left of a residual is noise, since errors of a model change less quickly."""

ROUNDS = 4
"""Times that squares are weighted by what was found before."""

LEAST_AT_REST = 0.5
"""Least noise of a joint at rest as a share of its usual noise: less is no sensor's
noise, but the rounding of numbers."""

ORDINARY, MORE = 0.95, 1.5
"""Share of the rows that are ordinary, and multiple of the mean square up to which
their errors may be jitter: 5 % of normal noise hold a third of its square."""


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
    """(rows, c) speeds of the channels, in units of noise for each second.

    0 for what is no position of a joint.
    """
    parts = []
    for trace in traces:
        own = np.zeros((trace.ticks, len(channels.names)))
        places = [
            i for i, name in enumerate(channels.names) if name.startswith("position.")
        ]
        own[:, places] = _speed_rad_s(trace)[:, : len(places)]
        parts.append(own / channels.noise)
    return np.concatenate(parts)


def with_clock(
    channels: Channels, residual: FloatArray, speed: FloatArray, scored: BoolArray
) -> Channels:
    """The channels with the jitter of the clock, and noise without it.

    Args:
      channels: their noise includes what jitter adds on average.
      residual: (rows, c) what a model leaves, in units of noise.
      speed: (rows, c) see `speeds`.
      scored: (rows, c) entries that count.
    """
    quick = _quick(residual)
    whole = _windows(scored.astype(float)).min(axis=0) > 0
    squares, moved = QUICK**2, _windows(speed**2)
    power = np.tensordot(squares, moved, 1)
    least = np.maximum(LEAST_AT_REST, channels.rounding / channels.noise) ** 2
    parts = quick**2 / squares.sum(), power / squares.sum()
    noise, both = _parted(*parts, whole, np.minimum(least, 1.0))
    # errors that a row's channels share show in their products
    pairs = np.triu_indices(len(channels.names), 1)
    products = (part[:, pairs[0]] * part[:, pairs[1]] for part in _windows(speed))
    shared = sum(
        share * product for share, product in zip(squares, products, strict=True)
    )
    seen = quick[:, pairs[0]] * quick[:, pairs[1]]
    here = whole[:, pairs[0]] & whole[:, pairs[1]]
    size = 1 + both * power / squares.sum()
    weight = here / (size[:, pairs[0]] * size[:, pairs[1]])
    common = float(np.sum(weight * seen * shared))
    common /= max(float(np.sum(weight * shared**2)), 1e-12)
    common = min(max(common, 0.0), both)
    jitter = float(np.sqrt(both - common)), float(np.sqrt(common))
    return channels.jittering(np.sqrt(noise), *jitter)


def _parted(
    squares: FloatArray, power: FloatArray, whole: BoolArray, least: FloatArray
) -> tuple[FloatArray, float]:
    """(c,) squares of noise at rest, and the square of the jitter [s^2].

    Mean squares of residuals (rows, c) are those of noise plus the jitter's times the
    (rows, c) mean squares of speeds; least squares with weights by size. Jitter
    explains no more than ordinary rows show: what jumps in few is none. Squares of
    noise are (c,) `least` at least.
    """
    count = squares.shape[1]
    noise, jitter = np.ones(count), 0.0
    usual = float(np.sum(whole * power)) / max(int(whole.sum()), 1)
    some = squares[whole] if whole.any() else np.ones(1)
    ordinary = float(np.minimum(some, np.quantile(some, ORDINARY)).mean())
    most = (max(MORE * ordinary, 1.0) - float(least.mean())) / max(usual, 1e-12)
    for _ in range(ROUNDS):
        weight = whole / (noise + jitter * power) ** 2
        means = [np.sum(weight * one, 0) for one in (squares, power)]
        total = np.maximum(np.sum(weight, 0), 1e-12)
        centred = power - means[1] / total
        slope = float(np.sum(weight * centred * squares))
        jitter = slope / max(float(np.sum(weight * centred**2)), 1e-12)
        # what a joint at rest has at least is no jitter when it moves
        spare = np.sum(weight * (squares - least) * power)
        jitter = min(jitter, spare / max(float(np.sum(weight * power**2)), 1e-12))
        jitter = min(max(jitter, 0.0), most)
        noise = np.clip((means[0] - jitter * means[1]) / total, least, 1.0)
    return noise, jitter


def _quick(residual: FloatArray) -> FloatArray:
    """(rows - 3, c) what in a residual changes from row to row."""
    return np.asarray(np.tensordot(QUICK, _windows(residual), 1))


def _windows(values: FloatArray) -> FloatArray:
    """(4, rows - 3, c) four successive rows."""
    last = len(values) - len(QUICK) + 1
    return np.stack([values[k : k + last] for k in range(len(QUICK))])


def _speed_rad_s(trace: Trace) -> FloatArray:
    """(T, j) speeds of the joints."""
    rows = np.arange(trace.ticks)
    apart = max(round(SPEED_OVER_S / trace.tick_s), 1)
    before, after = np.maximum(rows - apart, 0), np.minimum(rows + apart, rows[-1])
    lasted_s = (trace.time_s[after] - trace.time_s[before])[:, None]
    far = trace.position_rad[after] - trace.position_rad[before]
    return np.asarray(np.nan_to_num(far / lasted_s))

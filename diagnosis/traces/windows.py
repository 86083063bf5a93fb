"""Windows: the parts of traces that are replayed from measured start states."""

from dataclasses import dataclass

import numpy as np

from diagnosis.plant.plant import Plant
from diagnosis.traces.smoothing import smooth_columns
from diagnosis.traces.trace import Trace
from groundwalk.arrays import FloatArray

HEAD_ROWS = 60
"""Number of rows at a trace's start that are smoothed, with those before it if it is a
part, to get its start state."""

REMEMBERED_ROWS = 500
"""Most rows before a window from which follows what its joints' friction remembers. All
that was before a way of twice friction's reach in one direction is forgotten."""

UNHELD_WINDOW_S = 0.5
"""Duration [s] after which a replay starts again from the measured state, for joints
without servos: nothing else keeps its errors from growing."""

FLOATING_WINDOW_S = 0.3
"""Duration [s] after which a replay of a robot with a floating base starts again from
the measured state. A standing robot is an inverted pendulum: errors double in it."""

EDGE_S = 0.05
"""Time [s] at the start of a recording in which no further window starts: smoothed
speeds are not accurate there."""

LEAST_WINDOW_S = 0.1
"""Shorter windows [s] of recordings with a floating base are not replayed."""


@dataclass(frozen=True, eq=False)
class Run:
    """One trace, or a window of one, to be replayed from its first row on.

    Attributes:
      trace: the rows that are replayed, with their commands and measurements.
      position_rad: (j,) smoothed positions at the start.
      velocity_rad_s: (j,) smoothed velocities at the start.
      base: (13,) state of a floating base at the start: position (3) [m], orientation
        (4, quaternion w, x, y, z), linear velocity (3, world frame) [m/s], angular
        velocity (3, body frame) [rad/s]. None for a fixed base.
      whole: the trace of which `trace` is a window, with what was recorded before; None
        if `trace` is all. Commands from before a window may still act in it if they
        take effect late.
      before_rad: (rows, j) smoothed positions just before the start and at it, which
        friction remembers; None if nothing was recorded before.
      acceleration_rad_s2: (j,) smoothed accelerations at the start, which tell the
        torques there; None if nothing was recorded before: then the joints are taken to
        move steadily.
    """

    trace: Trace
    position_rad: FloatArray
    velocity_rad_s: FloatArray
    base: FloatArray | None = None
    whole: Trace | None = None
    before_rad: FloatArray | None = None
    acceleration_rad_s2: FloatArray | None = None

    @classmethod
    def of(cls, trace: Trace) -> "Run":
        """A trace, to be replayed from the smoothed state at its start.

        In the midst of a motion it is known far better from both sides.
        """
        led = trace.led()
        first = led.ticks - trace.ticks
        head = slice(0, first + HEAD_ROWS)
        smoothed = smooth_columns(led.time_s[head], led.position_rad[head])
        whole = led if first else None
        return cls(
            trace,
            smoothed.value[first],
            smoothed.rate[first],
            whole=whole,
            before_rad=_before(smoothed.value, first),
            acceleration_rad_s2=smoothed.acceleration[first] if first else None,
        )


def window_s(plant: Plant, trace: Trace) -> float | None:
    """Length [s] of the windows in which a trace is replayed; None for all at once."""
    if plant.base == "floating":
        return FLOATING_WINDOW_S
    return UNHELD_WINDOW_S if trace.loose and trace.motion is None else None


def is_left_over(plant: Plant, trace: Trace) -> bool:
    """Whether a window of a robot with a floating base is too short to be compared."""
    return plant.base == "floating" and trace.duration_s < LEAST_WINDOW_S


def runs_of(plant: Plant, trace: Trace, least_s: float = 0.0) -> list[Run]:
    """Divide all rows of a trace into the windows in which it is replayed.

    Windows of a fixed base last `least_s` at least.
    """
    longest_s = window_s(plant, trace)
    if longest_s is None:
        return [Run.of(trace)]
    if plant.base == "fixed":
        longest_s = max(longest_s, least_s)
    led = trace.led()
    more = led.ticks - trace.ticks
    smoothed = smooth_columns(led.time_s, led.position_rad)
    position, velocity = smoothed.value[more:], smoothed.rate[more:]
    base = _bases(trace) if plant.base == "floating" else None
    since_s = trace.time_s - trace.time_s[0]
    if plant.base == "floating":
        since_s = np.maximum(since_s - EDGE_S + longest_s, 0.0)
    number = (since_s / longest_s).astype(int)
    starts = np.unique(np.searchsorted(number, np.arange(number[-1] + 1)))
    ends = [*starts[1:], trace.ticks]
    return [
        Run(
            trace.part(int(first), int(last)),
            position[first],
            velocity[first],
            None if base is None else base[first],
            led,
            _before(smoothed.value, more + int(first)),
            smoothed.acceleration[more + int(first)] if more + first else None,
        )
        for first, last in zip(starts, ends, strict=True)
    ]


def _before(position_rad: FloatArray, row: int) -> FloatArray | None:
    """The last of (T, j) positions before a row, with its own; None at the start."""
    return position_rad[max(row - REMEMBERED_ROWS, 0) : row + 1] if row else None


def _bases(trace: Trace) -> FloatArray:
    """(T, 13) smoothed states of a floating base, columns as in `Run.base`."""
    assert trace.base_position_m is not None
    assert trace.base_orientation is not None
    position, velocity, _ = smooth_columns(trace.time_s, trace.base_position_m)
    turned = continuous(trace.base_orientation)
    quaternion, rate, _ = smooth_columns(trace.time_s, turned)
    length = np.linalg.norm(quaternion, axis=1, keepdims=True)
    quaternion, rate = quaternion / length, rate / length
    w, v, dw, dv = quaternion[:, :1], quaternion[:, 1:], rate[:, :1], rate[:, 1:]
    turning = 2 * (w * dv - dw * v - np.cross(v, dv))  # vector part of 2 q* q'
    velocity = _with_measured(trace, velocity, trace.base_linear_velocity_m_s)
    turning = _with_measured(trace, turning, trace.base_angular_velocity_rad_s)
    return np.hstack([position, quaternion, velocity, turning])


def _with_measured(
    trace: Trace, rates: FloatArray, measured: FloatArray | None
) -> FloatArray:
    """(T, 3) mean of derived and measured rates, whose errors are independent."""
    if measured is None or not np.isfinite(measured).all():
        return rates
    return np.asarray((rates + smooth_columns(trace.time_s, measured).value) / 2)


def continuous(quaternion: FloatArray) -> FloatArray:
    """Quaternions (T, 4) of the same rotations, without jumps to the opposite sign."""
    products = np.sum(quaternion[1:] * quaternion[:-1], axis=1)
    signs = np.cumprod(np.concatenate([[1.0], np.where(products < 0, -1.0, 1.0)]))
    return np.asarray(quaternion * signs[:, None])

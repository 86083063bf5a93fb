"""Finds out where pulses came in: at the actuator, a torque or a position sensor.

The signal that jumps at the edges of the pulses says so, and whether the motion obeys
them.
"""

from collections.abc import Sequence

import numpy as np

from diagnosis.plant.inverse_dynamics import inverse_dynamics
from diagnosis.plant.plant import Plant
from diagnosis.traces.smoothing import smooth
from diagnosis.traces.trace import Trace
from diagnosis.verdict.parts import PulseSource
from groundwalk.arrays import BoolArray, FloatArray

Stretch = tuple[int, int]
"""First row of a pulse, and the row after its last one."""

EDGE_ROWS, NEAR_ROWS = 4, 3
"""Rows before and after an edge that are compared, and the uncertainty of an edge in
rows."""

UNSURE_S = 0.02
"""Time around an edge [s] in which smoothed speeds and accelerations are wrong."""

MOSTLY = 0.5
"""Share of a pulse that the motion must obey for the pulse to be a real torque."""

NEARLY_ALL = 0.7
"""Share of the pulses' size that one signal must jump by to be their origin."""


def source_of(
    plant: Plant,
    trace: Trace,
    column: int,
    where: Sequence[Stretch],
    sizes: FloatArray,
) -> tuple[PulseSource | None, dict[str, float], float]:
    """Find out in which signal a joint's pulses are.

    Args:
      plant: the nominal robot model.
      trace: a whole recording with commands and measured torques.
      column: the joint's.
      where: rows of the pulses.
      sizes: torque of each pulse [N m].

    Returns:
      The source, or None if no signal has them; the jumps at the edges by signal, as a
      share of the pulses' sizes; and the share of the pulses that the motion obeys.
    """
    assert trace.torque_nm is not None
    assert trace.command_rad is not None
    kp = float(trace.servo.kp_nm_rad[column])
    signals = {
        "torque": trace.torque_nm[:, column],
        "position": kp * trace.position_rad[:, column],
        "command": -kp * trace.command_rad[:, column],
    }
    jumps = {name: _jump(values, where, sizes) for name, values in signals.items()}
    largest = max(jumps, key=lambda name: jumps[name])
    if largest == "command" or jumps[largest] < NEARLY_ALL:
        return None, jumps, 0.0  # the servo is late, say, or weak: nothing was added
    if largest == "position":
        return "position sensor", jumps, 0.0
    felt = _felt(plant, trace, column, where, sizes)
    return ("actuator input" if felt > MOSTLY else "torque sensor"), jumps, felt


def _jump(values: FloatArray, where: Sequence[Stretch], sizes: FloatArray) -> float:
    """Mean jump of a signal at the pulses' edges, as a share of their sizes."""
    steps, wanted, margin = 0.0, 0.0, EDGE_ROWS + NEAR_ROWS
    for (first, last), size in zip(where, sizes, strict=True):
        for row, sign in ((first, 1.0), (last, -1.0)):
            if row >= margin and row + margin <= len(values):
                steps += sign * np.sign(size) * step_at(values, row)[0]
                wanted += abs(size)
    return float(steps / wanted) if wanted else 0.0


def step_at(values: FloatArray, row: int) -> tuple[float, int]:
    """Largest jump of a signal near a row, and the row where it is.

    A line with a step is fitted to the rows before and after.

    Args:
      values: (T,) the signal.
      row: where an edge is expected, to within `NEAR_ROWS`.
    """
    time = np.arange(-EDGE_ROWS, EDGE_ROWS) + 0.5
    design = np.stack([np.ones_like(time), time, (time > 0).astype(float)], axis=1)
    rows = [
        i
        for i in range(row - NEAR_ROWS, row + NEAR_ROWS + 1)
        if EDGE_ROWS <= i <= len(values) - EDGE_ROWS
    ]
    if not rows:  # the recording begins or ends there
        return 0.0, row
    near = np.stack([values[i - EDGE_ROWS : i + EDGE_ROWS] for i in rows], axis=1)
    steps = np.linalg.lstsq(design, near, rcond=None)[0][2]
    best = int(np.argmax(np.abs(steps)))
    return float(steps[best]), rows[best]


def _felt(
    plant: Plant,
    trace: Trace,
    column: int,
    where: Sequence[Stretch],
    sizes: FloatArray,
) -> float:
    """Share of the measured pulses that the motion obeys.

    The torque that the motion needs, by inverse dynamics, less the measured torque is
    regressed on friction and on the pulses. The pulses' coefficient is 0 if they were
    real and -1 if the joint never felt them.
    """
    assert trace.torque_nm is not None
    smoothed = [smooth(trace.time_s, own) for own in trace.position_rad.T]
    motion = (
        np.stack([getattr(own, name) for own in smoothed], axis=1)
        for name in ("value", "rate", "acceleration")
    )
    needed = inverse_dynamics(plant, plant.model, *motion)[:, column]
    velocity = smoothed[column].rate
    pulse = np.zeros(trace.ticks)
    for (first, last), size in zip(where, sizes, strict=True):
        pulse[first:last] = size
    sure = _sure_rows(trace, where) & np.isfinite(needed)
    regressors = [np.ones_like(pulse), velocity, np.sign(velocity), pulse]
    design = np.stack(regressors, axis=1)[sure]
    rest = (needed - trace.torque_nm[:, column])[sure]
    return 1.0 + float(np.linalg.lstsq(design, rest, rcond=None)[0][3])


def _sure_rows(trace: Trace, where: Sequence[Stretch]) -> BoolArray:
    """(T,) whether a row is so far from all edges that its smoothed speed holds."""
    edges = trace.time_s[[min(row, trace.ticks - 1) for one in where for row in one]]
    near = np.abs(trace.time_s[:, None] - edges) < UNSURE_S
    return np.asarray(~near.any(axis=1), bool)

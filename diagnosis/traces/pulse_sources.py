"""Finds the source of a joint's pulses: actuator, torque sensor or position sensor.

A pulse is a constant torque, for a while, that the servo did not ask for. The signal
that jumps at its edges tells its source, and whether the joint moved accordingly.
"""

from collections.abc import Sequence

import numpy as np

from diagnosis.plant.inverse_dynamics import inverse_dynamics
from diagnosis.plant.plant import Plant
from diagnosis.traces.smoothing import smooth_columns
from diagnosis.traces.trace import Trace
from diagnosis.verdict import PulseSource
from groundwalk.arrays import BoolArray, FloatArray

Stretch = tuple[int, int]
"""First row of a pulse, and the row after its last one."""

EDGE_ROWS, NEAR_ROWS = 4, 3
"""Rows on each side of a pulse's edge that are compared to find the jump there, and
the number of rows by which the edge itself may be off."""

UNSURE_S = 0.02
"""Time before and after a pulse's edge [s] that is left out: smoothed speeds and
accelerations are wrong there."""

MOSTLY = 0.5
"""Share of a pulse's torque that must have moved the joint for it to be a real torque
and no error of the torque sensor."""

NEARLY_ALL = 0.7
"""Smallest jump of a signal at the pulses' edges, as a share of the pulses' size, for
which the signal can be their source."""


def source_of(
    plant: Plant,
    trace: Trace,
    column: int,
    where: Sequence[Stretch],
    sizes: FloatArray,
) -> tuple[PulseSource | None, dict[str, float], float]:
    """Find the source of a joint's pulses: an actuator or a sensor.

    Args:
      plant: the nominal robot model.
      trace: a whole recording with commands and measured torques.
      column: index of the joint.
      where: rows of each pulse.
      sizes: (pulses,) torques [N m].

    Returns:
      The source, or None if neither torque nor position jumps with the pulses; the mean
      jump of each signal at their edges, and the torque that moved the joint, both as
      shares of the pulses' size.
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
    """Mean jump of a signal [N m] at the pulses' edges, as a share of their sizes."""
    steps, wanted, margin = 0.0, 0.0, EDGE_ROWS + NEAR_ROWS
    for (first, last), size in zip(where, sizes, strict=True):
        for row, sign in ((first, 1.0), (last, -1.0)):
            if row >= margin and row + margin <= len(values):
                steps += sign * np.sign(size) * step_at(values, row)[0]
                wanted += abs(size)
    return float(steps / wanted) if wanted else 0.0


def step_at(values: FloatArray, row: int) -> tuple[float, int]:
    """Largest jump of a signal (T,) within 3 rows of a row, and the row after it.

    The jump is that of a line with a step, fitted to 4 rows on each side.
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
    """Share of the torque of a joint's measured pulses that moved the joint.

    The torque that the motion needs, by inverse dynamics, less the measured torque is
    regressed on friction and on the pulses. The pulses' coefficient is 0 if they were
    real torques, and -1 if only the torque sensor showed them.
    """
    assert trace.torque_nm is not None
    motion = smooth_columns(trace.time_s, trace.position_rad)
    needed = inverse_dynamics(plant, plant.model, *motion)[:, column]
    velocity = motion.rate[:, column]
    pulse = np.zeros(trace.ticks)
    for (first, last), size in zip(where, sizes, strict=True):
        pulse[first:last] = size
    sure = _sure_rows(trace, where) & np.isfinite(needed)
    regressors = [np.ones_like(pulse), velocity, np.sign(velocity), pulse]
    design = np.stack(regressors, axis=1)[sure]
    rest = (needed - trace.torque_nm[:, column])[sure]
    return 1.0 + float(np.linalg.lstsq(design, rest, rcond=None)[0][3])


def _sure_rows(trace: Trace, where: Sequence[Stretch]) -> BoolArray:
    """(T,) whether a row is 20 ms or more away from the edges of all pulses."""
    edges = trace.time_s[[min(row, trace.ticks - 1) for one in where for row in one]]
    near = np.abs(trace.time_s[:, None] - edges) < UNSURE_S
    return np.asarray(~near.any(axis=1), bool)

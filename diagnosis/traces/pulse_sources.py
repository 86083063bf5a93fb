"""Where pulses came in: which signal jumps at their edges, what the motion obeys."""

from collections.abc import Sequence

import numpy as np

from diagnosis.plant.inverse_dynamics import inverse_dynamics
from diagnosis.plant.plant import Plant
from diagnosis.traces.smoothing import smooth
from diagnosis.traces.trace import Trace
from diagnosis.verdict.parts import PulseSource
from groundwalk.arrays import BoolArray, FloatArray

Stretch = tuple[int, int]
"""First row, and one past the last."""

EDGE_ROWS, NEAR_ROWS = 4, 3
"""Before and after an edge that say how far a signal jumps there; an edge is known to a
few rows."""

UNSURE_S = 0.02
"""Around an edge smoothed speeds and accelerations are wrong."""

MOSTLY = 0.5
"""Share of pulses that is felt if they are real."""

NEARLY_ALL = 0.7
"""Share of the jumps that is in one signal, if pulses are."""


def source_of(
    plant: Plant,
    trace: Trace,
    column: int,
    where: Sequence[Stretch],
    sizes: FloatArray,
) -> tuple[PulseSource | None, dict[str, float], float]:
    """Where pulses came in, how much jumps in which signal, and how much was felt."""
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
    """How far a signal jumps at the pulses' edges, as a share of their sizes."""
    steps, wanted, margin = 0.0, 0.0, EDGE_ROWS + NEAR_ROWS
    for (first, last), size in zip(where, sizes, strict=True):
        for row, sign in ((first, 1.0), (last, -1.0)):
            if row >= margin and row + margin <= len(values):
                steps += sign * np.sign(size) * step_at(values, row)[0]
                wanted += abs(size)
    return float(steps / wanted) if wanted else 0.0


def step_at(values: FloatArray, row: int) -> tuple[float, int]:
    """What a signal jumps by, besides its even course, and at which row near one."""
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

    What the motion needed less what was measured, regressed on friction and on the
    pulses: 0 of them is left if they were real, -1 if the joint never felt them.
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
    """(T,) rows that are not near an edge."""
    edges = trace.time_s[[min(row, trace.ticks - 1) for one in where for row in one]]
    near = np.abs(trace.time_s[:, None] - edges) < UNSURE_S
    return np.asarray(~near.any(axis=1), bool)

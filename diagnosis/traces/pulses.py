"""Finds pulses: torques that a joint's servo did not ask for, constant for a while.

A pulse is a time span in which the measured torque differs by a constant, between sharp
edges, from the one that the servo's law asks for. The signal that jumps at the edges,
and the motion, tell the fault of an actuator from that of a sensor (Isermann 2005,
"Model-based fault-detection and diagnosis").
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from scipy.ndimage import median_filter, minimum_filter1d

from diagnosis.plant.loads import model_under
from diagnosis.plant.plant import Plant, inverse_dynamics
from diagnosis.traces.smoothing import smooth_columns
from diagnosis.traces.trace import Trace, filled, stretches
from diagnosis.verdict import Pulse, PulseSource
from groundwalk.arrays import FloatArray

FILTER_S = 0.01
"""Width of the median filter [s] that removes outliers before pulses are looked for."""

SHORTEST_S, FEWEST = 0.03, 8
"""A pulse lasts at least this long [s] and at least this many rows."""

QUIET = 0.2
"""Largest rms of measured less asked torque outside of the pulses, as a share of the
smallest pulse; a joint with more has another fault."""

FLAT = 0.3
"""Largest standard deviation of measured less asked torque within a pulse, as a share
of the pulse."""

LEAST_OUTSIDE = 0.1
"""Share of a recording's rows that must lie outside of all pulses."""

LATE = (0.0, 0.5, 1.0)
"""Delays [ticks] of a servo's command that are tried: a recording may note a torque
before its row's command took effect."""

CALM = 0.2
"""Quantile of the absolute difference of measured and asked torque that is compared to
choose among delays of the command."""

_QUARTILES = 1.349
"""Distance of the two quartiles of a normal distribution, in standard deviations."""


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


def pulses_of(plant: Plant, trace: Trace) -> tuple[Pulse, ...]:
    """Find the pulses of a recording, in the order of time.

    There are none without servos or measured torques, or with a floating base.
    """
    if trace.torque_nm is None or trace.unheld or plant.base == "floating":
        return ()
    added = np.stack([trace.torque_nm - _asked_nm(trace, late) for late in LATE])
    found: list[Pulse] = []
    for column in range(len(plant.joints)):
        own = added[:, :, column]
        if trace.servo.kp_nm_rad[column] > 0 and np.isfinite(own).all():
            calm = np.quantile(np.abs(own), CALM, axis=1)
            found += _of_joint(plant, trace, column, own[np.argmin(calm)])
    return tuple(sorted(found, key=lambda pulse: (pulse.start_s, pulse.joint)))


def without_pulses(plant: Plant, trace: Trace, pulses: Sequence[Pulse]) -> Trace:
    """Take pulses out of a trace, so that they are not mistaken for missing physics.

    A pulse at an actuator's input is subtracted from the measured torque and becomes a
    torque that replays apply to the joint (`Trace.added_nm`). Values that a faulty
    sensor reported during a pulse become NaN.
    """
    if not pulses:
        return trace
    assert trace.torque_nm is not None
    torque, position = trace.torque_nm.copy(), trace.position_rad.copy()
    added = np.zeros_like(torque)
    for pulse in pulses:
        column = plant.joints.index(pulse.joint)
        rows = (trace.time_s >= pulse.start_s) & (trace.time_s < pulse.end_s)
        if pulse.source == "actuator input":
            added[rows, column] = pulse.torque
            torque[rows, column] -= pulse.torque
        elif pulse.source == "torque sensor":
            torque[rows, column] = np.nan
        else:
            position[rows, column] = np.nan
    return replace(trace, torque_nm=torque, position_rad=position, added_nm=added)


def _of_joint(
    plant: Plant, trace: Trace, column: int, added: FloatArray
) -> list[Pulse]:
    """The pulses of joint `column`, from (T,) measured less asked torques [N m]."""
    where = _flat_stretches(trace.time_s, added)
    if not where:
        return []
    sizes = np.array([np.median(added[first:last]) for first, last in where])
    source, jumps, felt = _source_of(plant, trace, column, where, sizes)
    if source is None:
        return []
    assert trace.torque_nm is not None
    is_position = source == "position sensor"
    signal = (trace.position_rad if is_position else trace.torque_nm)[:, column]
    where = [
        (_step_at(signal, first)[1], _step_at(signal, last)[1]) for first, last in where
    ]
    end_s = np.append(trace.time_s, trace.time_s[-1] + trace.tick_s)
    return [
        Pulse(
            recording=trace.name,
            joint=plant.joints[column],
            start_s=float(trace.time_s[first]),
            end_s=float(end_s[last]),
            torque=float(size),
            unit=plant.unit("N m", plant.joints[column]),
            source=source,
            jumps=jumps,
            felt=felt,
        )
        for (first, last), size in zip(where, sizes, strict=True)
    ]


def _flat_stretches(time_s: FloatArray, added: FloatArray) -> list[Stretch]:
    """Rows of each pulse, from (T,) measured less asked torques [N m].

    A wrong gain or a late command causes no difference that is constant for a while,
    and small outside of that.
    """
    tick_s = float(np.median(np.diff(time_s)))
    width = 2 * round(FILTER_S / tick_s / 2) + 1
    clean = median_filter(added, max(width, 3), mode="nearest")
    fewest = max(round(SHORTEST_S / tick_s), FEWEST)
    held = [minimum_filter1d(sign * clean, fewest).max() for sign in (1, -1)]
    level = max(*held, 0.0) / 2
    where = [
        (first, last)
        for sign in (1, -1)
        for first, last in stretches(sign * clean > level)
        if last - first >= fewest
    ]
    outside = np.ones(len(added), bool)
    edge = max(round(UNSURE_S / tick_s), EDGE_ROWS)
    for first, last in where:
        outside[max(first - edge, 0) : last + edge] = False
    if not where or outside.mean() < LEAST_OUTSIDE:
        return []
    middles = [added[first + 1 : last - 1] for first, last in where]
    sizes = np.abs([np.median(own) for own in middles])
    rest = float(np.sqrt(np.mean(added[outside] ** 2)))
    spread = np.array([_spread(own) for own in middles])
    is_flat = rest <= QUIET * sizes.min() and (spread <= FLAT * sizes).all()
    return sorted(where) if is_flat else []


def _spread(values: FloatArray) -> float:
    """Standard deviation, from the quartiles so that outliers do not count."""
    low, high = np.quantile(values, (0.25, 0.75))
    return float(high - low) / _QUARTILES


def _asked_nm(trace: Trace, late: float) -> FloatArray:
    """(T, j) torques that the servos ask for if commands are `late` by up to 1 tick."""
    assert trace.command_rad is not None
    command = filled(trace.command_rad)
    before = np.vstack([command[:1], command[:-1]])
    velocity = smooth_columns(trace.time_s, trace.position_rad).rate
    error = late * before + (1 - late) * command - trace.position_rad
    return trace.servo.torque(error, velocity)


def _source_of(
    plant: Plant, trace: Trace, column: int, where: Sequence[Stretch], sizes: FloatArray
) -> tuple[PulseSource | None, dict[str, float], float]:
    """The source of a joint's pulses; None if neither torque nor position jumps.

    Also the mean jump of each signal at their edges, and the torque that moved the
    joint, both as shares of the pulses' size.
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
                steps += sign * np.sign(size) * _step_at(values, row)[0]
                wanted += abs(size)
    return float(steps / wanted) if wanted else 0.0


def _step_at(values: FloatArray, row: int) -> tuple[float, int]:
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
    plant: Plant, trace: Trace, column: int, where: Sequence[Stretch], sizes: FloatArray
) -> float:
    """Share of the torque of a joint's measured pulses that moved the joint.

    The torque that the motion needs, by inverse dynamics, less the measured torque is
    regressed on friction and on the pulses. The pulses' coefficient is 0 if they were
    real torques, and -1 if only the torque sensor showed them.
    """
    assert trace.torque_nm is not None
    motion = smooth_columns(trace.time_s, trace.position_rad)
    needed = inverse_dynamics(plant, model_under(plant, trace.loads), *motion)[
        :, column
    ]
    velocity = motion.rate[:, column]
    pulse = np.zeros(trace.ticks)
    for (first, last), size in zip(where, sizes, strict=True):
        pulse[first:last] = size
    edges = trace.time_s[[min(row, trace.ticks - 1) for one in where for row in one]]
    unsure = (np.abs(trace.time_s[:, None] - edges) < UNSURE_S).any(axis=1)
    sure = ~unsure & np.isfinite(needed)
    regressors = [np.ones_like(pulse), velocity, np.sign(velocity), pulse]
    design = np.stack(regressors, axis=1)[sure]
    rest = (needed - trace.torque_nm[:, column])[sure]
    return 1.0 + float(np.linalg.lstsq(design, rest, rcond=None)[0][3])

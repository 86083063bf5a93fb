"""Pulses: what was added to a servo's torque for a while, and where it came in.

A servo's law says what torque it asks for; where the torque was measured, too, the
difference of the two is zero as long as all is well. A pulse is a stretch in which it
is not, flat and between sharp edges. Its edges say in which signal it is, and whether
the motion obeys it says which torque was real: structured residuals, as for telling a
fault of an actuator from that of a sensor (Isermann 2005, "Model-based fault-detection
and diagnosis").
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from scipy.ndimage import median_filter, minimum_filter1d

from diagnosis.plant.plant import Plant
from diagnosis.traces.pulse_sources import (
    EDGE_ROWS,
    UNSURE_S,
    Stretch,
    source_of,
    step_at,
)
from diagnosis.traces.servo_law import servo_law
from diagnosis.traces.stretches import stretches
from diagnosis.traces.trace import Trace
from diagnosis.verdict.parts import Pulse
from groundwalk.arrays import FloatArray

FILTER_S = 0.01
"""Single rows that are off are no pulse."""

SHORTEST_S, FEWEST = 0.03, 8
"""A pulse lasts so long, and so many rows."""

QUIET = 0.2
"""What is left between the pulses, as a part of the smallest ..."""

FLAT = 0.3
"""... and what they vary by themselves, as a part of each."""

LEAST_OUTSIDE = 0.1
"""Share of the rows that no pulse may be in."""

LATE = (0.0, 0.5, 1.0)
"""Ticks: recordings differ in when they note a torque. What leaves least of the ..."""

CALM = 0.2
"""... calmest rows, as a share of all, is right."""


def pulses_of(plant: Plant, trace: Trace) -> tuple[Pulse, ...]:
    """The pulses of a recording; none where a servo or its measured torque is missing.

    Args:
      plant: nominal.
      trace: whole.
    """
    if trace.torque_nm is None or trace.unheld or plant.base == "floating":
        return ()
    added = np.stack([trace.torque_nm - servo_law(trace, late) for late in LATE])
    found: list[Pulse] = []
    for column in range(len(plant.joints)):
        own = added[:, :, column]
        if trace.servo.kp_nm_rad[column] > 0 and np.isfinite(own).all():
            calm = np.quantile(np.abs(own), CALM, axis=1)
            found += _of_joint(plant, trace, column, own[np.argmin(calm)])
    return tuple(sorted(found, key=lambda pulse: (pulse.start_s, pulse.joint)))


def without_pulses(plant: Plant, trace: Trace, pulses: Sequence[Pulse]) -> Trace:
    """The trace with its pulses accounted for.

    Those at the actuator's input drive the joint from now on, beside the servo, whose
    torque is what is left of the measured one. What a sensor made up is missing.
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
    """Of one joint, whose servo got (T,) more than it asked for."""
    where = _flat_stretches(trace.time_s, added)
    if not where:
        return []
    sizes = np.array([np.median(added[first:last]) for first, last in where])
    source, jumps, felt = source_of(plant, trace, column, where, sizes)
    if source is None:
        return []
    assert trace.torque_nm is not None
    is_position = source == "position sensor"
    signal = (trace.position_rad if is_position else trace.torque_nm)[:, column]
    where = [
        (step_at(signal, first)[1], step_at(signal, last)[1]) for first, last in where
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
    """Where something flat was added; nowhere if what is between is not quiet.

    A wrong gain or a late command is off in proportion to the servo's own torque: that
    is neither flat nor quiet in between.
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
    """Standard deviation, as the middle half of the values has it."""
    low, high = np.quantile(values, (0.25, 0.75))
    return float(high - low) / 1.349

"""Finds wrong samples: values that jump away for a row or a few, and jump back.

On a servo bus a read now and then fails, and the recording has a 0 or an old value
there. No joint moves like that, yet a single such row outweighs a second of friction.
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from scipy.ndimage import maximum_filter1d

from diagnosis.traces.trace import Trace
from groundwalk.arrays import BoolArray, FloatArray, IntArray

LONGEST_ROWS = 3
"""Most successive rows that count as one wrong sample."""

FAR = 8.0
"""A jump counts as wrong from this multiple of the channel's usual large step on, the
99 % quantile of its steps from row to row."""

BACK = 0.25
"""After a wrong sample the channel must be back within this share of the jump."""

MEASURED = ("position_rad", "velocity_rad_s", "torque_nm", "gyroscope_rad_s")
"""Fields of `Trace` in which wrong samples are looked for. Commands are not measured: a
strange command was sent."""


def outliers(values: FloatArray) -> BoolArray:
    """(T,) whether each of the (T,) values of a channel is a wrong sample.

    Missing values are no wrong samples; the rows beside them count as neighbours. The
    first and the last row cannot be judged.

    Example:
      >>> there_and_back = [*np.linspace(1, 2, 50), 0.0, *np.linspace(2, 1, 50)]
      >>> np.flatnonzero(outliers(np.array(there_and_back)))
      array([50])
    """
    wrong = np.zeros(len(values), bool)
    rows = np.flatnonzero(np.isfinite(values))
    if len(rows) < 2 * LONGEST_ROWS:
        return wrong
    there = values[rows]
    steps = np.diff(there)
    # a channel that hardly ever changes has a usual step of 0: then rounding counts
    finest = float(np.abs(steps[steps != 0]).min(initial=np.ptp(there)))
    wrong[rows[_beside_a_smooth_course(there, finest)]] = True
    least = FAR * max(float(np.quantile(np.abs(steps), 0.99)), finest)
    for length in range(1, LONGEST_ROWS + 1):
        away, back = steps[:-length], steps[length:]
        around = np.abs(there[length + 1 :] - there[: -length - 1])
        size = np.minimum(np.abs(away), np.abs(back))
        found = (size > least) & (away * back < 0) & (around < BACK * size)
        for first in np.flatnonzero(found) + 1:
            wrong[rows[first : first + length]] = True
    return wrong


def _beside_a_smooth_course(values: FloatArray, finest: float) -> IntArray:
    """Indices of single values far from the cubic through two neighbours either side.

    Far is `FAR` times the 95 % quantile of these distances, or `FAR` times the `finest`
    step of the values.
    """
    cubic = np.array([-1, 4, 0, 4, -1]) / 6
    apart = np.abs(values[2:-2] - np.convolve(values, cubic, "valid"))
    far = apart > FAR * max(float(np.quantile(apart, 0.95)), finest)
    # the lines through two neighbours on each side must meet, or it is a step
    gap = 2 * values[1:-3] - values[:-4] - 2 * values[3:-1] + values[4:]
    far &= np.abs(gap) < BACK * apart
    # a wrong value spoils the courses of its neighbours by two thirds of its error
    return np.flatnonzero(far & (apart >= maximum_filter1d(apart, 5))) + 2


def without_outliers(trace: Trace) -> tuple[Trace, tuple[str, ...]]:
    """The trace with wrong samples marked as missing, and a sentence about them.

    Without wrong samples the trace is returned unchanged, with no sentence.
    """
    wrong = _wrong(trace)
    if not wrong:
        return trace, ()
    count = sum(int(flags.sum()) for flags in wrong.values())
    changes: dict[str, Any] = {
        name: np.where(flags, np.nan, getattr(trace, name))
        for name, flags in wrong.items()
    }
    said = (
        f"{trace.name}: {count} {'value jumps' if count == 1 else 'values jump'} away "
        "for a moment and back, as no joint moves; left out as wrong samples"
    )
    return replace(trace, **changes), (said,)


def wrong_samples(trace: Trace, joints: Sequence[str]) -> Mapping[str, FloatArray]:
    """Times [s] of the wrong samples of a recording, by channel.

    A channel is named as in recordings, such as "position.elbow"; `joints` are the
    names of the trace's joints. Of the gyroscope's axes any counts.

    Example:
      >>> wrong_samples(trace, ["swing"])
      {'position.swing': array([2.31])}
    """
    found = dict[str, FloatArray]()
    for field, flags in _wrong(trace).items():
        quantity = field.partition("_")[0]
        if flags.shape[1] != len(joints) or quantity == "gyroscope":
            found[quantity] = trace.time_s[flags.any(axis=1)]
            continue
        for joint, own in zip(joints, flags.T, strict=True):
            if own.any():
                found[f"{quantity}.{joint}"] = trace.time_s[own]
    return found


def _wrong(trace: Trace) -> dict[str, BoolArray]:
    """(T, c) which values are wrong samples, by the fields that have any."""
    found = dict[str, BoolArray]()
    for name in MEASURED:
        values: FloatArray | None = getattr(trace, name)
        if values is None:
            continue
        flags = np.stack([outliers(column) for column in values.T], axis=1)
        if flags.any():
            found[name] = flags
    return found

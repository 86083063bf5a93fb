"""Audits single channels: noise, rounding, and missing, stuck or repeated values."""

from collections.abc import Iterator

import numpy as np

from diagnosis.audit.result import ChannelAudit, Finding
from diagnosis.plant.plant import Plant
from diagnosis.traces.noise import noise_of
from diagnosis.traces.trace import JOINT_FIELDS, VECTOR_FIELDS, Trace, runs
from groundwalk.arrays import BoolArray, FloatArray
from worlds.recordings.columns import vector_columns

COMMANDS = ("command.", "command_torque.")
"""Prefixes of the names of columns that are commanded, not measured."""
_MOST_MISSING = 0.5
"""A channel with a larger share of missing values than this cannot be used."""
_BURST_S = 0.1
"""Time without values [s] from which on a channel's gap limits conclusions."""
_STUCK_ROWS = 4
"""Number of successive rows at a channel's extreme value that may be clipped."""
_STAYS, _LONG_STAY_ROWS = 2, 10
"""A channel counts as clipped from this number of stays at an extreme value on, or from
this number of rows in all stays together."""
_ARRIVAL = 4.0
"""Smallest speed, in noise steps per row, at which a channel must reach its extreme
value to count as clipped there."""
_REPEATED = 0.05
"""Share of the rows in motion that must repeat the row before for a finding."""


def channels_of(trace: Trace, plant: Plant) -> dict[str, FloatArray]:
    """All channels of a trace by the recording's column names, (T,) each.

    Quantities that were never recorded at a joint are left out.
    """
    channels: dict[str, FloatArray] = {}
    for quantity, field in JOINT_FIELDS.items():
        values = getattr(trace, field)
        for column, joint in enumerate(plant.joints if values is not None else ()):
            if quantity == "position" or np.isfinite(values[:, column]).any():
                channels[f"{quantity}.{joint}"] = values[:, column]
    for vector, field in VECTOR_FIELDS.items():
        values = getattr(trace, field)
        if values is not None:
            channels |= dict(zip(vector_columns(vector), values.T, strict=False))
    return channels


def audit_channel(trace: Trace, name: str, values: FloatArray) -> ChannelAudit:
    """Measure noise, clipping and missing values of a channel (T,), NaN if missing."""
    there = values[np.isfinite(values)]
    noise = noise_of(trace.time_s, values)
    constant = len(there) > 0 and bool(np.ptp(there) == 0)
    measured = len(there) > 0 and not constant and not name.startswith(COMMANDS)
    return ChannelAudit(
        name=name,
        noise_std=noise.std,
        quantum=noise.quantum,
        constant=constant,
        clipped_share=_clipped_share(name, values, noise.step) if measured else 0.0,
        missing_share=1 - len(there) / max(len(values), 1),
        longest_missing_s=_longest_s(trace.time_s, ~np.isfinite(values)),
    )


def channel_findings(trace: Trace, channel: ChannelAudit) -> Iterator[Finding]:
    """Findings on the missing and clipped values of one channel."""
    name = channel.name
    where, share = f"{name} of {trace.name}", channel.missing_share
    if share > _MOST_MISSING:
        driving = name.startswith(("position.", "command."))
        text = f"{where}: {share:.0%} of the values are missing"
        yield Finding("refuse" if driving else "limit", text, trace.name, name)
    elif share > 0:
        text, long = f"{where}: {share:.1%} of the values are missing", False
        if channel.longest_missing_s >= _BURST_S:
            span_s, long = channel.longest_missing_s, True
            text += f", up to {span_s:.2g} s at a stretch, which are not judged"
        yield Finding("limit" if long else "note", text, trace.name, name)
    if channel.clipped_share > 0:
        text = (
            f"{where} is stuck at an extreme in {channel.clipped_share:.1%} of the "
            "rows, as if the sensor or the motor had reached its limit"
        )
        is_position = name.startswith("position.")
        yield Finding("note" if is_position else "limit", text, trace.name, name)


def repeated_share(trace: Trace, steps: FloatArray) -> float:
    """Share of the rows in motion that repeat all positions of the row before.

    `steps` (j,) are those to which positions are rounded; 0 for continuous ones.
    """
    position = trace.position_rad
    if len(position) < 4:
        return 0.0
    around = np.abs(position[3:] - position[:-3]) > 3 * _ARRIVAL * steps
    moving = around.any(axis=1)
    same = (position[2:-1] == position[1:-2]).all(axis=1)
    return float(np.mean(same[moving])) if moving.any() else 0.0


def repeated_findings(trace: Trace, share: float) -> Iterator[Finding]:
    """The finding on a large share of rows that repeat the row before, or none."""
    if share >= _REPEATED:
        text = (
            f"{trace.name}: {share:.0%} of the rows taken in motion repeat the "
            "positions of the row before; the sensors are slower than the recording, "
            "and delays of that length cannot be distinguished from it"
        )
        yield Finding("limit", text, trace.name)


def _clipped_share(name: str, values: FloatArray, step: float) -> float:
    """Share of rows in which a channel stays at an extreme value, reached at speed.

    A signal that slows down has come to rest; noise alone can make a `step`. A foot
    without load rests at zero, which does not count.
    """
    stays = []
    ends = (np.nanmax(values), np.nanmin(values))
    for extreme in ends[:1] if name.startswith("foot_force") else ends:
        for start, stop in runs(values == extreme):
            if stop - start < _STUCK_ROWS or start < 3:
                continue
            # the last step to the extreme is cut off, so speed is that before it
            first, speed = np.abs(np.diff(values[start - 3 : start]))
            at_speed = speed > _ARRIVAL * step
            if at_speed and abs(extreme - values[start - 2]) > first:
                stays.append(stop - start)
    if len(stays) < _STAYS and sum(stays) < _LONG_STAY_ROWS:
        return 0.0
    return sum(stays) / len(values)


def _longest_s(time_s: FloatArray, mask: BoolArray) -> float:
    """Length [s] of the longest run of true flags in `mask` (T,), edges included."""
    longest = 0.0
    for start, stop in runs(mask):
        end = min(stop, len(time_s) - 1)
        longest = max(longest, float(time_s[end] - time_s[max(start - 1, 0)]))
    return longest

"""Measures the clock, channels and joints of a trace, and finds what limits its use."""

from collections.abc import Iterator, Sequence

import numpy as np

from diagnosis.audit.result import (
    ChannelAudit,
    Finding,
    JointAudit,
    Severity,
    TraceAudit,
)
from diagnosis.plant.plant import Plant
from diagnosis.traces.noise import noise_of
from diagnosis.traces.smoothing import Smoothed
from diagnosis.traces.trace import JOINT_FIELDS, VECTOR_FIELDS, Trace, runs
from groundwalk.arrays import BoolArray, FloatArray
from worlds.recordings.recording import vector_columns

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


def load_findings(trace: Trace) -> Iterator[Finding]:
    """Notes on the loads that the robot carried, as the recording states."""
    for body, load in trace.loads.items():
        place = ", ".join(f"{axis:g}" for axis in load.at)
        text = (
            f"{trace.name}: {body} carries {load.mass:g} kg at ({place}) m, as the "
            "recording states"
        )
        yield Finding("note", text, trace.name)


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


_LEAST_S, _LEAST_ROWS = 1.0, 50
"""Shortest recording that can be used: its duration [s] and its number of rows."""
_GAP = 2.5
"""Ticks (times between rows) longer than this many median ticks are gaps."""
_LONG_GAP_S = 0.1
"""Gaps between rows limit conclusions if they are this long [s] or longer."""
_SLOWEST_HZ, _SLOW_HZ = 5.0, 45.0
"""Rows per second below which a recording is unusable, and below which delays, armature
and elasticity cannot be estimated."""
_UNEVEN = 0.1
"""Jitter (standard deviation of the ticks) above this share of a tick is a finding."""


def audit_timing(trace: Trace) -> tuple[TraceAudit, list[Finding]]:
    """Measure rate, jitter and gaps of a trace, and find those that limit its use."""
    ticks = np.diff(trace.time_s)
    if not len(ticks) or (ticks <= 0).any() or not np.isfinite(trace.time_s).all():
        audit = TraceAudit(trace.name, trace.ticks, 0.0, 0.0, 0.0, 0, 0.0)
        return audit, [Finding("refuse", _no_clock(trace), trace.name, "time")]
    tick_s = trace.tick_s
    is_gap = ticks > _GAP * tick_s
    audit = TraceAudit(
        name=trace.name,
        rows=trace.ticks,
        duration_s=trace.duration_s,
        rate_hz=1 / tick_s,
        jitter_s=float(np.std(ticks[~is_gap])),
        gaps=int(is_gap.sum()),
        longest_gap_s=float(ticks[is_gap].max(initial=0.0)),
    )
    found = _findings(audit)
    return audit, [Finding(how, text, audit.name, "time") for how, text in found]


def _no_clock(trace: Trace) -> str:
    """What is wrong with times that do not increase, or with too few of them."""
    backwards = np.flatnonzero(~(np.diff(trace.time_s) > 0))
    if not len(backwards):
        return f"{trace.name} has {trace.ticks} rows; at least {_LEAST_ROWS} are needed"
    row = int(backwards[0]) + 1
    return (
        f"{trace.name}: time does not run forward at row {row}: "
        f"{trace.time_s[row - 1]:.6g} s, then {trace.time_s[row]:.6g} s"
    )


def _findings(audit: TraceAudit) -> Iterator[tuple[Severity, str]]:
    """Severity and text of each finding on the clock of a trace."""
    name, rate = audit.name, audit.rate_hz
    if audit.duration_s < _LEAST_S:
        lasts = f"{name} lasts {audit.duration_s:.3g} s"
        yield "refuse", f"{lasts}; at least {_LEAST_S:g} s are needed"
    if audit.rows < _LEAST_ROWS:
        few = f"{name} has {audit.rows} rows"
        yield "refuse", f"{few}; at least {_LEAST_ROWS} are needed"
    if rate < _SLOWEST_HZ:
        yield (
            "refuse",
            f"{name} has {rate:.3g} rows a second, too few to show motion; is its time "
            "in milliseconds instead of seconds?",
        )
    elif rate < _SLOW_HZ:
        yield (
            "limit",
            f"{name} has {rate:.3g} rows a second; below about 50, delays, armature "
            "and elasticity cannot be estimated",
        )
    if audit.gaps:
        is_long = audit.longest_gap_s >= _LONG_GAP_S
        after = "; what happened in them stays unknown" if is_long else ""
        yield (
            "limit" if is_long else "note",
            f"{name} has {audit.gaps} gaps, the longest of "
            f"{1e3 * audit.longest_gap_s:.3g} ms{after}",
        )
    if audit.jitter_s * rate > _UNEVEN:
        yield (
            "limit",
            f"{name}: ticks of {1e3 / rate:.3g} ms vary by "
            f"{1e3 * audit.jitter_s:.2g} ms; shorter delays are hidden in the jitter",
        )


_MOVES_NOISES, _MOVES_QUANTA, _MOVES_RAD = 8.0, 6.0, 1e-3
"""A joint moves if its range exceeds this many standard deviations of noise, this many
quanta and this angle [rad]."""
_FAST = 0.05
"""Speeds below this share of the largest one count as standstill when reversals are
counted."""
_LEAST_REVERSALS = 2
"""Number of changes of direction needed to tell Coulomb friction from a constant
torque."""


def audit_joint(joint: str, channel: ChannelAudit, smoothed: Smoothed) -> JointAudit:
    """Measure range, speed and reversals of one joint from its smoothed position."""
    low, high = float(np.min(smoothed.value)), float(np.max(smoothed.value))
    noise = channel.noise
    least = max(
        _MOVES_NOISES * noise.total, _MOVES_QUANTA * (noise.quantum or 0), _MOVES_RAD
    )
    moves = high - low > least
    speed = np.abs(smoothed.rate)
    fast = speed > _FAST * np.quantile(speed, 0.995)
    reversals = int(np.count_nonzero(np.diff(np.sign(smoothed.rate[fast]))))
    return JointAudit(
        name=joint,
        low_rad=low,
        high_rad=high,
        speed_rad_s=float(np.quantile(speed, 0.99)),
        reversals=reversals if moves else 0,
        moves=moves,
    )


def stuck_findings(
    trace: Trace, joints: Sequence[str], channels: dict[str, ChannelAudit]
) -> Iterator[Finding]:
    """Find channels that never change although the robot moves."""
    commanded = []
    for joint in joints:
        command = channels.get(
            f"command.{joint}", channels.get(f"command_torque.{joint}")
        )
        if command is not None and not command.constant:
            commanded.append(f"position.{joint}")
    dead = [name for name in commanded if channels[name].constant]
    every = len(dead) == len(commanded)
    for name in dead:
        text = (
            f"{name} of {trace.name} never changes although its command does"
            + (", and so for all joints" if every and len(dead) > 1 else "")
            + ": the joint is jammed or its sensor dead"
        )
        yield Finding("refuse" if every else "limit", text, trace.name, name)
    for name, channel in channels.items():
        if channel.constant and name.startswith(("gyroscope", "accelerometer")):
            text = f"{name} of {trace.name} never changes; it is left out"
            yield Finding("limit", text, trace.name, name)


def excitation_findings(traces: Sequence[TraceAudit]) -> Iterator[Finding]:
    """Find joints that never move or hardly reverse in all traces together."""
    for column, first in enumerate(traces[0].joints if traces else ()):
        name, joints = first.name, [trace.joints[column] for trace in traces]
        reversals = sum(joint.reversals for joint in joints if joint.moves)
        if not any(joint.moves for joint in joints):
            text = f"{name} never moves: its friction, inertia and play remain unknown"
        elif reversals < _LEAST_REVERSALS:
            text = (
                f"{name} reverses {reversals} times: its Coulomb friction and an "
                "offset of its torque or its encoder cannot be distinguished, nor can "
                "play be seen"
            )
        else:
            continue
        yield Finding("limit", text, channel=f"position.{name}")

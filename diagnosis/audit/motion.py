"""Audits how the joints moved, and finds the questions that this leaves open."""

from collections.abc import Iterator, Sequence

import numpy as np

from diagnosis.audit.result import ChannelAudit, Finding, JointAudit, TraceAudit
from diagnosis.traces.smoothing import Smoothed
from diagnosis.traces.trace import Trace
from groundwalk.arrays import FloatArray

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
    return JointAudit(
        name=joint,
        low_rad=low,
        high_rad=high,
        speed_rad_s=float(np.quantile(np.abs(smoothed.rate), 0.99)),
        reversals=_reversals(smoothed.rate) if moves else 0,
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


def _reversals(rate: FloatArray) -> int:
    """Number of changes of direction; rows that are almost still are left out."""
    fast = np.abs(rate) > _FAST * np.quantile(np.abs(rate), 0.995)
    direction = np.sign(rate[fast])
    return int(np.count_nonzero(np.diff(direction)))

"""Audits how the joints moved, and finds the questions that this leaves open."""

from collections.abc import Sequence

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
) -> list[Finding]:
    """Find channels that never change although the robot moves."""
    found, dead = [], []
    commanded = []
    for joint in joints:
        command = channels.get(
            f"command.{joint}", channels.get(f"command_torque.{joint}")
        )
        if command is not None and not command.constant:
            commanded.append(joint)
            if channels[f"position.{joint}"].constant:
                dead.append(joint)
    for joint in dead:
        name = f"position.{joint}"
        every = len(dead) == len(commanded)
        text = (
            f"{name} of {trace.name} never changes although its command does"
            + (", and so for all joints" if every and len(dead) > 1 else "")
            + ": the joint is jammed or its sensor dead"
        )
        found.append(Finding("refuse" if every else "limit", text, trace.name, name))
    for name, channel in channels.items():
        if channel.constant and name.startswith(("gyroscope", "accelerometer")):
            text = f"{name} of {trace.name} never changes; it is left out"
            found.append(Finding("limit", text, trace.name, name))
    return found


def excitation_findings(traces: Sequence[TraceAudit]) -> list[Finding]:
    """Find joints that never move or hardly reverse in all traces together."""
    found = []
    for column, first in enumerate(traces[0].joints if traces else ()):
        joints = [trace.joints[column] for trace in traces]
        text = _left_open(first.name, [joint for joint in joints if joint.moves])
        if text:
            found.append(Finding("limit", text, channel=f"position.{first.name}"))
    return found


def _left_open(name: str, moving: Sequence[JointAudit]) -> str:
    if not moving:
        return f"{name} never moves: its friction, inertia and play remain unknown"
    reversals = sum(joint.reversals for joint in moving)
    if reversals < _LEAST_REVERSALS:
        return (
            f"{name} reverses {reversals} times: its Coulomb friction and an offset of "
            "its torque or its encoder cannot be distinguished, nor can play be seen"
        )
    return ""


def _reversals(rate: FloatArray) -> int:
    """Number of changes of direction; rows that are almost still are left out."""
    fast = np.abs(rate) > _FAST * np.quantile(np.abs(rate), 0.995)
    direction = np.sign(rate[fast])
    return int(np.count_nonzero(np.diff(direction)))

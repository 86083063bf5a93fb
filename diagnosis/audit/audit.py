"""Audits recordings before a diagnosis: noise, gaps, motion and contradictions."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from diagnosis.audit.measures import (
    audit_channel,
    audit_joint,
    audit_timing,
    channel_findings,
    channels_of,
    excitation_findings,
    repeated_findings,
    repeated_share,
    stuck_findings,
)
from diagnosis.audit.result import Audit, Finding, TraceAudit
from diagnosis.audit.suspicions import (
    drive_findings,
    following_findings,
    imu_findings,
    range_findings,
    torque_findings,
    velocity_findings,
)
from diagnosis.plant.plant import Plant
from diagnosis.traces.smoothing import smooth
from diagnosis.traces.trace import Trace


def audit(traces: Sequence[Trace], plant: Plant) -> Audit:
    """Measure all traces, and find what makes them unusable or limits conclusions.

    A delay between commands and positions is no finding: it is physics that a diagnosis
    looks for.
    """
    audits, findings = [], []
    for trace in traces:
        one, found = _audit_trace(trace, plant)
        audits.append(one)
        findings += found
    findings += excitation_findings([one for one in audits if one.joints])
    return Audit(tuple(audits), tuple(findings))


def _audit_trace(trace: Trace, plant: Plant) -> tuple[TraceAudit, list[Finding]]:
    timing, findings = audit_timing(trace)
    findings += drive_findings(trace, plant)
    if any(item.severity == "refuse" and item.channel == "time" for item in findings):
        return timing, findings
    channels = {
        name: audit_channel(trace, name, values)
        for name, values in channels_of(trace, plant).items()
    }
    positions = [channels[f"position.{joint}"] for joint in plant.joints]
    smoothed = [
        smooth(trace.time_s, values, channel.noise.total)
        for values, channel in zip(trace.position_rad.T, positions, strict=True)
    ]
    joints = tuple(map(audit_joint, plant.joints, positions, smoothed))
    steps = np.array([channel.quantum or 0.0 for channel in positions])
    repeated = repeated_share(trace, steps)
    for channel in channels.values():
        findings += channel_findings(trace, channel)
    findings += [
        *repeated_findings(trace, repeated),
        *stuck_findings(trace, plant.joints, channels),
        *range_findings(trace, plant),
        *following_findings(trace, plant),
        *velocity_findings(trace, plant, smoothed, [joint.moves for joint in joints]),
        *torque_findings(trace, plant),
        *imu_findings(trace),
    ]
    every = tuple(channels.values())
    audited = replace(timing, repeated_share=repeated, channels=every, joints=joints)
    return audited, findings

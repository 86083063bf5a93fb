"""Audits recordings before a diagnosis: noise, gaps, motion and contradictions."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from diagnosis.audit.channels import (
    audit_channel,
    channel_findings,
    channels_of,
    repeated_findings,
    repeated_share,
)
from diagnosis.audit.forces import imu_findings, torque_findings
from diagnosis.audit.motion import audit_joint, excitation_findings, stuck_findings
from diagnosis.audit.result import Audit, Finding, TraceAudit
from diagnosis.audit.suspicions import (
    drive_findings,
    following_findings,
    range_findings,
    velocity_findings,
)
from diagnosis.audit.timing import audit_timing
from diagnosis.plant.plant import Plant
from diagnosis.traces.smoothing import Smoothed, smooth
from diagnosis.traces.trace import Trace


def audit(traces: Sequence[Trace], plant: Plant) -> Audit:
    """Measure all traces, and find what makes them unusable or limits conclusions.

    A delay between commands and positions is no finding: it is physics that a diagnosis
    looks for.

    Example:
      See docs/python.md.
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
    measured = replace(
        timing,
        repeated_share=repeated_share(
            trace, np.array([channel.quantum or 0.0 for channel in positions])
        ),
        channels=tuple(channels.values()),
        joints=tuple(map(audit_joint, plant.joints, positions, smoothed)),
    )
    for channel in measured.channels:
        findings += channel_findings(trace, channel)
    findings += repeated_findings(trace, measured.repeated_share)
    findings += stuck_findings(trace, plant.joints, channels)
    return measured, findings + _suspicions(trace, plant, measured, smoothed)


def _suspicions(
    trace: Trace, plant: Plant, measured: TraceAudit, smoothed: list[Smoothed]
) -> list[Finding]:
    """Findings on contradictions within a recording, or between it and the model."""
    moves = [joint.moves for joint in measured.joints]
    return [
        *range_findings(trace, plant),
        *following_findings(trace, plant),
        *velocity_findings(trace, plant, smoothed, moves),
        *torque_findings(trace, plant),
        *imu_findings(trace),
    ]

"""Audits recordings before a diagnosis: noise, gaps, motion and contradictions."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from diagnosis.audit import measures, suspicions
from diagnosis.audit.clocks import clock_findings
from diagnosis.audit.result import Audit, Finding, TraceAudit
from diagnosis.plant.plant import Plant
from diagnosis.traces.smoothing import smooth
from diagnosis.traces.trace import Trace


def audit(
    traces: Sequence[Trace], plant: Plant, healthy: Sequence[Trace] = ()
) -> Audit:
    """Measure all traces, and find what makes them unusable or limits conclusions.

    A delay between commands and positions is no finding: it is physics that a diagnosis
    looks for. Clocks are compared with those of recordings of the `healthy` robot.

    Example:
      >>> audit(traces, plant).limits
    """
    audits, findings = [], []
    for trace in traces:
        one, found = _audit_trace(trace, plant)
        audits.append(one)
        findings += found
    findings += clock_findings([one for one in traces if one.ticks > 1], healthy)
    findings += measures.excitation_findings([one for one in audits if one.joints])
    return Audit(tuple(audits), tuple(findings))


def _audit_trace(trace: Trace, plant: Plant) -> tuple[TraceAudit, list[Finding]]:
    timing, findings = measures.audit_timing(trace)
    findings += suspicions.drive_findings(trace, plant)
    if any(item.severity == "refuse" and item.channel == "time" for item in findings):
        return timing, findings
    channels = {
        name: measures.audit_channel(trace, name, values)
        for name, values in measures.channels_of(trace, plant).items()
    }
    positions = [channels[f"position.{joint}"] for joint in plant.joints]
    smoothed = [
        smooth(trace.time_s, values, channel.noise.total)
        for values, channel in zip(trace.position_rad.T, positions, strict=True)
    ]
    joints = tuple(map(measures.audit_joint, plant.joints, positions, smoothed))
    moves = [joint.moves for joint in joints]
    steps = np.array([channel.quantum or 0.0 for channel in positions])
    repeated = measures.repeated_share(trace, steps)
    for channel in channels.values():
        findings += measures.channel_findings(trace, channel)
    findings += [
        *measures.load_findings(trace),
        *measures.repeated_findings(trace, repeated),
        *measures.stuck_findings(trace, plant.joints, channels),
        *suspicions.range_findings(trace, plant),
        *suspicions.following_findings(trace, plant),
        *suspicions.velocity_findings(trace, plant, smoothed, moves),
        *suspicions.torque_findings(trace, plant),
        *suspicions.imu_findings(trace),
    ]
    every = tuple(channels.values())
    audited = replace(timing, repeated_share=repeated, channels=every, joints=joints)
    return audited, findings

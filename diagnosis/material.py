"""Prepares recordings for a diagnosis: audits them, and takes out what is no physics.

Wrong samples are marked as missing, ranges of the robot model that the recordings
contradict are lifted, and stalls are cut away. A stall is a moment after which all
joints follow their commands later. A pulse is a constant torque, for a while, that a
joint's servo did not ask for.
"""

from collections.abc import Sequence
from dataclasses import dataclass

from diagnosis.audit.audit import audit
from diagnosis.audit.result import Audit
from diagnosis.audit.suspicions import contradicted_ranges
from diagnosis.plant.plant import Plant
from diagnosis.residuals.channels import Channels, shared_channels
from diagnosis.residuals.torques.asked_torques import with_asked_torques
from diagnosis.residuals.torques.torque_evidence import (
    torques_tell,
    with_motions,
    with_used_torques,
)
from diagnosis.traces.outliers import without_outliers
from diagnosis.traces.pulses import pulses_of, without_pulses
from diagnosis.traces.reference import Reference
from diagnosis.traces.stalls import said_of_stalls, steady
from diagnosis.traces.trace import DriveBy, Trace, driven_by_torques, with_motor_torques
from diagnosis.verdict import Pulse
from groundwalk.errors import BadRecordingError


@dataclass(frozen=True, eq=False)
class Material:
    """Recordings that are ready for a diagnosis.

    Attributes:
      traces: the longest part of each recording without a stall; torques of pulses
        are replayed, values that pulses falsified are missing.
      reference: recordings of the healthy robot, prepared in the same way.
      channels: the channels that all recordings measured, or torques where the motion
        of `traces` and `reference` was smoothed to compare those that it needs.
      pulses: torques found in `traces` that no servo asked for.
      plant: the nominal robot model, without ranges that the recordings contradict.
      before: that of the healthy robot; often the same.
      limits: sentences about wrong samples and stalls of `traces`, and about compared
        torques, for the report.
    """

    plant: Plant
    before: Plant
    audited: Audit
    traces: tuple[Trace, ...]
    reference: tuple[Trace, ...]
    channels: Channels
    pulses: tuple[Pulse, ...]
    limits: tuple[str, ...]

    @classmethod
    def of(
        cls,
        plant: Plant,
        traces: Sequence[Trace],
        reference: Reference | None,
        drive: DriveBy,
    ) -> "Material":
        """Audit and prepare recordings of a robot, and of the healthy robot if any.

        Raises:
          BadRecordingError: the audit refuses a recording in `traces`, or a recording
            lacks the torques that are to drive the joints.
        """
        traces, said = _without_outliers(traces)
        healthy, _ = _without_outliers(reference.traces if reference else ())
        audited = audit(traces, plant, healthy)
        if audited.refused:
            raise BadRecordingError(audited.refused[0])
        before = reference.plant if reference else plant
        gone = contradicted_ranges([*traces, *healthy], plant)
        plant, before = plant.without_ranges(gone), before.without_ranges(gone)
        held = any(not trace.unheld for trace in (*traces, *healthy))
        ready, pulses = _prepared(plant, traces, drive)
        healthy, _ = _prepared(before, healthy, drive)
        why = torques_tell(plant, (*ready, *healthy), held)
        if why:
            both = (*ready, *healthy)
            plant, before = (with_used_torques(one, both) for one in (plant, before))
            every = with_motions(plant, both)
            ready, healthy = tuple(every[: len(ready)]), tuple(every[len(ready) :])
            said = (*said, why)
        elif asked := with_asked_torques((plant, before), ready, healthy):
            ready, healthy, why = asked
            both = (*ready, *healthy)
            plant, before = (with_used_torques(one, both) for one in (plant, before))
            said = (*said, why)
        return cls(
            plant,
            before,
            audited,
            traces=ready,
            reference=healthy,
            channels=shared_channels(plant, [*ready, *healthy]),
            pulses=pulses,
            limits=(*said, *(text for one in traces for text in said_of_stalls(one))),
        )


def _without_outliers(
    traces: Sequence[Trace],
) -> tuple[tuple[Trace, ...], tuple[str, ...]]:
    """Traces with wrong samples marked as missing, and sentences about them."""
    every = [without_outliers(trace) for trace in traces]
    return tuple(one for one, _ in every), tuple(t for _, said in every for t in said)


def _prepared(
    plant: Plant, traces: Sequence[Trace], drive: DriveBy
) -> tuple[tuple[Trace, ...], tuple[Pulse, ...]]:
    """Remove stalls and pulses, and choose what drives the joints in replays."""
    ready, pulses = list[Trace](), list[Pulse]()
    for trace in map(steady, traces):
        own = pulses_of(plant, trace)
        clean = without_pulses(plant, trace, own)
        drive_torques = driven_by_torques if drive == "torques" else with_motor_torques
        ready.append(drive_torques(clean))
        pulses += own
    return tuple(ready), tuple(pulses)

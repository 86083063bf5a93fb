"""The torque that each joint had: measured, asked for by its servo, or commanded."""

from collections.abc import Callable, Sequence

import numpy as np

from diagnosis.plant.plant import Plant
from diagnosis.replay.asked import by_servos
from diagnosis.seen.result import Source
from diagnosis.traces.trace import Trace
from groundwalk.arrays import FloatArray

WHY = {
    "floating": "The base is free, and what touches it is not measured: the torque "
    "that the motion needs is not known.",
    "unknown": "Neither its torque nor its servo's gains and commands are known, so "
    "its loss torque is not known, either.",
}
"""Sentences on why the loss torque of a joint is not known."""


def known_torques(
    plant: Plant, traces: Sequence[Trace]
) -> tuple[list[FloatArray], list[Source]]:
    """(T, j) torques [N m] of each trace, NaN if unknown, and each joint's source.

    Of each joint the source counts that most recordings have; of several a measured
    torque, then that of the servo, then a torque target. All zeros are no measurement,
    unless nothing was commanded: then nothing drives the joint.
    """
    order: list[tuple[Source, Callable[[Trace], FloatArray | None]]] = [
        ("measured", lambda trace: trace.torque_nm),
        ("servo", _by_servos),
        ("target", _targets),
    ]
    nothing = [np.full_like(trace.position_rad, np.nan) for trace in traces]
    found, sources = nothing, list[Source](["unknown"] * len(plant.joints))
    most = np.zeros(len(plant.joints), int)
    for source, of in order:
        each = [of(trace) for trace in traces]
        known = np.sum([_known(one, len(most)) for one in each], axis=0)
        for j in np.flatnonzero(known > most):
            most[j], sources[j] = known[j], source
            for own, one in zip(found, each, strict=True):
                own[:, j] = np.nan if one is None else one[:, j]
    if all(map(_is_passive, traces)):
        for j in np.flatnonzero(most == 0):
            sources[j] = "passive"
            for own in found:
                own[:, j] = 0.0
    return found, sources


def _is_passive(trace: Trace) -> bool:
    """Whether all torques and torque targets are 0, and no position was commanded."""
    torques = [trace.torque_nm, trace.command_torque_nm]
    known = [one for one in torques if one is not None]
    return trace.command_rad is None and bool(known) and not np.any(known)


def _known(torque_nm: FloatArray | None, joints: int) -> FloatArray:
    """(j,) 1 for each joint whose torques (T, j) are known, else 0."""
    if torque_nm is None:
        return np.zeros(joints, int)
    return np.asarray(np.nan_to_num(torque_nm).any(axis=0).astype(int))


def _by_servos(trace: Trace) -> FloatArray | None:
    """(T, j) torques by the servos' declared law, NaN at joints without a servo."""
    if trace.command_rad is None:
        return None
    return np.where(trace.servo.kp_nm_rad > 0, by_servos(trace), np.nan)


def _targets(trace: Trace) -> FloatArray | None:
    """(T, j) torque targets at the rows' times: means of those before and after."""
    target = trace.command_torque_nm
    if target is None:
        return None
    return np.asarray((target + np.concatenate([target[:1], target[:-1]])) / 2)

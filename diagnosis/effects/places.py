"""At which joints an effect may be: those that something drives, or that masks name."""

from collections.abc import Sequence

import numpy as np

from diagnosis.plant.plant import Plant
from diagnosis.traces.trace import Trace
from groundwalk.arrays import BoolArray


def joints_where(plant: Plant, masks: Sequence[BoolArray]) -> tuple[str, ...]:
    """Names of the joints for which at least one of the masks (j,) is true."""
    found = np.flatnonzero(np.any(masks, axis=0))
    return tuple(plant.joints[column] for column in found)


def driven_joints(plant: Plant, traces: Sequence[Trace]) -> tuple[str, ...]:
    """Names of the joints that a servo or a torque drives in any recording."""
    driven = [_is_driven(one) for one in traces]
    return joints_where(plant, driven or [plant.servo.kp_nm_rad > 0])


def _is_driven(trace: Trace) -> BoolArray:
    """(j,) whether a joint has a servo, or a torque that is not always 0."""
    driven = trace.servo.kp_nm_rad > 0
    for torque in (trace.torque_nm, trace.command_torque_nm):
        if trace.unheld and torque is not None:
            driven = driven | np.nan_to_num(torque).any(axis=0)
    return np.asarray(driven)

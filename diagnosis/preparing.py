"""Recordings made ready: what is wrong with them is said and left out."""

import itertools
from collections.abc import Sequence
from dataclasses import dataclass

from diagnosis.plant.plant import Plant
from diagnosis.traces.pulses import pulses_of, without_pulses
from diagnosis.traces.stalls import said_of_stalls, steady
from diagnosis.traces.torque_drive import DriveBy, driven_by_torques
from diagnosis.traces.trace import Trace
from diagnosis.verdict.verdict import Pulse


@dataclass(frozen=True, eq=False)
class Prepared:
    """Traces that a diagnosis can use.

    Attributes:
      traces: without stalls, their pulses accounted for.
      pulses: of all of them.
      said: of what was left out.
    """

    traces: tuple[Trace, ...]
    pulses: tuple[Pulse, ...]
    said: tuple[str, ...]


def prepared(plant: Plant, traces: Sequence[Trace], drive: DriveBy) -> Prepared:
    """Leave stalls out, find pulses, and choose what drives the joints.

    Args:
      plant: nominal.
      traces: whole.
      drive: the servos or the measured torques, where both are known.
    """
    said = [text for trace in traces for text in said_of_stalls(trace)]
    ready = [steady(trace) for trace in traces]
    pulses = [pulses_of(plant, trace) for trace in ready]
    ready = [
        without_pulses(plant, trace, own)
        for trace, own in zip(ready, pulses, strict=True)
    ]
    if drive == "torques":
        ready = [driven_by_torques(trace) for trace in ready]
    return Prepared(tuple(ready), tuple(itertools.chain(*pulses)), tuple(said))

"""Recordings of a robot while it was healthy, and its model at that time."""

from collections.abc import Sequence
from dataclasses import dataclass

from diagnosis.plant.plant import Plant
from diagnosis.traces.trace import Trace


@dataclass(frozen=True, eq=False)
class Reference:
    """Recordings of a robot while it was healthy, and its model at that time.

    Their difference from that model was there before anything changed. If the robot has
    another tool or another model since, `plant` is not that of its later recordings;
    its joints are the same, in the same order.

    Example:
      >>> plant, before = read_traces(["last_year.parquet"], "nao")
      >>> diagnose(plant, today, np.random.SeedSequence(1), reference=Reference(
      ...     plant, before))
    """

    plant: Plant
    traces: Sequence[Trace]

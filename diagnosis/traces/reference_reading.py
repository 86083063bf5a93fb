"""Reading the recordings of a robot when all was well."""

from collections.abc import Sequence
from pathlib import Path

from diagnosis.plant.plant import Plant
from diagnosis.plant.servo_sources import Gains
from diagnosis.traces.read import read_traces
from diagnosis.traces.trace import Trace
from groundwalk.errors import BadRecordingError


def read_reference(
    paths: Sequence[Path],
    source: str | Path,
    plant: Plant,
    servo: Gains | None = None,
) -> list[Trace]:
    """Traces of recordings that go with those of a plant.

    Args:
      paths: the recordings; none gives none.
      source: the robot, as for `load_plant`.
      plant: of the recordings that are to be diagnosed.
      servo: gains for recordings that state none.

    Raises:
      BadRecordingError: one cannot be read, or it has other joints or another base
        than the recordings that are to be diagnosed.
      UnknownNameError, BadModelError: as `load_plant`.
    """
    if not paths:
        return []
    own, traces = read_traces(paths, source, servo)
    if own.base != plant.base:
        raise BadRecordingError(
            f"{paths[0]}: the base of the reference is {own.base}, that of the "
            f"recordings {plant.base}"
        )
    differing = sorted(set(own.joints) ^ set(plant.joints))
    if differing:
        raise BadRecordingError(
            f"{paths[0]}: only one of the reference and the recordings has joint "
            f"{differing[0]!r}"
        )
    return traces

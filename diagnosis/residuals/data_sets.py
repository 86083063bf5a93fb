"""The data of one diagnosis: what is fitted to, selected by, and kept for the end."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from diagnosis.plant.plant import Plant
from diagnosis.residuals.channels import Channels
from diagnosis.residuals.predictor import STEPS_S, Model, Predictor
from diagnosis.residuals.reference_noise import ReferenceNoise
from diagnosis.traces.shorten import LEAST_FLOATING_S, LEAST_S, shortened
from diagnosis.traces.split import Split, split
from diagnosis.traces.trace import Trace
from diagnosis.verdict.verdict import Recordings
from groundwalk.errors import BadRecordingError

TOO_SHORT = (
    "the recordings are too short: a part for fitting, selecting or testing ends "
    "before its start state is forgotten"
)

FIT_S, SELECT_S, TEST_S = 40.0, 20.0, 40.0
"""So much of the recordings is replayed."""

FLOATING_S = 3.0, 3.0, 6.0
"""Likewise of a robot on its feet, where contacts take their time."""


MOST_WRONG = 0.25
"""Rms [noise] that replays may be wrong by, besides what their calibration takes out:
more of it would show up as physics."""


@dataclass(frozen=True, eq=False)
class DataSets:
    """Predictors of the parts of some recordings, calibrated at the plant alone.

    Attributes:
      parts: of the recordings.
      fit: of the data that values are fitted to.
      select: of those that decide between models.
      learned: of both.
      test: of those that are looked at once, at the end.
    """

    parts: Split
    fit: Predictor
    select: Predictor
    learned: Predictor
    test: Predictor
    _whole: Predictor

    @classmethod
    def of(
        cls,
        plant: Plant,
        traces: Sequence[Trace],
        channels: Channels,
        noise: ReferenceNoise | None,
        threads: int,
        on_replay: Callable[[int], None] | None = None,
    ) -> "DataSets":
        """Split traces, and calibrate.

        Args:
          plant: nominal.
          traces: of the robot.
          channels: with their noise.
          noise: model errors known from reference recordings; none where None.
          threads: of the replays.
          on_replay: see `Predictor`.

        Raises:
          BadRecordingError: the traces are too short.
        """
        parts = affordable(plant, split(traces))
        every = [*parts.fit, *parts.select, *parts.test]
        whole = Predictor(
            plant,
            every,
            channels,
            threads=threads,
            noise=noise,
            on_replay=on_replay,
        )
        whole = _exact(whole)
        first, last = len(parts.fit), len(parts.fit) + len(parts.select)
        evidence = cls(
            parts,
            fit=whole.part(0, first),
            select=whole.part(first, last),
            learned=whole.part(0, last),
            test=whole.part(last, len(every)),
            _whole=whole,
        )
        needed = evidence.fit, evidence.select, evidence.test
        if not all(part.scored.any() for part in needed):
            raise BadRecordingError(TOO_SHORT)
        return evidence

    def calibrated(self, model: Model) -> tuple[Predictor, Predictor]:
        """Predictors of the data learned from and of the test data, for a model."""
        whole = _exact(self._whole, model) if model else self._whole
        last = len(self.learned.traces)
        return whole.part(0, last), whole.part(last, len(whole.traces))

    def recordings(self) -> Recordings:
        """Which recordings were used for what."""
        parts = self.parts
        return Recordings(_names(parts.fit), _names(parts.select), _names(parts.test))


def _exact(whole: Predictor, model: Model = ()) -> Predictor:
    """Calibrated at a model, with shorter steps if these are too wrong."""
    for step_s in STEPS_S[whole.plant.base]:
        if step_s < whole.step_s:
            whole = whole.stepped(step_s)
        if step_s == whole.step_s and whole.calibrate(model) < MOST_WRONG:
            break
    return whole


def affordable(plant: Plant, parts: Split) -> Split:
    """The parts, cut down to what the search can replay some hundred times."""
    floats = plant.base == "floating"
    longest_s = FLOATING_S if floats else (FIT_S, SELECT_S, TEST_S)
    least_s = LEAST_FLOATING_S if floats else LEAST_S
    return Split(
        *(
            tuple(shortened(some, most_s, least_s))
            for some, most_s in zip(
                (parts.fit, parts.select, parts.test), longest_s, strict=True
            )
        )
    )


def _names(traces: Sequence[Trace]) -> tuple[str, ...]:
    return tuple(trace.name for trace in traces)

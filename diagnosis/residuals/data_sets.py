"""Divides recordings by their use, and estimates how long a diagnosis of them takes."""

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from diagnosis.effects.library import all_effects
from diagnosis.effects.parts import PlacedEffect
from diagnosis.plant.plant import Plant
from diagnosis.residuals.channels import Channels
from diagnosis.residuals.predictor import Model, Predictor
from diagnosis.residuals.reference_noise import ReferenceNoise
from diagnosis.residuals.steps import PRECISE_S, exact_steps, with_best_steps
from diagnosis.residuals.torques.torque_predictor import predictor_of
from diagnosis.residuals.trust import Trust
from diagnosis.traces.split import (
    LEAST_FLOATING_S,
    LEAST_S,
    Split,
    shortened,
    split,
    thinned,
)
from diagnosis.traces.trace import Trace
from diagnosis.verdict import Recordings
from groundwalk.arrays import FloatArray
from groundwalk.errors import BadRecordingError

TOO_SHORT = (
    "the recordings are too short: a part for fitting, selecting or testing is shorter "
    "than the time in which the influence of its start state fades"
)

FIT_S, SELECT_S, TEST_S = 40.0, 20.0, 40.0
"""Most seconds of the data for fitting, for selection and for the final test: more
would hardly improve the answer, but simulations would take longer."""

FLOATING_S = 3.0, 3.0, 6.0
"""Most seconds of the data for fitting, for selection and for the final test if the
base floats: its contacts take long to simulate."""


WINDOWS_S = (8.0, 4.0, 2.0, 1.0)
"""Lengths [s] of windows that are tried for joints without servos, longest first."""

STANDS_OUT = 8.0
"""Something happened in a recording if the nominal sim's error in it is this multiple
of its usual error in the others: more than by other motions."""

NEAR = 0.02
"""Largest distance of a replay from the recorded motion, as a share of each joint's
range in the recording, in 95 % of the rows."""


@dataclass(frozen=True, eq=False)
class DataSets:
    """Predictors (simulations to compare with recordings) for each use of the data.

    They are calibrated at the nominal model: they correct its integration error.

    Parameters are fitted to `fit`, `select` decides between models, `learned` is both
    together, and the held-out data `test` are used once, at the end.
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
        trust: Trust | None = None,
    ) -> "DataSets":
        """Split recordings, shorten the parts and calibrate their predictors.

        `trust` are weights of recordings, by default 1. Other arguments are those of
        `Predictor`.

        Raises:
          BadRecordingError: the traces are too short.
        """
        window_s = longest_window_s(plant, traces, channels, threads)
        errors = errors_of_event(plant, traces, channels, threads, window_s)
        parts = affordable(plant, split(traces, errors))
        every = [*parts.fit, *parts.select, *parts.test]
        every = thinned(plant, every, len(channels.names))
        options = None, threads, noise, on_replay, window_s
        whole = predictor_of(plant, every, channels, *options)
        whole.trusting(trust or {})
        whole = with_best_steps(whole)
        first, last = len(parts.fit), len(parts.fit) + len(parts.select)
        learned, test = _learned_and_test(whole, last, ())
        fit, select = learned.part(0, first), learned.part(first, last)
        if not all(part.scored.any() for part in (fit, select, test)):
            raise BadRecordingError(TOO_SHORT)
        return cls(parts, fit, select, learned, test, whole)

    def calibrated(self, model: Model) -> tuple[Predictor, Predictor]:
        """Predictors of `learned` and of `test` data, calibrated at another model."""
        if not model:
            return self.learned, self.test
        whole = exact_steps(self._whole, model)
        return _learned_and_test(whole, len(self.learned.traces), model)

    def recordings(self) -> Recordings:
        """Names of the recordings, or of parts of them, by their use."""
        uses = self.parts.fit, self.parts.select, self.parts.test
        return Recordings(*(tuple(trace.name for trace in use) for use in uses))


def _learned_and_test(
    whole: Predictor, last: int, model: Model
) -> tuple[Predictor, Predictor]:
    """Predictors of the first traces and of the others, calibrated at a model.

    Small mismatch of the nominal model is fitted to the first ones only. What wrong
    start states change is known of the `whole`.
    """
    parts = whole.part(0, last), whole.part(last, len(whole.traces))
    learned, test = parts
    learned.fit_nuisance(model)
    test.take_nuisance(learned.nuisance, model)
    for part in parts:
        part.correct(model)
    return learned, test


def longest_window_s(
    plant: Plant, traces: Sequence[Trace], channels: Channels, threads: int = 1
) -> float:
    """Length [s] of windows for joints without servos, over which replays stay close.

    In long windows small effects grow large. But a replay must stay near the recorded
    motion, or it says nothing about it. 0 if all joints have servos.
    """
    if plant.base == "floating" or not any(
        trace.loose and trace.motion is None for trace in traces
    ):
        return 0.0
    some, joints = shortened(traces, PRECISE_S), len(plant.joints)
    reach = np.max(
        [np.nanmax(t.position_rad, 0) - np.nanmin(t.position_rad, 0) for t in some],
        axis=0,
    )
    for longest_s in WINDOWS_S:
        predictor = Predictor(
            plant, some, channels, threads=threads, window_s=longest_s
        )
        wrong = np.abs(predictor.residuals([()])[0] * channels.noise[predictor.channel])
        far = wrong.reshape(-1, len(channels.names))[:, :joints] / np.maximum(
            reach, 1e-9
        )
        if np.quantile(far, 0.95) < NEAR:
            return longest_s
    return 0.0


def errors_of_event(
    plant: Plant,
    traces: Sequence[Trace],
    channels: Channels,
    threads: int,
    window_s: float,
) -> list[FloatArray] | None:
    """The nominal sim's errors, if it is far more wrong in one recording than usual.

    Then something happened that the others do not show, and recordings are to be cut
    into parts that all show it. Errors are for each recording the largest of the
    channels in each row (T,) [noise].
    """
    if len(traces) < 2 or plant.base == "floating":
        return None
    predictor = predictor_of(
        plant, traces, channels, threads=threads, window_s=window_s
    )
    (left,) = predictor.residuals([()])
    left = left * (channels.noise / channels.floor)[predictor.channel]
    rms = [
        np.sqrt(np.mean(left[(predictor.trace == k) & predictor.scored] ** 2))
        for k in range(len(traces))
    ]
    *others, most = sorted(rms)
    if most < STANDS_OUT * max(float(np.median(others)), 1.0):
        return None
    size = np.abs(left).reshape(-1, len(channels.names)).max(axis=1)
    ends = np.cumsum([trace.rows for trace in traces])
    return [
        np.repeat(own, trace.compared.step)[: trace.ticks]
        for own, trace in zip(np.split(size, ends[:-1]), traces, strict=True)
    ]


def affordable(plant: Plant, parts: Split) -> Split:
    """The parts, shortened so that a search can simulate them often.

    The limits are lower for a floating base.
    """
    floats = plant.base == "floating"
    most_s = FLOATING_S if floats else (FIT_S, SELECT_S, TEST_S)
    least_s = LEAST_FLOATING_S if floats else LEAST_S
    uses = zip((parts.fit, parts.select, parts.test), most_s, strict=True)
    return Split(
        *(tuple(shortened(use, longest_s, least_s)) for use, longest_s in uses)
    )


REPLAYS = {"fixed": 600, "floating": 1500}
"""Typical number of simulations of the fitting data in one diagnosis, by the robot's
base. Six test cases with a fixed base needed 160 to 920, more for more effects. The
number for floating bases, where more effects are tried, is a guess."""


def expected_seconds(
    plant: Plant,
    traces: Sequence[Trace],
    reference: Sequence[Trace],
    channels: Channels,
    threads: int,
) -> float:
    """Estimated duration of a diagnosis [s], right within a factor of two or three.

    One batch is simulated and timed: every kind of effect once, at its first place. On
    a fixed base a search in the recordings of the healthy robot (`reference`) precedes
    that in `traces` and takes as long.
    """
    fit = affordable(plant, split(traces)).fit
    fit = tuple(thinned(plant, fit, len(channels.names)))
    predictor = predictor_of(plant, fit, channels, threads=threads)
    models: list[Model] = []
    for name, kind in all_effects().items():
        for place in kind.places(plant, predictor.traces)[:1]:
            values = tuple(one.typical for one in kind.parameters(plant, place))
            models.append((PlacedEffect(name, place, values),))
    begun_s = time.monotonic()
    predictor.predict(models)
    each_s = (time.monotonic() - begun_s) / len(models)
    searches = 2 if reference and plant.base == "fixed" else 1
    return searches * REPLAYS[plant.base] * each_s

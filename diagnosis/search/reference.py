"""Learns the errors of a robot model from recordings of the healthy robot."""

from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np

from diagnosis.audit.audit import audit
from diagnosis.effects.library import keys_within
from diagnosis.plant.plant import Plant
from diagnosis.residuals.channels import Channels
from diagnosis.residuals.data_sets import longest_window_s
from diagnosis.residuals.doubted import no_nuisance
from diagnosis.residuals.left_out import left_out
from diagnosis.residuals.predictor import Model, Predictor
from diagnosis.residuals.reference_noise import ReferenceNoise
from diagnosis.residuals.small_mismatch.usual_errors import is_usual
from diagnosis.residuals.steps import with_best_steps
from diagnosis.residuals.torques.torque_predictor import predictor_of
from diagnosis.search.few_or_many import found_by
from diagnosis.search.fitting import fit_all
from diagnosis.search.hooks import Hooks
from diagnosis.search.judging import Judge, gain_of_noise
from diagnosis.search.result import pack_noise, unpack_noise
from diagnosis.search.rules import Rules
from diagnosis.search.search import Search
from diagnosis.traces.split import LEAST_FLOATING_S, shortened, split, thinned
from diagnosis.traces.trace import Trace
from diagnosis.traces.windows import FLOATING_WINDOW_S
from groundwalk.arrays import FloatArray, IntArray
from groundwalk.errors import BadRecordingError

MOST_S = 40.0
"""Most seconds used of all recordings of the healthy robot together [s]."""

CHECK_S = 6.0
"""Seconds of recordings of the healthy robot on which effects are checked: one that
gains there, too, is no change."""

SHIFTS = 3
"""Number of time offsets at which recordings on a floating base are cut into windows,
to get more windows from which to learn noise."""

MOST_FREED = 4
"""Most times that small mismatch which is larger than usual is given free bounds."""

REPLAYS = 40
"""Rough number of simulations for learning noise from recordings of the healthy robot;
only for the progress display."""


class _Simulations(NamedTuple):
    """What all simulations of recordings of the healthy robot have in common.

    Attributes:
      window_s: length of the windows, see `longest_window_s`.
      finest_s: shortest step with which the integration error is measured.
      finer: by recording, how many steps are taken for a usual one.
    """

    plant: Plant
    channels: Channels
    threads: int
    hooks: Hooks
    window_s: float
    finest_s: float | None = None
    finer: Mapping[str, int] | None = None

    @classmethod
    def of(
        cls,
        plant: Plant,
        traces: Sequence[Trace],
        channels: Channels,
        threads: int,
        hooks: Hooks,
    ) -> "_Simulations":
        """Simulations in windows over which replays stay close, with exact steps."""
        window_s = longest_window_s(plant, traces, channels, threads)
        sims = cls(plant, channels, threads, hooks, window_s)
        best = with_best_steps(sims.uncalibrated(traces, None))
        finer = {
            trace.recording: round(best.step_s / step_s)
            for trace, step_s in zip(traces, best.steps_s, strict=True)
        }
        return sims._replace(finest_s=best.finest_s, finer=finer)

    def predictor(
        self,
        traces: Sequence[Trace],
        noise: ReferenceNoise | None = None,
    ) -> Predictor:
        """A calibrated predictor of recordings.

        Small mismatch that `noise` has is taken as it is, what may be beside it is not
        fitted.
        """
        predictor = self.uncalibrated(traces, noise)
        if noise is None:
            predictor.calibrate()
            return predictor
        predictor.correct()
        errors = no_nuisance(predictor) if self.plant.base == "fixed" else None
        predictor.doubt_beside(errors, ())
        return predictor

    def uncalibrated(
        self, traces: Sequence[Trace], noise: ReferenceNoise | None
    ) -> Predictor:
        """A predictor of recordings with windows as for those to be diagnosed."""
        options = None, self.threads, noise, self.hooks.advance, self.window_s
        found = predictor_of(self.plant, traces, self.channels, *options)
        if self.finer is None or found.by_torque:
            return found
        finer = [self.finer[trace.recording] for trace in traces]
        return found.stepped(found.step_s, self.finest_s, finer)


def learn_reference(
    plant: Plant,
    traces: Sequence[Trace],
    channels: Channels,
    rules: Rules | None = None,
    threads: int = 1,
    hooks: Hooks | None = None,
    known: Model | None = None,
) -> ReferenceNoise:
    """Learn the difference between a robot model and the healthy robot.

    With a fixed base the effects that explain the difference are searched for first, as
    in any recording. A robot on a floating base differs from its model in every
    contact, which no effect describes; there all of the difference counts as noise.

    `traces` are recordings of the healthy robot, `channels` are those of the recordings
    to be diagnosed, with their noise. `known` effects, with values, explain the
    difference without a search; None to search.

    Raises:
      BadRecordingError: the recordings are unusable or too short to learn from.
    """
    refused = audit(traces, plant).refused
    if refused:
        raise BadRecordingError(f"the reference: {refused[0]}")
    hooks = (hooks or Hooks()).within("reference")
    traces = thinned(plant, shortened(traces, MOST_S), len(channels.names))
    sims = _Simulations.of(plant, traces, channels, threads, hooks)
    model = known or ()
    if plant.base == "fixed":
        found = _explained(sims, traces, rules) if known is None else known
        model = _with_small_mismatch(sims, traces, found)
    hooks.stage("noise", REPLAYS)
    return _learned(sims, traces, model)


def _learned(
    sims: _Simulations, traces: Sequence[Trace], model: Model
) -> ReferenceNoise:
    """The errors that a model leaves in recordings, as noise."""

    def work() -> ReferenceNoise:
        count = len(sims.channels.names)
        known = ReferenceNoise.known(model, count)
        floats = sims.plant.base == "floating"
        every = [late for one in traces for late in _shifted(one)] if floats else traces
        predictor = sims.predictor(every, known)
        scored = predictor.scored.reshape(-1, count)
        if floats:
            (residual,) = predictor.residuals([()])
            shaped = residual.reshape(-1, count)
            return ReferenceNoise.of(model, shaped, scored, predictor.blocks)
        (left,) = predictor.without_tolerances().residuals([()])
        found, changes = _unknown(sims, predictor, model)
        parts = _parts(predictor)
        residual = left_out(left, changes, parts).reshape(-1, count)
        noise = ReferenceNoise.of(model, residual, scored, predictor.blocks)
        if predictor.nuisance is None:
            return noise
        shaped, own = left.reshape(-1, count), parts.reshape(-1, count)[:, 0]
        unknown = changes.reshape(len(changes), -1, count)
        return noise.knowing(unknown, shaped, predictor.blocks, own, found)

    return sims.hooks.saved(work, pack_noise, unpack_noise)


def _unknown(
    sims: _Simulations, predictor: Predictor, model: Model
) -> tuple[Model, FloatArray]:
    """What recordings of the healthy robot leave unknown of a model.

    Returns the effects whose values are free, and (k, N) changes of the residual by
    small mismatch, then by these values. What fits these recordings alone would else
    pass for what the robot always has.
    """
    nuisance = predictor.nuisance
    entries = len(predictor.scored)
    changes = np.zeros((0, entries)) if nuisance is None else nuisance.changes.whole()
    found = tuple(one for one in model if not is_usual(sims.plant, one))
    if found:
        rest = tuple(one for one in model if one not in found)
        known = ReferenceNoise.known(rest, len(sims.channels.names))
        others = sims.uncalibrated(predictor.traces, known)
        others.calibrate(found, tolerances=False)
        (fitted,) = fit_all(others, [found], 1)
        changes = np.vstack([changes, fitted.jacobian.T])
    return found, changes


def _parts(predictor: Predictor) -> IntArray:
    """(N,) number of the recording of each entry; halves of one that is alone."""
    if len(predictor.traces) > 1:
        return predictor.trace
    return np.asarray(2 * predictor.block > predictor.block.max(), int)


def reference_checks(
    plant: Plant,
    traces: Sequence[Trace],
    channels: Channels,
    noise: ReferenceNoise,
    threads: int = 1,
    hooks: Hooks | None = None,
) -> list[Predictor]:
    """Predictors of recordings of the healthy robot, to reject effects seen there, too.

    An effect that explains as much of these recordings is no change. With a floating
    base each half of them is judged with the noise learned from the other half: with
    its own noise nothing would be left to explain. With a fixed base the `noise` is
    what is left if each is left out, and the effects that are known. Other arguments
    are those of `learn_reference`.
    """
    hooks = (hooks or Hooks()).within("reference check")
    hooks.stage("", 2 * REPLAYS)
    traces = thinned(plant, shortened(traces, MOST_S), len(channels.names))
    sims = _Simulations.of(plant, traces, channels, threads, hooks)
    if plant.base == "fixed":
        return [sims.predictor(traces, noise)]
    halves = _halves(traces)
    checks = []
    for own, other in (halves, halves[::-1]):
        some = shortened(own, CHECK_S / 2, LEAST_FLOATING_S)
        checks.append(sims.predictor(some, _learned(sims, other, ())))
    return checks


def _halves(traces: Sequence[Trace]) -> tuple[list[Trace], list[Trace]]:
    """Recordings in two parts; a single one is cut in the middle."""
    if len(traces) > 1:
        return list(traces[::2]), list(traces[1::2])
    (trace,) = traces
    middle = trace.ticks // 2
    return [trace.part(0, middle)], [trace.part(middle, trace.ticks)]


def reference_limit(plant: Plant, noise: ReferenceNoise) -> tuple[str, ...]:
    """A sentence for the report: what the healthy robot shows is not searched for."""
    large = [one for one in noise.model if not is_usual(plant, one)]
    known = ", ".join(f"{one.name} at {one.place}" for one in large)
    given = f" ({known})" if known else ""
    return (
        f"differences from the sim that the reference recordings show as well{given} "
        "are taken as given: only what has changed since is searched for",
    )


def _explained(
    sims: _Simulations, traces: Sequence[Trace], rules: Rules | None
) -> Model:
    """The effects that a search finds in recordings."""
    parts = split(traces)
    fit, select = (*parts.fit, *parts.test), parts.select
    whole = sims.predictor([*fit, *select])
    parted = whole.part(0, len(fit)), whole.part(len(fit), len(whole.traces))
    judge = Judge(*parted, rules, hooks=sims.hooks)
    result, _ = found_by(Search(judge), tested=False)
    return result.winner.model if result.winner else ()


def _with_small_mismatch(
    sims: _Simulations, traces: Sequence[Trace], model: Model
) -> Model:
    """A model, and the small mismatch that is likely beside it in recordings.

    What is larger than usual becomes an effect without bounds: the rest would look new.
    Of the models on the way that which leaves least is taken: the integration error of
    each is measured only there, and can be larger than what the step to it gained.
    """
    predictor = sims.uncalibrated(traces, None)
    model = predictor.calibrate_with(model)
    found = [_with_likely(predictor, model)]
    for _ in range(MOST_FREED):
        larger = _larger_than_usual(predictor, model)
        if not larger:
            break
        own = predictor.with_tolerances_beside((*model, *larger))
        model = predictor.calibrate_with(fit_all(own, [(*model, *larger)])[0].model)
        found.append(_with_likely(predictor, model))
    return min(found, key=lambda one: one[0])[1]


def _with_likely(predictor: Predictor, model: Model) -> tuple[float, Model]:
    """What a model leaves [nats] beside likely small mismatch, and both as one model.

    Its integration error is the one that was measured last.
    """
    (left,) = predictor.without_tolerances().residuals([model])
    nuisance = predictor.nuisance
    likely = () if nuisance is None else nuisance.beside(keys_within(model))
    return 0.5 * float(left @ left), (*likely, *model)


def _larger_than_usual(predictor: Predictor, model: Model) -> Model:
    """Small mismatch on a bound beside a model that would gain if it were larger."""
    if predictor.nuisance is None:
        return ()
    (left,) = predictor.without_tolerances().residuals([model])
    least = gain_of_noise(len(predictor.nuisance.units))
    taken = keys_within(model)
    return tuple(
        placed
        for placed, gain in predictor.nuisance.unusual(left)
        if gain > least and placed.key not in taken
    )


def _shifted(trace: Trace) -> list[Trace]:
    """A recording, and the same without its first 0.1 s and its first 0.2 s."""
    rows = FLOATING_WINDOW_S / SHIFTS / trace.tick_s
    firsts = [round(k * rows) for k in range(SHIFTS)]
    return [trace.part(k, trace.ticks) for k in firsts if trace.ticks > 2 * k]

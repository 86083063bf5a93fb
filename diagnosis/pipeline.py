"""Runs a diagnosis: from recordings to a verdict on the physics that a sim lacks.

Recordings are audited and prepared (`material.py`); a search finds effects, pieces of
physics that the sim lacks (`_searched`); they are fitted again and tested on held-out
data (`_tested`), and become the verdict (`_verdict`).
"""

import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from diagnosis.audit.result import Audit
from diagnosis.conclude.answer import (
    alternatives,
    believed_effects,
    verdict_kind,
    without_unsure,
)
from diagnosis.conclude.estimates import smallest_detectable
from diagnosis.conclude.held_out_errors import (
    held_out_errors,
    larger_than_learned,
    model_refuted,
)
from diagnosis.conclude.held_out_series import HeldOutSeries, held_out_series
from diagnosis.conclude.next_experiment import next_experiment
from diagnosis.material import Material
from diagnosis.plant.plant import Plant
from diagnosis.residuals.data_sets import DataSets, expected_seconds
from diagnosis.residuals.mismatch_map import mismatch_map, unexplained
from diagnosis.residuals.predictor import Model, Predictor
from diagnosis.residuals.reference_noise import ReferenceNoise
from diagnosis.search.accept import accepted
from diagnosis.search.all_joints import all_joints
from diagnosis.search.fitting import FittedModel, fit_all
from diagnosis.search.hooks import Hooks
from diagnosis.search.judging import Judge
from diagnosis.search.reference import (
    learn_reference,
    reference_checks,
    reference_limit,
)
from diagnosis.search.result import SearchResult
from diagnosis.search.rules import Rules
from diagnosis.search.search import Search
from diagnosis.traces.trace import DriveBy, Trace
from diagnosis.verdict import Amount, Fit, Verdict, VerdictKind
from groundwalk.blas import one_blas_thread

MORE_FLOATING = 4
"""Number of models that the search fits in addition if the base floats. Contacts make
the linear estimates unreliable by which it chooses models to fit."""

FIT_REPLAYS, TEST_REPLAYS = 150, 150
"""Rough numbers of replays of the recordings in sim before the search and in the final
test; they only scale the progress display."""


@dataclass(frozen=True, eq=False)
class Diagnosis:
    """A verdict and the models and predictors behind it.

    Attributes:
      model: the effects that the search accepted, with their fitted values.
      test: simulates the held-out recordings, less the integration error at `model`.
      nominal: the same, less the integration error of the nominal model.
      audit: what the audit of the recordings found.
      given: effects that recordings of the healthy robot show; empty without such.

    Example:
      >>> found = diagnose(plant, traces, np.random.SeedSequence(1))
      >>> print(found.verdict.kind, found.model)
    """

    verdict: Verdict
    model: Model
    plant: Plant
    test: Predictor
    nominal: Predictor
    audit: Audit
    given: Model = ()

    def held_out(self) -> list[HeldOutSeries]:
        """Held-out recordings as measured, and simulated without and with `model`."""
        return held_out_series(self.nominal, self.test, self.model)


@one_blas_thread
def diagnose(
    plant: Plant,
    traces: Sequence[Trace],
    seed: np.random.SeedSequence,
    rules: Rules | None = None,
    threads: int = 1,
    reference: Sequence[Trace] = (),
    drive: DriveBy = "servos",
    hooks: Hooks | None = None,
) -> Diagnosis:
    """Find out which physics recordings show that a robot model lacks.

    Args:
      plant: nominal robot model.
      traces: recordings of the robot.
      seed: seed of the flexible regression and of the random control.
      rules: settings of the search; None for the default ones.
      threads: number of threads that simulate.
      reference: recordings of the healthy robot; what they show is not looked for.
      drive: "servos": simulated servos follow the recorded commands; "torques": the
        measured torques act on the joints.
      hooks: progress display and checkpoint; None for neither.

    Raises:
      BadRecordingError: the recordings do not allow a diagnosis.

    Example:
      >>> plant, traces = read_traces(["a.parquet", "b.parquet"], "nao")
      >>> diagnose(plant, traces, np.random.SeedSequence(1)).verdict.effects
    """
    begun_s, hooks = time.monotonic(), hooks or Hooks()
    hooks.stage("audit", 1)
    material = Material.of(plant, traces, reference, drive)
    hooks.advance(1)
    if hooks.progress is not None:
        recordings = material.traces, material.reference
        seconds = expected_seconds(
            material.plant, *recordings, material.channels, threads
        )
        hooks.progress.cost(seconds)
    data, noise, search = _learned(material, rules, threads, hooks)
    result, kind = _searched(search, material.audited)
    hooks.stage("test", TEST_REPLAYS)
    tested = _tested(data, result, kind, seed)
    verdict = replace(
        _verdict(material, data, search, tested),
        alternatives=alternatives(result, kind),
        seconds=time.monotonic() - begun_s,
    )
    given: Model = ()
    if noise:
        given = noise.model
        verdict = replace(verdict, limits=(*verdict.limits, *reference_limit(noise)))
    sims = tested.test, data.test
    return Diagnosis(
        verdict, tested.model, material.plant, *sims, material.audited, given
    )


def _learned(
    material: Material, rules: Rules | None, threads: int, hooks: Hooks
) -> tuple[DataSets, ReferenceNoise | None, Search]:
    """The data by use, the healthy robot's model errors, and a search ready to run."""
    plant, reference, channels = material.plant, material.reference, material.channels
    noise, healthy = None, list[Predictor]()
    if reference:
        noise = learn_reference(plant, reference, channels, rules, threads, hooks)
    hooks.stage("fit", FIT_REPLAYS)
    data = DataSets.of(plant, material.traces, channels, noise, threads, hooks.advance)
    if reference:
        healthy = reference_checks(plant, reference, channels, threads, hooks)
    judge = Judge(data.fit, data.select, _rules(plant, rules), healthy, hooks)
    return data, noise, Search(judge)


def _rules(plant: Plant, rules: Rules | None) -> Rules:
    """Settings of a search, the default ones for None; a floating base fits more."""
    rules = rules or Rules()
    if plant.base == "fixed":
        return rules
    return replace(
        rules,
        single_effects=rules.single_effects + MORE_FLOATING,
        further_effects=rules.further_effects + MORE_FLOATING,
    )


def _searched(search: Search, audited: Audit) -> tuple[SearchResult, VerdictKind]:
    """Search for effects that the sim lacks, and decide the kind of the verdict.

    Where it would be `unknown`, the search goes on with one effect at all joints.
    """
    judge, plant = search.judge, search.judge.fit.plant
    result = without_unsure(accepted(judge, search.run()), judge.least_gain)
    kind = verdict_kind(result, plant, audited)
    # with a floating base, models with effects at all joints would take an hour
    if plant.base == "fixed" and kind == "unknown":
        result = all_joints(judge, result)
        kind = verdict_kind(result, plant, audited)
    return result, kind


@dataclass(frozen=True, eq=False)
class _Tested:
    """The effects that a search found, fitted again and tested on held-out data.

    The effects, None if there are none, were refitted to all data but the held-out
    ones. `both` simulates these data, `test` the held-out ones, both less the
    integration error at the effects; `fit` has the errors on held-out data.
    """

    result: SearchResult
    kind: VerdictKind
    refitted: FittedModel | None
    both: Predictor
    test: Predictor
    fit: Fit

    @property
    def model(self) -> Model:
        """The effects that the search found, with their final values."""
        return self.refitted.model if self.refitted else ()


def _tested(
    data: DataSets,
    result: SearchResult,
    kind: VerdictKind,
    seed: np.random.SeedSequence,
) -> _Tested:
    """Fit the effects found to all data but the held-out ones; test them on these."""
    if kind == "not_identifiable":  # then no effect is believed
        result = replace(result, chosen=0)
    winner = result.winner
    both, test = data.calibrated(winner.model if winner else ())
    refitted = fit_all(both, [winner.model])[0] if winner else None
    model = refitted.model if refitted else ()
    fit = held_out_errors((data.learned, data.test), both, test, result, model, seed)
    return _Tested(result, kind, refitted, both, test, fit)


def _verdict(
    material: Material, data: DataSets, search: Search, tested: _Tested
) -> Verdict:
    """The verdict; its kind becomes "unknown" where held-out data contradict it."""
    both, result, kind = tested.both, tested.result, tested.kind
    judge = search.judge
    nominal = data.learned.residuals([()])[0]
    left = tested.refitted.residual if tested.refitted else nominal
    unmodelled = data.test.residuals([()])[0]
    modelled = tested.test.residuals([tested.model])[0]
    larger = larger_than_learned(data.learned, left, tested.fit)
    refuted = model_refuted(unmodelled, modelled, judge.least_gain)
    share = 1 - result.closed(result.winner) if result.winner else 1.0
    shape = both, left, share
    if kind == "none" and larger:
        kind, shape = "unknown", (data.test, unmodelled, 1.0)
    if kind == "effects" and refuted:
        kind = "unknown"
    smallest: Mapping[str, Amount] = {}
    if kind in ("none", "not_identifiable"):
        gain = judge.least_fitted
        smallest = smallest_detectable(judge.fit, search.signatures, gain)
    effects = believed_effects(both, result, tested.refitted)
    return Verdict(
        kind=kind,
        effects=effects if kind != "none" else (),
        smallest_detectable=smallest,
        unexplained=unexplained(*shape) if kind == "unknown" else None,
        limits=(*larger, *refuted, *material.audited.limits, *material.limits),
        mismatch=mismatch_map(data.learned, nominal),
        pulses=material.pulses,
        fit=tested.fit,
        next_experiment=next_experiment(material.plant, result, material.traces),
        recordings=data.recordings(),
    )

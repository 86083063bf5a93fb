"""Runs a diagnosis: from recordings to a verdict on the physics that a sim lacks.

Recordings are audited and prepared (`material.py`); a search finds effects, pieces of
physics that the sim lacks (`learned.py`); they are fitted again and tested on held-out
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
    is_small,
)
from diagnosis.conclude.estimates import smallest_detectable
from diagnosis.conclude.guards import established, objections
from diagnosis.conclude.held_out_errors import (
    held_out_errors,
    larger_than_learned,
    model_refuted,
    rms_above_floor,
)
from diagnosis.conclude.held_out_series import HeldOutSeries, held_out_series
from diagnosis.conclude.next_experiment import next_experiment
from diagnosis.effects.library import effect
from diagnosis.learned import Learned
from diagnosis.material import Material
from diagnosis.plant.plant import Plant
from diagnosis.residuals.data_sets import DataSets, expected_seconds
from diagnosis.residuals.mismatch_map import mismatch_map, unexplained
from diagnosis.residuals.predictor import Model, Predictor
from diagnosis.search.fitting import FittedModel
from diagnosis.search.hooks import Hooks
from diagnosis.search.reference import (
    reference_limit,
)
from diagnosis.search.result import MOST_LEFT, SearchResult
from diagnosis.search.rules import Rules
from diagnosis.search.search import Search
from diagnosis.traces.trace import DriveBy, Trace
from diagnosis.verdict import Amount, Fit, Found, Unexplained, Verdict, VerdictKind
from groundwalk.blas import one_blas_thread

TEST_REPLAYS = 150
"""Rough number of replays of the recordings in sim in the final test; it only scales
the progress display."""


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
    learned = Learned.of(material, rules, threads, hooks)
    material = learned.material
    data, search = learned.data, learned.search
    hooks.stage("test", TEST_REPLAYS)
    tested = _tested(learned, seed)
    verdict = replace(
        _verdict(material, data, search, tested),
        alternatives=alternatives(learned.result, learned.kind),
        seconds=time.monotonic() - begun_s,
    )
    given: Model = ()
    if learned.noise:
        given = learned.noise.model
        more = reference_limit(learned.noise)
        verdict = replace(verdict, limits=(*verdict.limits, *more))
    sims = tested.test, data.test
    return Diagnosis(
        verdict, tested.model, material.plant, *sims, material.audited, given
    )


@dataclass(frozen=True, eq=False)
class _Tested:
    """The effects that a search found, fitted again and tested on held-out data.

    The effects, None if there are none, were refitted to all data but the held-out
    ones. `both` simulates these data, `test` the held-out ones, both less the
    integration error at the effects; `fit` has the errors on held-out data,
    `objections` are sentences on why nothing, or less, is established.
    """

    result: SearchResult
    kind: VerdictKind
    refitted: FittedModel | None
    both: Predictor
    test: Predictor
    fit: Fit
    objections: tuple[str, ...] = ()

    @property
    def model(self) -> Model:
        """The effects that the search found, with their final values."""
        return self.refitted.model if self.refitted else ()


def _tested(learned: Learned, seed: np.random.SeedSequence) -> _Tested:
    """Fit the effects found to all data but the held-out ones; test them on these.

    Where effects are at many joints only what is not among them is uncertain within
    tolerances; where these leave more than noise nothing is, since tolerances would
    explain what no model does.
    """
    data, result, kind = learned.data, learned.result, learned.kind
    if kind == "not_identifiable":  # then no effect is believed
        result = replace(result, chosen=0)
    winner = result.winner
    both, test = data.calibrated(winner.model if winner else ())
    if learned.inexact:
        both = both.without_tolerances()
    elif learned.everywhere:
        both = both.with_tolerances_beside(winner.model if winner else ())
    both, refitted, said = established(both, winner.model if winner else ())
    model = refitted.model if refitted else ()
    if not model:
        both, test = data.calibrated(())
    bare = [one.without_tolerances() for one in (data.learned, data.test, both, test)]
    fit = held_out_errors((bare[0], bare[1]), bare[2], bare[3], result, model, seed)
    if model:
        timed = all(effect(placed.name).timed for placed in model)
        said = (*said, *objections(fit, timed))
    return _Tested(result, kind, refitted, both, test, fit, said)


def _verdict(
    material: Material, data: DataSets, search: Search, tested: _Tested
) -> Verdict:
    """The verdict; its kind becomes "unknown" where held-out data contradict it."""
    both, result, kind = tested.both, tested.result, tested.kind
    judge = search.judge
    nominal = data.learned.residuals([()])[0]
    left = tested.refitted.residual if tested.refitted else nominal
    bare = data.learned.without_tolerances()
    unmodelled = data.test.residuals([()])[0]
    modelled = tested.test.residuals([tested.model])[0]
    before, after = ((data.learned, left), (data.test, modelled))
    larger = larger_than_learned(before, after)
    refuted = model_refuted(unmodelled, modelled, judge.least_gain)
    share = _share_left(tested.fit) if tested.model else 1.0
    shape = both, tested.model, share
    above = rms_above_floor(data.test, unmodelled)
    if kind == "none" and (larger or above**2 > 1 + MOST_LEFT):
        kind, shape = "unknown", (data.test, (), 1.0)
    nothing = tested.objections or (result.winner and not tested.model)
    if kind == "effects" and (refuted or nothing):
        kind = "unknown" if above**2 > 1 + MOST_LEFT else "none"
    effects = believed_effects(both, result, tested.refitted)
    small: tuple[Found, ...] = ()
    if kind == "effects":
        usual = {one.key for one in tested.model if is_small(material.plant, one)}
        small = tuple(one for one in effects if f"{one.name}@{one.place}" in usual)
        effects = tuple(one for one in effects if one not in small)
        kind = "effects" if effects else "none"
    smallest: Mapping[str, Amount] = {}
    if kind in ("none", "not_identifiable"):
        gain = judge.least_fitted
        smallest = smallest_detectable(judge.fit, search.signatures, gain)
    if kind == "unknown":  # then none of them is established
        effects = tuple(replace(one, probability=None) for one in effects)
    return Verdict(
        kind=kind,
        effects=effects if kind != "none" else (),
        small=small,
        smallest_detectable=smallest,
        unexplained=_shape(*shape) if kind == "unknown" else None,
        limits=(
            *larger,
            *refuted,
            *tested.objections,
            *material.audited.limits,
            *material.limits,
        ),
        mismatch=mismatch_map(bare, bare.residuals([()])[0]),
        pulses=material.pulses,
        fit=tested.fit,
        next_experiment=next_experiment(material.plant, result, material.traces),
        recordings=data.recordings(),
    )


def _shape(predictor: Predictor, model: Model, share: float) -> Unexplained | None:
    """The shape of the error that a model leaves, as a replay shows it."""
    bare = predictor.without_tolerances()
    return unexplained(bare, bare.residuals([model])[0], share)


def _share_left(fit: Fit) -> float:
    """Share of the squared error above the noise that the effects found leave."""
    left, nominal = (error**2 - fit.floor**2 for error in (fit.corrected, fit.nominal))
    return float(np.clip(left / nominal, 0.0, 1.0)) if nominal > 0 else 1.0

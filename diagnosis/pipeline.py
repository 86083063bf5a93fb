"""Runs a diagnosis: from recordings to a verdict on the physics that a sim lacks.

Recordings are audited and prepared (`material.py`); a search finds effects, pieces of
physics that the sim lacks (`learned.py`); they are fitted again and tested on held-out
data (`tested.py`), and become the verdict (`_verdict`).
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
from diagnosis.conclude.held_out_errors import (
    larger_than_learned,
)
from diagnosis.conclude.held_out_series import HeldOutSeries, held_out_series
from diagnosis.conclude.next_experiment import next_experiment
from diagnosis.conclude.nuisance_found import sure_nuisance
from diagnosis.conclude.smallest_sizes import smallest_detectable
from diagnosis.effects.library import keys_within
from diagnosis.learned import Learned
from diagnosis.material import Material
from diagnosis.plant.plant import Plant
from diagnosis.residuals.data_sets import expected_seconds
from diagnosis.residuals.mismatch_map import mismatch_map, unexplained
from diagnosis.residuals.predictor import Model, Predictor
from diagnosis.residuals.small_mismatch.usual_errors import acting
from diagnosis.search.hooks import Hooks
from diagnosis.search.judging import places_of_effects
from diagnosis.search.reference import (
    reference_limit,
)
from diagnosis.search.rules import Rules
from diagnosis.tested import Tested, tested_effects
from diagnosis.traces.reference import Reference
from diagnosis.traces.split import Split
from diagnosis.traces.trace import DriveBy, Trace
from diagnosis.verdict import Amount, Fit, Found, Unexplained, Verdict
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
      nominal: the same, less the integration error of the nominal model, and without
        its small mismatch.
      audit: what the audit of the recordings found.
      parts: the parts of the recordings by their use.
      given: effects that recordings of the healthy robot show, and likely small
        mismatch of its model; empty without such.

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
    parts: Split
    given: Model = ()

    @property
    def nuisance(self) -> Model:
        """Small mismatch of the nominal model beside `model`, with likely values.

        None if the verdict is "unknown": it would stand for what is missing.
        """
        nuisance = self.test.nuisance
        if nuisance is None or self.verdict.kind == "unknown":
            return ()
        return acting(self.plant, nuisance.beside(keys_within(self.model)))

    def held_out(self) -> list[HeldOutSeries]:
        """Held-out recordings as measured, and simulated without and with `model`.

        With it the small mismatch of the nominal model is corrected as well.
        """
        return held_out_series(self.nominal, self.test, self.model)


@one_blas_thread
def diagnose(
    plant: Plant,
    traces: Sequence[Trace],
    seed: np.random.SeedSequence,
    rules: Rules | None = None,
    threads: int = 1,
    reference: Reference | None = None,
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
      reference: recordings of the healthy robot, with its model at that time; what
        they show is not looked for. None without.
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
    hooks.stage("test", TEST_REPLAYS)
    tested = tested_effects(learned, seed)
    verdict = replace(
        _verdict(learned, tested),
        alternatives=alternatives(learned.result, learned.kind),
        seconds=time.monotonic() - begun_s,
    )
    plant = learned.material.plant
    given: Model = ()
    if learned.noise:
        given = acting(plant, learned.noise.model)
        more = reference_limit(plant, learned.noise)
        verdict = replace(verdict, limits=(*verdict.limits, *more))
    sims = tested.sims[1], learned.data.test.nominal()
    about = learned.material.audited, learned.data.parts
    return Diagnosis(verdict, tested.model, plant, *sims, *about, given)


def _verdict(learned: Learned, tested: Tested) -> Verdict:
    """The verdict; its kind becomes "unknown" where held-out data contradict it."""
    material, data, search = learned.material, learned.data, learned.search
    judge, kind, model = search.judge, learned.kind, tested.model
    both, test = tested.sims
    nominal = tested.nominal[0].residuals([()])[0]
    before = nominal if tested.refitted is None else tested.refitted.residual
    after = test.residuals([model])[0]
    larger = larger_than_learned((tested.nominal[0], before), (test, after))
    shape: tuple[Predictor, Model, float] | None = None
    if kind == "none" and model and tested.stands:
        kind = "effects"  # mismatch that is larger than usual
    elif kind == "effects" and not tested.stands:
        kind = "unknown" if tested.leaves_much else "none"
    elif kind == "none" and (larger or tested.leaves_much):
        kind, shape = "unknown", (tested.nominal[1], (), 1.0)
    share = _share_left(tested.fit) if model else 1.0
    shape = shape or (both, model, share)
    every = believed_effects(both, learned.result, tested.refitted)
    named, small = _by_size(learned, tested, every)
    if kind in ("effects", "none"):
        kind = "effects" if named else "none"
    else:
        small = ()
    smallest: Mapping[str, Amount] = {}
    if kind in ("none", "not_identifiable"):
        gain = judge.least_fitted
        smallest = smallest_detectable(judge.fit, search.signatures, gain)
    if kind == "unknown":  # then none of them is established
        named = tuple(replace(one, probability=None) for one in every)
    bare = data.learned.nominal().evenly()
    return Verdict(
        kind=kind,
        effects=named if kind in ("effects", "unknown") else (),
        small=small,
        smallest_detectable=smallest,
        unexplained=_shape(*shape) if kind == "unknown" else None,
        limits=(
            *larger,
            *tested.objections,
            *tested.limits,
            *material.audited.limits,
            *material.limits,
        ),
        mismatch=mismatch_map(bare, bare.residuals([()])[0]),
        pulses=material.pulses,
        fit=tested.fit,
        next_experiment=next_experiment(
            material.plant, learned.result, material.traces
        ),
        recordings=data.recordings(),
        tried=places_of_effects(judge.fit),
    )


def _by_size(
    learned: Learned, tested: Tested, found: tuple[Found, ...]
) -> tuple[tuple[Found, ...], tuple[Found, ...]]:
    """What is named, the most probable first, and small mismatch that is sure.

    What is usual differs from the model, not from the robot as it was before.
    """
    plant, least_gain = learned.material.plant, learned.search.judge.least_gain
    usual = {one.key for one in tested.model if is_small(plant, one)}
    usual = set() if learned.noise else usual
    small = tuple(one for one in found if f"{one.name}@{one.place}" in usual)
    named = [one for one in found if one not in small]
    errors, larger = sure_nuisance(tested.sims[0], tested.model, least_gain)
    named += larger
    named.sort(key=lambda one: -(one.probability or 0.0))
    return tuple(named), (*small, *(() if learned.noise else errors))


def _shape(predictor: Predictor, model: Model, share: float) -> Unexplained | None:
    """The shape of the error that a model leaves, as a replay shows it."""
    bare = predictor.evenly()
    return unexplained(bare, bare.residuals([model])[0], share)


def _share_left(fit: Fit) -> float:
    """Share of the squared error above the noise that the effects found leave."""
    left, nominal = (error**2 - fit.floor**2 for error in (fit.corrected, fit.nominal))
    return float(np.clip(left / nominal, 0.0, 1.0)) if nominal > 0 else 1.0

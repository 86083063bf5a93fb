"""From recordings to a verdict."""

import time
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from diagnosis.audit import audit
from diagnosis.audit_result import Audit
from diagnosis.belief import alternatives, confusable, probability, twins
from diagnosis.channels import channels_of
from diagnosis.effect import Placed
from diagnosis.estimates import estimates
from diagnosis.final_test import FinalTest
from diagnosis.fitting import Fit as FittedModel
from diagnosis.fitting import fit_all
from diagnosis.library import effect
from diagnosis.next_experiment import next_experiment
from diagnosis.plant import Plant
from diagnosis.power import smallest_detectable
from diagnosis.predictor import Model, Predictor
from diagnosis.regimes import mismatch
from diagnosis.search import Search
from diagnosis.search_result import Found as Searched
from diagnosis.search_result import Rules
from diagnosis.shortening import shortened
from diagnosis.split import Split, split
from diagnosis.trace import Trace
from diagnosis.unexplained import unexplained
from diagnosis.verdict import (
    EffectAt,
    Found,
    Recordings,
    Verdict,
    VerdictKind,
    When,
)
from diagnosis.widespread import widespread
from groundwalk.errors import BadRecordingError

TOO_SHORT = (
    "the recordings are too short: a part for fitting, selecting or testing ends "
    "before its start state is forgotten"
)

FIT_S, SELECT_S, TEST_S = 40.0, 20.0, 40.0
"""So much of the recordings is replayed."""

LEAST_CLOSED = 0.95
"""A model that takes away less of the energy above the noise is not all there is ..."""

MOST_LEFT = 0.5
"""... unless what it leaves is below so large a part of the noise's own energy."""


@dataclass(frozen=True, eq=False)
class Diagnosis:
    """A verdict and what it rests on.

    Attributes:
      verdict: the answer.
      model: the effects believed, with their values.
      plant: nominal.
      test: predicts the recordings that were kept for the end, calibrated at the model.
      nominal: the same, calibrated at the plant alone.
      audit: of the recordings.
    """

    verdict: Verdict
    model: Model
    plant: Plant
    test: Predictor
    nominal: Predictor
    audit: Audit


def diagnose(
    plant: Plant,
    traces: Sequence[Trace],
    seed: np.random.SeedSequence,
    rules: Rules | None = None,
    threads: int = 1,
) -> Diagnosis:
    """Find out what physics a plant lacks.

    Args:
      plant: nominal.
      traces: recordings of the robot.
      seed: of the flexible regression.
      rules: of the search; the usual ones where None.
      threads: of the replays.

    Raises:
      BadRecordingError: nothing can be said from these recordings.
    """
    begun_s = time.monotonic()
    audited = audit(traces, plant)
    if audited.refused:
        raise BadRecordingError(audited.refused[0])
    parts = _affordable(split(traces))
    every = [*parts.fit, *parts.select, *parts.test]
    whole = Predictor(plant, every, channels_of(plant, traces), threads=threads)
    whole.calibrate()
    learned = len(parts.fit) + len(parts.select)
    fit = whole.part(0, len(parts.fit))
    select = whole.part(len(parts.fit), learned)
    nominal = whole.part(0, learned), whole.part(learned, len(every))
    if not all(part.scored.any() for part in (fit, select, nominal[1])):
        raise BadRecordingError(TOO_SHORT)
    search = Search(fit, select, rules)
    searched = search.run()
    if _kind(searched, plant, audited) == "unknown":
        searched = widespread(search, searched)
    if searched.winner:
        whole.calibrate(searched.winner.model)
    both, test = whole.part(0, learned), whole.part(learned, len(every))
    refitted = fit_all(both, [searched.winner.model])[0] if searched.winner else None
    model = refitted.model if refitted else ()
    kind = _kind(searched, plant, audited)
    final = FinalTest(nominal, both, test, searched, model, seed)
    wrong = nominal[0].residuals([()])[0]
    left = refitted.residual if refitted else wrong
    share = 1 - searched.closed(searched.winner) if searched.winner else 1.0
    # signatures are of the fitting data, gains are asked for on the selection data
    gain = search.least_gain * fit.scored.sum() / select.scored.sum()
    verdict = Verdict(
        kind=kind,
        effects=_effects(both, searched, refitted) if kind != "none" else (),
        alternatives=alternatives(searched),
        smallest_detectable=(
            smallest_detectable(fit, search.signatures, gain)
            if kind in ("none", "not_identifiable")
            else {}
        ),
        unexplained=unexplained(both, left, share) if kind == "unknown" else None,
        limits=audited.limits,
        mismatch=mismatch(nominal[0], wrong),
        fit=final.fit(),
        next_experiment=next_experiment(plant, searched, traces),
        recordings=Recordings(
            _names(parts.fit), _names(parts.select), _names(parts.test)
        ),
        seconds=time.monotonic() - begun_s,
    )
    return Diagnosis(verdict, model, plant, test, nominal[1], audited)


def _affordable(parts: Split) -> Split:
    """The parts, cut down to what the search can replay some hundred times."""
    return Split(
        *(
            tuple(shortened(some, longest_s))
            for some, longest_s in (
                (parts.fit, FIT_S),
                (parts.select, SELECT_S),
                (parts.test, TEST_S),
            )
        )
    )


def _names(traces: Sequence[Trace]) -> tuple[str, ...]:
    return tuple(trace.name for trace in traces)


def _kind(searched: Searched, plant: Plant, audited: Audit) -> VerdictKind:
    energy = searched.winner.selected if searched.winner else searched.nothing
    left = energy - searched.floor
    closed = searched.closed(searched.winner) if searched.winner else 0.0
    if left > MOST_LEFT * searched.floor and closed < LEAST_CLOSED:
        return "unknown"
    if searched.winner:
        return "effects"
    still = [joint for joint in plant.joints if joint not in audited.moving]
    return "not_identifiable" if still else "none"


def _effects(
    both: Predictor, searched: Searched, refitted: FittedModel | None
) -> tuple[Found, ...]:
    if refitted is None or searched.winner is None:
        return ()
    values = estimates(both, refitted)
    found = [
        Found(
            name=placed.effect,
            place=placed.place,
            parameters=own,
            probability=probability(searched, placed),
            confusable_with=_distinct(
                confusable(searched, placed) + twins(both.plant, placed)
            ),
            when=_when(both, placed),
            native=effect(placed.effect).native,
        )
        for placed, own in zip(refitted.model, values, strict=True)
    ]
    return tuple(sorted(found, key=lambda one: -one.probability))


def _distinct(effects: Sequence[EffectAt]) -> tuple[EffectAt, ...]:
    return tuple(dict.fromkeys(effects))


def _when(both: Predictor, placed: Placed) -> When:
    first_s = min(trace.time_s[0] for trace in both.traces)
    last_s = max(trace.time_s[-1] for trace in both.traces)
    if placed.effect == "servo_fade":
        return When("drift", float(first_s), float(last_s))
    if placed.effect == "external_force":
        start_s, duration_s = placed.values[3:]
        if start_s > first_s or start_s + duration_s < last_s:
            return When("burst", start_s, start_s + duration_s)
    return When()

"""From recordings to a verdict."""

import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from diagnosis.audit.audit import audit
from diagnosis.audit.result import Audit
from diagnosis.conclude.answer import effects_of, kind_of, sure
from diagnosis.conclude.confidence import alternatives
from diagnosis.conclude.detectable import smallest_detectable
from diagnosis.conclude.held_out_errors import FinalTest
from diagnosis.conclude.held_out_series import HeldOutSeries, held_out_series
from diagnosis.conclude.next_experiment import next_experiment
from diagnosis.conclude.surprise import refutes, surprises
from diagnosis.plant.plant import Plant
from diagnosis.preparing import prepared
from diagnosis.residuals.channels import channels_of
from diagnosis.residuals.data_sets import Evidence
from diagnosis.residuals.mismatch_map import mismatch
from diagnosis.residuals.predictor import Model, Predictor
from diagnosis.residuals.unexplained import unexplained
from diagnosis.search.all_joints import widespread
from diagnosis.search.compared import compared
from diagnosis.search.fitting import fit_all
from diagnosis.search.proven import proven
from diagnosis.search.reference import said_of, standing_of, well_of
from diagnosis.search.result import Found as Searched
from diagnosis.search.result import Rules
from diagnosis.search.search import Search
from diagnosis.search.simpler import needed, simpler
from diagnosis.traces.torque_drive import DriveBy
from diagnosis.traces.trace import Trace
from diagnosis.verdict.verdict import Amount, Verdict, VerdictKind
from groundwalk.blas import one_blas_thread
from groundwalk.errors import BadRecordingError

MORE_ON_FEET = 4
"""More effects are fitted alone: contacts make guesses at first order worth less."""


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
      given: effects that were there when all was well; none without a reference.
    """

    verdict: Verdict
    model: Model
    plant: Plant
    test: Predictor
    nominal: Predictor
    audit: Audit
    given: Model = ()

    def held_out(self) -> list[HeldOutSeries]:
        """Measured, nominal and corrected course of each held-out recording."""
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
) -> Diagnosis:
    """Find out what physics a plant lacks.

    Args:
      plant: nominal.
      traces: recordings of the robot.
      seed: of the flexible regression.
      rules: of the search; the usual ones where None.
      threads: of the replays.
      reference: recordings of the robot when all was well; what they show is no effect.
      drive: what moves the joints in replays where both are known.

    Raises:
      BadRecordingError: nothing can be said from these recordings.
    """
    begun_s = time.monotonic()
    audited = audit(traces, plant)
    if audited.refused:
        raise BadRecordingError(audited.refused[0])
    ready = prepared(plant, traces, drive)
    traces, reference = ready.traces, prepared(plant, reference, drive).traces
    channels = channels_of(plant, [*traces, *reference])
    standing = (
        standing_of(plant, reference, channels, rules, threads) if reference else None
    )
    data = Evidence.of(plant, traces, channels, standing, threads)
    well = well_of(plant, reference, channels, threads) if reference else ()
    search = Search(data.fit, data.select, _rules(plant, rules), well)
    searched = _searched(search, audited)
    kind = kind_of(searched, plant, audited)
    others = alternatives(searched, kind)
    if kind == "not_identifiable":  # then nothing is believed
        searched = replace(searched, chosen=0)
    winner = searched.winner
    both, test = data.calibrated(winner.model if winner else ())
    refitted = fit_all(both, [winner.model])[0] if winner else None
    model = refitted.model if refitted else ()
    wrong = data.learned.residuals([()])[0]
    left = refitted.residual if refitted else wrong
    share = 1 - searched.closed(winner) if winner else 1.0
    final = FinalTest((data.learned, data.test), both, test, searched, model, seed)
    fit = final.fit()
    surprised = surprises(data.learned, left, fit)
    unmodelled, modelled = data.test.residuals([()])[0], test.residuals([model])[0]
    refuted = refutes(unmodelled, modelled, search.least_gain)
    rest = (both, left, share)
    if kind == "none" and surprised:
        kind, rest = "unknown", (data.test, unmodelled, 1.0)
    if kind == "effects" and refuted:
        kind = "unknown"
    limits = (*surprised, *refuted, *audited.limits, *ready.said)
    verdict = Verdict(
        kind=kind,
        effects=effects_of(both, searched, refitted) if kind != "none" else (),
        alternatives=others,
        smallest_detectable=_detectable(search, kind),
        unexplained=unexplained(*rest) if kind == "unknown" else None,
        limits=(*limits, *(said_of(standing) if standing else ())),
        mismatch=mismatch(data.learned, wrong),
        pulses=ready.pulses,
        fit=fit,
        next_experiment=next_experiment(plant, searched, traces),
        recordings=data.recordings(),
        seconds=time.monotonic() - begun_s,
    )
    given = standing.model if standing else ()
    return Diagnosis(verdict, model, plant, test, data.test, audited, given)


def _rules(plant: Plant, rules: Rules | None) -> Rules:
    rules = rules or Rules()
    if plant.base == "fixed":
        return rules
    return replace(
        rules,
        singles=rules.singles + MORE_ON_FEET,
        others=rules.others + MORE_ON_FEET,
    )


def _searched(search: Search, audited: Audit) -> Searched:
    """What single effects explain, or whole kinds of them if these do not."""
    plant = search.fit.plant
    searched = compared(search, search.run())
    searched = proven(search, needed(search, simpler(search, searched)))
    searched = sure(searched, search.least_gain)
    # on feet, models of whole kinds would take an hour
    if plant.base == "fixed" and kind_of(searched, plant, audited) == "unknown":
        return widespread(search, searched)
    return searched


def _detectable(search: Search, kind: VerdictKind) -> Mapping[str, Amount]:
    if kind not in ("none", "not_identifiable"):
        return {}
    return smallest_detectable(search.fit, search.signatures, search.least_fitted)

"""Fits the effects that a search found again, and tests them on held-out data."""

from copy import copy
from dataclasses import dataclass, replace

import numpy as np

from diagnosis.conclude.guards import NO_BETTER, established, is_worse, objections
from diagnosis.conclude.held_out_errors import (
    above_nominal,
    beside_control,
    hardly_more_than_noise,
    held_out_errors,
    model_refuted,
    rms_above_floor,
)
from diagnosis.conclude.nuisance_found import with_unusual_ones
from diagnosis.conclude.shared_friction import with_shared_friction
from diagnosis.effects.library import lasts
from diagnosis.learned import Learned
from diagnosis.residuals.predictor import Model, Predictor
from diagnosis.search.fitting import FittedModel
from diagnosis.search.judging import gain_of_noise
from diagnosis.verdict import Fit

NOTHING = "The values of all effects found may as well be those of no effect."
"""Sentence on why none of the effects found is established."""


@dataclass(frozen=True, eq=False)
class Tested:
    """A model, fitted again and tested on held-out data.

    Attributes:
      refitted: the effects, fitted to all data but the held-out ones; None for none.
      nominal: predictors of these and of the held-out data, at the nominal model.
      sims: the same, at the effects.
      fit: errors on held-out data.
      objections: sentences on why nothing, or less, is established.
      limits: further sentences for the limits of the verdict.
    """

    refitted: FittedModel | None
    nominal: tuple[Predictor, Predictor]
    sims: tuple[Predictor, Predictor]
    fit: Fit
    objections: tuple[str, ...] = ()
    limits: tuple[str, ...] = ()

    @property
    def model(self) -> Model:
        """The effects with their final values."""
        return self.refitted.model if self.refitted else ()

    @property
    def stands(self) -> bool:
        """Whether held-out data confirm the effects."""
        return not self.objections

    @property
    def leaves_much(self) -> bool:
        """Whether the nominal sim, with small mismatch, leaves more than noise."""
        test = self.nominal[1]
        above = rms_above_floor(test, test.residuals([()])[0])
        return above**2 > 1 + hardly_more_than_noise(test)


def tested_effects(learned: Learned, seed: np.random.SeedSequence) -> Tested:
    """The effects found, or none if they fail the test and hardly more than noise is.

    Where they fail and more is left they stay, as guesses.
    """
    found: Model = ()
    if learned.kind != "not_identifiable" and learned.result.winner:
        found = learned.result.winner.model
    may_be_more = learned.kind != "not_identifiable"
    tested = _test_of(learned, found, seed, may_be_more)
    if tested.stands or tested.leaves_much:
        return tested
    nothing = _test_of(learned, (), seed, may_be_more=False)
    return replace(nothing, objections=tested.objections)


def _test_of(
    learned: Learned, model: Model, seed: np.random.SeedSequence, may_be_more: bool
) -> Tested:
    """Fit a model to all data but the held-out ones; test it on these.

    If there `may_be_more`, errors of the nominal model that are larger than usual are
    added. Where no model is exact nothing is uncertain within tolerances: they would
    explain what no model does.
    """
    data, least_gain = learned.data, learned.search.judge.least_gain
    if learned.inexact:  # what the search compared with was another noise
        least_gain = gain_of_noise(1)
    nominal = data.learned, data.test
    if learned.noise is None and not learned.inexact and may_be_more:
        model = with_shared_friction(data, model, least_gain)
        model, *sims = with_unusual_ones(data, model, least_gain)
        model, *sims = _settled(sims[0], sims[1], model)
    else:  # the healthy robot has it as well, or no model is exact
        sims = list(data.calibrated(model))
    if learned.inexact:
        nominal = data.learned.nominal(), data.test.nominal()
        sims = [one.nominal() for one in sims]
    own = sims[0].with_tolerances_beside(model)
    healthy = learned.search.judge.healthy if own.plant.base == "fixed" else ()
    refitted, said = established(own, model, healthy)
    known, model = bool(model), refitted.model if refitted else ()
    both = sims[0].moved_to(model)
    pair = both, sims[1].with_nuisance_of(both)
    usual = beside_control(nominal, model)
    fit, judged = held_out_errors(usual, pair, learned.result, model, least_gain, seed)
    fit = above_nominal(fit, data.test.nominal().evenly())
    if model:
        traces = [*data.learned.traces, *data.test.traces]
        timed = not any(lasts(placed, traces) for placed in model)
        left = nominal[1].residuals([()])[0], pair[1].residuals([model])[0]
        refuted = model_refuted(*left, least_gain)
        against = objections(judged, timed)
        if not (timed or against) and is_worse(fit, judged.hardly_more):
            against = (NO_BETTER,)
        said = (*refuted, *said, *against)
    elif known and not said:
        said = (NOTHING,)
    return Tested(refitted, nominal, pair, fit, said, judged.limits)


def _settled(
    learned: Predictor, test: Predictor, model: Model
) -> tuple[Model, Predictor, Predictor]:
    """The likeliest values of a model beside the likeliest small mismatch.

    Also returns predictors of learned and of held-out data that are calibrated there.
    They are given calibrated at the model.
    """
    if not (model and learned.fits_nuisance):
        return model, learned, test
    learned, test = copy(learned), copy(test)
    model = learned.settle(model)
    test.take_nuisance(learned.nuisance, model)
    test.correct(model)
    return model, learned, test

"""Fits models and judges them on data that they were not fitted to."""

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from diagnosis.effects.library import all_effects, effect
from diagnosis.residuals.predictor import Model, Predictor
from diagnosis.residuals.ties import groups_of, number_of_values
from diagnosis.search.fitting import MOST_STEPS, FittedModel, fit_all
from diagnosis.search.hooks import Hooks
from diagnosis.search.result import VALUE_NATS, Judged, pack, ranked, unpack
from diagnosis.search.rules import Rules
from groundwalk.arrays import FloatArray
from groundwalk.distributions import chi2_isf

CONTRADICTED = 3.0
"""Loss [nats] on the selection data from which on they contradict a model: odds of 20
to 1 (Kass and Raftery 1995, "Bayes factors": strong evidence)."""


def gain_of_noise(candidates: int, values: int = 1) -> float:
    """Gain [nats] of the best of independent candidates in 1 of 100 cases of noise.

    Each has as many `values` that are fitted.
    """
    return 0.5 * float(chi2_isf(0.01 / max(candidates, 1), values))


def places_of_effects(predictor: Predictor) -> int:
    """Number of effects at their places that are tried on the recordings.

    Those that only grow from others are tried where these help already.
    """
    kinds = [one for one in all_effects().values() if not one.only_grown]
    return sum(len(one.places(predictor.plant, predictor.traces)) for one in kinds)


def price(model: Model, rows: int) -> float:
    """Gain [nats] that a model needs beyond that of effects with one value each.

    More values, and start and end chosen freely among `rows` ones, fit more by chance.
    """
    timed = [one for one in model if effect(one.name).timed]
    rarity = sum(effect(one.name).rarity_nats for one in model)
    more = number_of_values(model) - len(groups_of(model))
    return float(len(timed) * np.log(rows)) + VALUE_NATS * more + rarity


class Judge:
    """Fits models on the fitting data and judges them on the selection data.

    An energy is half the sum of squared residuals in units of noise [nats].

    Attributes:
      residual: (N,) residual of the nominal sim on the fitting data [noise].
      nothing, nothing_fit: energy of the nominal sim on selection and fitting data.
      floor, floor_fit: energy that noise alone leaves on them.
      least_gain: gain [nats] that no effect reaches by chance, see `chance.py`; at
        first that of independent noise, later that of the residual of the best model.
    """

    def __init__(
        self,
        fit: Predictor,
        select: Predictor,
        rules: Rules | None = None,
        healthy: Sequence[Predictor] = (),
        hooks: Hooks | None = None,
    ) -> None:
        """Judge the nominal sim, with which all models are compared.

        Predictors are calibrated and have the same channels; `healthy` are those of
        recordings of the healthy robot: what gains there, too, is no evidence of a
        change (on a fixed base that is asked after a search, see
        `conclude/old_effects.py`).
        """
        self.fit, self.select, self.rules = fit, select, rules or Rules()
        self.healthy, self.hooks = healthy, hooks or Hooks()
        self.floor, self.floor_fit = select.noise_energy, fit.noise_energy
        # Models of one size hardly differ in what they fit by chance, so the fitting
        # data count in their comparison. They do not on a floating base, where two
        # recordings differ by chance.
        self._weight = float(fit.plant.base == "fixed")
        self._see_nominal()
        self.least_gain = gain_of_noise(places_of_effects(fit))

    def _see_nominal(self) -> None:
        self.residual = self.fit.residuals([()])[0]
        self.nothing_fit = 0.5 * float(self.residual @ self.residual)
        self.nothing = self.energies([()])[0]

    def calibrate(self, model: Model) -> None:
        """Calibrate the predictors at a model, and judge the nominal sim anew.

        Small mismatch is that of the fitting data. What was judged before is to be
        judged `again`.
        """
        self.fit.calibrate(model)
        self.select.doubt_beside(self.fit.nuisance, model)
        self.select.correct(model)
        self._see_nominal()

    def again(self, judged: Sequence[Judged]) -> list[Judged]:
        """Models that were judged before, with the same values, judged again."""
        if not judged:
            return []
        left = self.fit.residuals([one.model for one in judged])
        fits = [
            replace(one.fit, residual=own)
            for one, own in zip(judged, left, strict=True)
        ]
        return self.judge(fits)

    def ranked(self, judged: Sequence[Judged]) -> list[Judged]:
        """Models in the order of their plausibility, the most plausible first."""
        floor = self.floor + self._weight * self.floor_fit
        return ranked(judged, floor, self.correlated)

    @property
    def correlated(self) -> float:
        """What chance gains as a multiple of what it does in independent noise.

        Where what is left lasts from row to row, fewer rows are evidence: so many nats
        of energy count as one. At least 1. On a floating base recordings differ by
        chance, so that only gains in both sorts of data count, as they are.
        """
        if self.fit.plant.base == "floating":
            return 1.0
        independent = gain_of_noise(places_of_effects(self.fit))
        return max(self.least_gain / independent, 1.0)

    @property
    def least_fitted(self) -> float:
        """Gain [nats] that an effect must have on the fitting data to be reported.

        With a floating base it must gain as much on the selection data, in which the
        effect is taken to show as much.
        """
        if self.fit.plant.base == "fixed":
            return self.least_gain
        share = float(self.fit.scored.sum() / self.select.scored.sum())
        return max(1.0, share) * self.least_gain

    def worth(self, smaller: Judged, larger: Judged) -> bool:
        """Whether a larger model explains more than effects do by chance."""
        gain = smaller.evidence - larger.evidence
        least = self.least_gain + self._dearer(larger, smaller)
        matters = self._matters(smaller.selected - larger.selected)
        return gain > least and matters

    def believes(self, best: Judged, smaller: Judged | None = None) -> bool:
        """Whether the best model of a round of the search is believed.

        It is compared with the best smaller model, None for the nominal sim. The gain
        on the fitting data must not be by chance, and the selection data must not
        contradict it: an end stop or a push need not occur there. What gains less on
        the fitting data is believed if the selection data gain so much that both
        together are not by chance. With a floating base recordings differ by chance, so
        that the gain must show in both.
        """
        energy = smaller.selected if smaller else self.nothing
        fitted = smaller.fit.energy if smaller else self.nothing_fit
        least = self.least_gain + self._dearer(best, smaller)
        gained, selected = fitted - best.fit.energy, energy - best.selected
        is_free = self.fit.plant.base == "floating"
        here = selected > (least if is_free else -CONTRADICTED)
        sure = gained > least or (
            not is_free and gained + selected > least + self._selected_by_chance
        )
        return sure and here and self._matters(gained)

    @property
    def _selected_by_chance(self) -> float:
        """Gain [nats] that models do not reach by chance on data they do not know.

        That of the best of those compared if noise were independent, times how much
        more correlated noise lets candidates gain on the fitting data.
        """
        return self.correlated * gain_of_noise(self.rules.finished)

    def _dearer(self, larger: Judged, smaller: Judged | None) -> float:
        """Gain [nats] that a model needs for its values beyond what a smaller one does.

        A nat of a price is a nat of evidence.
        """
        dearer = self.price(larger.model)
        dearer -= self.price(smaller.model if smaller else ())
        return self.correlated * dearer

    def price(self, model: Model) -> float:
        """Gain [nats] that a model needs beyond that of effects with one value each."""
        return price(model, sum(trace.ticks for trace in self.fit.traces))

    def _matters(self, gain: float) -> bool:
        """Whether a gain [nats] is the share of the error that the user asks for."""
        share = self.rules.least_share
        return share == 0 or gain > share * (self.nothing - self.floor)

    def judged(
        self,
        starts: Sequence[Model],
        jacobians: Sequence[FloatArray | None] | None = None,
    ) -> list[Judged]:
        """Fit models and judge them, the most plausible first.

        Only those that are among the best after a few steps are fitted to the end. Of
        several fits of the same effects at the same places the best is kept.
        `jacobians` (N, p) are those at the start values, None if unknown.
        """

        def work() -> list[Judged]:
            steps = self.rules.first_steps
            rough = fit_all(self.fit, starts, steps, followed=True, jacobians=jacobians)
            rough.sort(key=lambda fit: fit.energy)
            count = self._worthy([fit.energy for fit in rough])
            models = [fit.model for fit in rough[:count]]
            known = [fit.jacobian for fit in rough[:count]]
            fits = fit_all(self.fit, models, followed=True, jacobians=known)
            fits = self._settled(fits)
            return distinct(self.ranked(self.judge([*fits, *rough[count:]])))

        return self.saved(work)

    def _settled(self, fits: Sequence[FittedModel]) -> list[FittedModel]:
        """Fits, single effects and the best one also with differences at each step.

        A Jacobian that is only followed may lead nowhere: that of a spring with a wrong
        rest angle does not lead to the right one.
        """
        best = min(fits, key=lambda fit: fit.energy, default=None)
        some = [fit for fit in fits if len(fit.model) == 1 or fit is best]
        again = fit_all(self.fit, [fit.model for fit in some])
        settled = {
            id(a): min(a, b, key=lambda fit: fit.energy)
            for a, b in zip(some, again, strict=True)
        }
        return [settled.get(id(fit), fit) for fit in fits]

    def saved(self, work: Callable[[], list[Judged]]) -> list[Judged]:
        """Judged models from the checkpoint, or computed by `work` and stored there."""
        plant = self.fit.plant
        return self.hooks.saved(work, pack, lambda stored: unpack(stored, plant))

    def replays_of(self, starts: Sequence[Model]) -> int:
        """Rough number of simulations needed to fit and judge models from starts."""
        values = sum(len(placed.values) for start in starts for placed in start)
        first = values + self.rules.first_steps * len(starts)
        return first + MOST_STEPS * min(len(starts), self.rules.finished)

    def judge(self, fits: Sequence[FittedModel], exactly: bool = False) -> list[Judged]:
        """Evaluate fitted models on the selection data, in the order given.

        `exactly` removes each model's own integration error, not one common to all.
        """
        energies = self.energies([fit.model for fit in fits], exactly)
        return [
            Judged(fit, energy, self._weight)
            for fit, energy in zip(fits, energies, strict=True)
        ]

    def _worthy(self, energies: Sequence[float]) -> int:
        """Number of models, best first, whose energies [nats] are not far behind."""
        if not energies:
            return 0
        explained = self.nothing_fit - energies[0]
        most = energies[0] + max(self.least_gain, self.rules.drop_behind * explained)
        near = sum(energy <= most for energy in energies)
        return min(near, self.rules.finished)

    def energies(self, models: Sequence[Model], exactly: bool = False) -> list[float]:
        """Energies [nats] of models on the selection data, with a penalty.

        The penalty is the model's gain on recordings of the healthy robot, if there are
        any and the base floats: what was there before is no change. `exactly` removes
        each model's own integration error, not one common to all.
        """
        if not models:
            return []
        residuals = self.select.residuals(models, exactly)
        energies = [0.5 * float(row @ row) for row in residuals]
        before = self._gains_before(models)
        return [e + gain for e, gain in zip(energies, before, strict=True)]

    def _gains_before(self, models: Sequence[Model]) -> list[float]:
        """Gain of each model [nats, at least 0] on recordings of the healthy robot.

        Gains are scaled to the length of the selection data. On a fixed base effects
        of the healthy robot are part of the nominal model, so that nothing is gained.
        """
        if not self.healthy or self.fit.plant.base == "fixed":
            return [0.0] * len(models)
        energies = sum(
            0.5 * np.sum(one.residuals([(), *models]) ** 2, axis=1)
            for one in self.healthy
        )
        floor = 0.5 * sum(float(one.scored.sum()) for one in self.healthy)
        gains = (energies[0] - energies[1:]) * self.floor / floor
        return [max(float(gain), 0.0) for gain in gains]


def distinct(judged: Sequence[Judged]) -> list[Judged]:
    """The first of all models that have the same effects at the same places."""
    first = {one.keys: one for one in reversed(judged)}
    return [one for one in judged if first[one.keys] is one]

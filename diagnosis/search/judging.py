"""Fits models and judges them on data that they were not fitted to."""

from collections.abc import Callable, Sequence

import numpy as np

from diagnosis.residuals.predictor import Model, Predictor
from diagnosis.search.fitting import MOST_STEPS, FittedModel, fit_all
from diagnosis.search.hooks import Hooks
from diagnosis.search.result import Judged, ranked
from diagnosis.search.rules import Rules
from diagnosis.search.stored_models import pack, unpack
from groundwalk.arrays import FloatArray


class Judge:
    """Fits models on the fitting data and judges them on the selection data.

    Attributes:
      fit: predictor of the fitting data.
      select: predictor of the selection data.
      rules: settings of the search.
      healthy: predictors of reference recordings; empty if there are none.
      hooks: progress display and checkpoint.
      residual: (N,) residual of the nominal sim on the fitting data [noise].
      nothing: energy of the nominal sim on the selection data [nats].
      nothing_fit: energy of the nominal sim on the fitting data [nats].
      floor: energy that noise alone leaves on the selection data [nats].
      floor_fit: energy that noise alone leaves on the fitting data [nats].
    """

    def __init__(
        self,
        fit: Predictor,
        select: Predictor,
        rules: Rules | None = None,
        healthy: Sequence[Predictor] = (),
        hooks: Hooks | None = None,
    ) -> None:
        """Judge the nominal sim first, which all models are compared with.

        Args:
          fit: predictor of the fitting data, calibrated.
          select: predictor of the selection data, calibrated, with the same channels.
          rules: settings of the search; the default ones where None.
          healthy: calibrated predictors of reference recordings. A gain that a model
            would have there, too, is no evidence of a change.
          hooks: progress display and checkpoint; none where None.
        """
        self.fit, self.select, self.rules = fit, select, rules or Rules()
        self.healthy, self.hooks = healthy, hooks or Hooks()
        self.floor = 0.5 * float(select.scored.sum())
        self.floor_fit = 0.5 * float(fit.scored.sum())
        # Models of one size hardly differ in what they fit by chance, so the fitting
        # data count in their comparison. They do not on a floating base, where two
        # recordings differ by chance, and not with a reference, which is compared with
        # both kinds of data.
        self._weight = float(fit.plant.base == "fixed" and not healthy)
        self.residual = fit.residuals([()])[0]
        self.nothing_fit = 0.5 * float(self.residual @ self.residual)
        self.nothing = self.energies([()])[0]

    def ranked(self, judged: Sequence[Judged]) -> list[Judged]:
        """Models in the order of their plausibility, the most plausible first."""
        return ranked(judged, self.floor + self._weight * self.floor_fit)

    @property
    def least_gain(self) -> float:
        """Log-likelihood [nats] that an effect must gain on the selection data."""
        pattern = self.rules.least_pattern**2 * self.floor
        return max(self.rules.least_gain, pattern / len(self.fit.channels.names))

    @property
    def least_fitted(self) -> float:
        """Log-likelihood [nats] that an effect must gain on the fitting data.

        It applies to effects that show evenly in the fitting and the selection data. On
        a fixed base both together must show enough, on a floating base each of them.
        """
        share = float(self.fit.scored.sum() / self.select.scored.sum())
        if self.fit.plant.base == "fixed":
            return max(self.least_gain, 2 * self.least_gain * share / (1 + share))
        return max(1.0, share) * self.least_gain

    def worth(self, before: float, after: float, nothing: float) -> bool:
        """Whether a step to a larger model improves the fit enough to be believed.

        Args:
          before: energy of the smaller model on the selection data [nats].
          after: energy of the larger model there.
          nothing: energy of the nominal sim there.
        """
        return before - after > self.least_gain and self.matters(before, after, nothing)

    def matters(self, before: float, after: float, nothing: float) -> bool:
        """Whether a step removes enough of the energy that is left to explain.

        The noise level itself is uncertain, so close to the noise floor no minimum
        share is required.

        Args:
          before: energy of the smaller model on the selection data [nats].
          after: energy of the larger model there.
          nothing: energy of the nominal sim there.
        """
        rules = self.rules
        left = before - (1 + rules.unsure_floor) * self.floor
        return before - after > max(
            rules.least_share_of_rest * left,
            rules.least_share * (nothing - self.floor),
            0.0,
        )

    def believes(self, best: Judged, energy: float, fitted: float) -> bool:
        """Whether the best model of a round of the search is believed.

        Args:
          best: the model.
          energy: energy of the best smaller model on the selection data [nats].
          fitted: its energy on the fitting data [nats].
        """
        gains = fitted - best.fit.energy, energy - best.selected
        if self.shows(*gains) and self.matters(energy, best.selected, self.nothing):
            return True
        return len(best.model) == 1 and self.hints(*gains)

    def shows(self, fitted: float, selected: float) -> bool:
        """Whether the gains on both kinds of data are large enough, each by itself.

        A model that gains on the selection data by chance gains little on the fitting
        data.

        Args:
          fitted: gain on the fitting data [nats].
          selected: gain on the selection data [nats].
        """
        return min(fitted, selected) > self.least_gain

    def hints(self, fitted: float, selected: float) -> bool:
        """Whether the gains are large enough together, for one effect on a fixed base.

        A joint may move less in the selection data than in the fitting data, and a stop
        or a push may not occur there at all. On a floating base two recordings differ
        by chance, so that a gain in one and a loss in the other mean nothing.

        Args:
          fitted: gain on the fitting data [nats].
          selected: gain on the selection data [nats].
        """
        rules, gain = self.rules, fitted + selected
        left = self.nothing_fit - (1 + rules.unsure_floor) * self.floor_fit
        if self.fit.plant.base != "fixed" or gain < rules.least_share_of_rest * left:
            return False
        both = fitted > self.least_gain and selected > rules.least_hint
        one = (
            fitted > rules.fitted_only * self.least_gain
            and selected > -rules.least_hint
        )
        return bool((both and gain > 2 * self.least_gain) or one)

    def judged(
        self,
        starts: Sequence[Model],
        jacobians: Sequence[FloatArray | None] | None = None,
    ) -> list[Judged]:
        """Fit models and judge them, the most plausible first.

        Most starts lead nowhere: only those that are among the best after a few steps
        are fitted to the end. Of several fits of one structure the best is kept.

        Args:
          starts: models with values to begin with.
          jacobians: (N, p) of each model at these values; None where it is not known.
        """
        return self.saved(lambda: self._judged(starts, jacobians))

    def saved(self, work: Callable[[], list[Judged]]) -> list[Judged]:
        """Judged models from the checkpoint, or computed and stored there."""
        plant = self.fit.plant
        return self.hooks.saved(work, pack, lambda stored: unpack(stored, plant))

    def _judged(
        self, starts: Sequence[Model], jacobians: Sequence[FloatArray | None] | None
    ) -> list[Judged]:
        """Compute what `judged` returns, without the checkpoint."""
        rough = fit_all(
            self.fit, starts, self.rules.first_steps, followed=True, jacobians=jacobians
        )
        rough.sort(key=lambda fit: fit.energy)
        count = self._worthy([fit.energy for fit in rough])
        fits = fit_all(
            self.fit,
            [fit.model for fit in rough[:count]],
            followed=True,
            jacobians=[fit.jacobian for fit in rough[:count]],
        )
        return distinct(self.ranked(self.judge([*fits, *rough[count:]])))

    def replays_of(self, starts: Sequence[Model]) -> int:
        """Rough number of replays that `judged` needs for some starts."""
        values = sum(len(placed.values) for start in starts for placed in start)
        first = values + self.rules.first_steps * len(starts)
        return first + MOST_STEPS * min(len(starts), self.rules.finished)

    def judge(self, fits: Sequence[FittedModel], exactly: bool = False) -> list[Judged]:
        """Evaluate fitted models on the selection data, in the order given.

        Args:
          fits: models fitted to the fitting data.
          exactly: take out the integration error of each model instead of a common one.
        """
        energies = self.energies([fit.model for fit in fits], exactly)
        return [
            Judged(fit, energy, self._weight)
            for fit, energy in zip(fits, energies, strict=True)
        ]

    def _worthy(self, energies: Sequence[float]) -> int:
        """How many of the best models deserve more steps: those not far behind.

        Args:
          energies: of the models on the fitting data [nats], rising.
        """
        if not energies:
            return 0
        explained = self.nothing_fit - energies[0]
        most = energies[0] + max(self.least_gain, self.rules.drop_behind * explained)
        near = sum(energy <= most for energy in energies)
        return min(near, self.rules.finished)

    def energies(self, models: Sequence[Model], exactly: bool = False) -> list[float]:
        """Energies of models on the selection data plus their gains on the reference.

        Args:
          models: the effects with values.
          exactly: take out the integration error of each model instead of a common one.
        """
        if not models:
            return []
        residuals = self.select.residuals(models, exactly)
        energies = [0.5 * float(row @ row) for row in residuals]
        before = self._gains_before(models)
        return [e + gain for e, gain in zip(energies, before, strict=True)]

    def _gains_before(self, models: Sequence[Model]) -> list[float]:
        """Gain of each model on the reference, scaled to the length of selection data.

        Returns:
          Gains [nats], at least 0; all 0 without a reference.
        """
        if not self.healthy:
            return [0.0] * len(models)
        energies = sum(
            0.5 * np.sum(one.residuals([(), *models]) ** 2, axis=1)
            for one in self.healthy
        )
        floor = 0.5 * sum(float(one.scored.sum()) for one in self.healthy)
        gains = (energies[0] - energies[1:]) * self.floor / floor
        return [max(float(gain), 0.0) for gain in gains]


def distinct(judged: Sequence[Judged]) -> list[Judged]:
    """The first model of each structure: several starts may lead to the same one."""
    first = {one.keys: one for one in reversed(judged)}
    return [one for one in judged if first[one.keys] is one]

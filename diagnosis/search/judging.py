"""Fits models and judges them on data that they were not fitted to."""

from collections.abc import Callable, Sequence

import numpy as np

from diagnosis.residuals.predictor import Model, Predictor
from diagnosis.search.fitting import MOST_STEPS, FittedModel, fit_all
from diagnosis.search.hooks import Hooks
from diagnosis.search.result import Judged, pack, ranked, unpack
from diagnosis.search.rules import Rules
from groundwalk.arrays import FloatArray


class Judge:
    """Fits models on the fitting data and judges them on the selection data.

    An energy is half the sum of squared residuals in units of noise [nats].

    Attributes:
      residual: (N,) residual of the nominal sim on the fitting data [noise].
      nothing, nothing_fit: energy of the nominal sim on selection and fitting data.
      floor, floor_fit: energy that noise alone leaves on them.
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
        recordings of the healthy robot: a gain there, too, is no evidence of a change.
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
        """Log-likelihood [nats] an effect must gain on the fitting data to be reported.

        The effect is taken to show in the fitting data as much as in the selection
        data. With a fixed base the sum of both gains must be large enough, with a
        floating base each of them.
        """
        share = float(self.fit.scored.sum() / self.select.scored.sum())
        if self.fit.plant.base == "fixed":
            return max(self.least_gain, 2 * self.least_gain * share / (1 + share))
        return max(1.0, share) * self.least_gain

    def worth(self, before: float, after: float, nothing: float) -> bool:
        """Whether adding an effect to a model improves the fit enough to be believed.

        Energies [nats] of the smaller model, the larger one and the nominal sim are
        those on the selection data.
        """
        return before - after > self.least_gain and self.matters(before, after, nothing)

    def matters(self, before: float, after: float, nothing: float) -> bool:
        """Whether a larger model removes enough of the energy that is left to explain.

        Arguments are those of `worth`. The noise level itself is uncertain; close to it
        no minimum share is required.
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

        `energy` and `fitted` [nats] are those of the best smaller model on the
        selection and on the fitting data.
        """
        gains = fitted - best.fit.energy, energy - best.selected
        if self.shows(*gains) and self.matters(energy, best.selected, self.nothing):
            return True
        return len(best.model) == 1 and self.hints(*gains)

    def shows(self, fitted: float, selected: float) -> bool:
        """Whether an effect gains enough [nats] on fitting and on selection data each.

        A model that gains on the selection data by chance gains little on the fitting
        data.
        """
        return min(fitted, selected) > self.least_gain

    def hints(self, fitted: float, selected: float) -> bool:
        """Whether a single effect gains enough [nats] on both kinds of data together.

        A joint may move less in the selection data than in the fitting data, and an end
        stop or a push may not occur there at all. With a floating base the answer is
        no: recordings differ by chance, so that gains in only one of them mean nothing.
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
            return distinct(self.ranked(self.judge([*fits, *rough[count:]])))

        return self.saved(work)

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
        any: what was there before is no change. `exactly` removes each model's own
        integration error, not one common to all.
        """
        if not models:
            return []
        residuals = self.select.residuals(models, exactly)
        energies = [0.5 * float(row @ row) for row in residuals]
        before = self._gains_before(models)
        return [e + gain for e, gain in zip(energies, before, strict=True)]

    def _gains_before(self, models: Sequence[Model]) -> list[float]:
        """Gain of each model [nats, at least 0] on recordings of the healthy robot.

        Gains are scaled to the length of the selection data.
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
    """The first of all models that have the same effects at the same places."""
    first = {one.keys: one for one in reversed(judged)}
    return [one for one in judged if first[one.keys] is one]

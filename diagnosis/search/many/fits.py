"""Fits models with effects at many joints and compares them by the extended BIC."""

from collections.abc import Callable, Collection, Iterable, Sequence

import numpy as np

from diagnosis.residuals.coordinates import Coordinates
from diagnosis.residuals.predictor import Model
from diagnosis.residuals.torques.ripples import usage_of
from diagnosis.residuals.trust import trust_of
from diagnosis.search.fitting import FittedModel, fit_all
from diagnosis.search.judging import Judge
from diagnosis.search.many.ebic import Ebic
from diagnosis.search.result import Judged
from groundwalk.arrays import FloatArray

MOST_ROUNDS = 12
"""Most rounds in which a model is made better."""

REPLAYS = 200
"""Rough number of simulations of the recordings in a round; only for the progress
display."""


class Fits:
    """Fits, and their comparison, in a search for effects at many joints.

    Residuals are not whitened with the model's tolerances: what lies within these at
    single joints may be much at all of them.

    Attributes:
      judge: fits and judges the models.
      fit: predictor of the fitting data.
      usage: what the joints did in them.
      without: names of effects that are not tried.
      weighs: whether recordings in which models leave more than in most weigh less.
    """

    def __init__(
        self, judge: Judge, without: Collection[str] = (), weighs: bool = False
    ) -> None:
        """Prepare the fits; the predictors of `judge` must be calibrated already."""
        self.without, self.weighs = frozenset(without), weighs
        parts = judge.fit.nominal(), judge.select.nominal()
        for part in parts:  # at the nominal model, whatever was found before
            part.calibrate(tolerances=False)
        self.fit, self._select = parts
        if weighs:
            self._weigh(())
        self.judge = Judge(*parts, judge.rules, judge.healthy, judge.hooks)
        self.usage = usage_of(self.fit)

    def allowed(self, names: Iterable[str]) -> tuple[str, ...]:
        """Those of some names of effects that are tried."""
        return tuple(name for name in names if name not in self.without)

    def nominal(self) -> Judged:
        """The nominal model, as if it had been fitted."""
        (residual,) = self.fit.residuals([()])
        none = np.zeros((len(residual), 0)), Coordinates(self.fit.plant, ())
        return self.judge.judge([FittedModel((), residual, *none)])[0]

    def improved(
        self,
        name: str,
        better: Callable[["Fits", Judged], Judged | None],
        first: Model = (),
    ) -> Judged:
        """The `first` model, made better round by round until `better` returns None.

        `name` is that of the rounds in the progress display.
        """
        best = self.exact(self.fitted(first)) if first else self.nominal()
        for number in range(MOST_ROUNDS):
            self.judge.hooks.stage(f"{name}, round {number + 1}", REPLAYS)
            other = better(self, best)
            if other is None:
                break
            best = self.exact(other)
        return best

    def fitted(self, model: Model) -> Judged:
        """A model fitted to the end and judged."""

        def work() -> list[Judged]:
            return self.judge.judge(fit_all(self.fit, [model]))

        return self.judge.saved(work)[0]

    def tried(
        self, starts: Sequence[Model], jacobians: Sequence[FloatArray | None]
    ) -> list[Judged]:
        """Models fitted in a few steps and judged, the most plausible first.

        `jacobians` (N, p) are those at the start values, None if unknown.
        """

        def work() -> list[Judged]:
            steps = self.judge.rules.first_steps
            fits = fit_all(self.fit, starts, steps, followed=True, jacobians=jacobians)
            judged = self.judge.judge(fits)
            best = min(judged, key=lambda one: one.energy)
            return sorted(judged, key=self.ebic(best).score)

        return self.judge.saved(work) if starts else []

    def exact(self, best: Judged) -> Judged:
        """The model fitted again, with its own integration error taken out.

        That of the nominal model would be explained by further effects. Recordings
        weigh as suits what the model leaves in them.
        """
        if self.weighs:
            self._weigh(best.model)
        for part in (self.fit, self._select):
            part.correct(best.model)
        return self.fitted(best.model)

    def _weigh(self, model: Model) -> None:
        """Weigh recordings by what a model leaves in them."""
        parts = self.fit, self._select
        trust = trust_of([part.squares_in(model) for part in parts])
        for part in parts:
            part.trusting(trust)
            part.doubt(tolerances=False)

    def ebic(self, judged: Judged, repeats: bool = True) -> Ebic:
        """The criterion where a model leaves what this one leaves.

        Errors that come again count each time if they may be `repeats`. So they do as
        long as a model grows: what is missing is much, and comes again as well.
        """
        return Ebic.of(self.fit, self.judge.select, judged.fit.residual, repeats)

    def is_better(self, larger: Judged, best: Judged) -> bool:
        """Whether all data speak for the larger model, and the selection data do."""
        prefers = self.ebic(larger).prefers(larger, best)
        return prefers and larger.selected < best.selected

"""Searches for physics that many joints lack, and for what is missing beside it.

The search for one, two or three effects suits a robot whose model was right once. The
first model of a real robot lacks the same physics at every joint. Here kinds of effects
are added one by one, each at all joints where it may be: with values that all joints
share, with one for each kind of motor, or with one for each joint. Single effects are
tried beside them, and what chance may explain is taken out again. The extended Bayesian
information criterion decides (`ebic.py`).
"""

from collections.abc import Sequence

import numpy as np

from diagnosis.effects.library import all_effects, effect
from diagnosis.residuals.predictor import Model, Predictor
from diagnosis.residuals.signatures import Signature, signatures
from diagnosis.search.candidates import Candidates
from diagnosis.search.coordinates import Coordinates
from diagnosis.search.ebic import Ebic
from diagnosis.search.fitting import FittedModel, fit_all, ran_into_bound
from diagnosis.search.judging import Judge
from diagnosis.search.kinds import kinds_to_add
from diagnosis.search.result import Judged, SearchResult
from diagnosis.search.screening import Screen
from diagnosis.search.ties import groups_of, without_each
from diagnosis.traces.usage import Usage

MOST_ROUNDS = 12
"""Most rounds in which a model grows."""

FINISHED = 3
"""Number of models in a round that are fitted to the end, until one is not worse and
has no new effect on a bound."""

REPLAYS = 200
"""Rough number of simulations of the recordings in a round; only for the progress
display."""

MUCH_BETTER = 0.25
"""A model with effects at all joints is preferred to one of up to three effects if it
removes this share of the energy above the noise that the latter leaves."""

CLEARLY = 20.0
"""Effects whose linear estimates exceed their price by more nats than this are not
tried without: odds of more than a million to one, which no nonlinearity undoes."""

ALL_CLOSED = 0.95
"""Share of the energy above the noise that few effects must remove; otherwise effects
at all joints are tried."""

TORQUES_LEFT = 1.5
"""Multiple of the sensors' squared noise from which on so much is left of torques that
effects at all joints are tried."""


def more_is_missing(fit: Predictor, result: SearchResult) -> bool:
    """Whether few effects leave so much that effects at all joints are tried.

    Never on a floating base, where that would take an hour.
    """
    if fit.plant.base == "floating":
        return False
    if not fit.by_torque:
        return result.leaves_much(ALL_CLOSED)
    model = result.winner.model if result.winner else ()
    (left,) = fit.without_tolerances().residuals([model])
    wide = (fit.channels.noise / fit.channels.floor)[fit.channel]
    return bool(np.sum((wide * left) ** 2) > TORQUES_LEFT * fit.scored.sum())


def everywhere(judge: Judge, result: SearchResult) -> SearchResult:
    """The model with effects at all joints and others if it fits much better.

    `result` is that of the search for few effects, which is returned otherwise.
    """
    search = Everywhere(judge)
    best = search.run()
    nothing = search.nominal()
    winner = search.fitted(result.winner.model) if result.winner else nothing
    left = winner.energy - best.energy
    floor = search.judge.floor + search.judge.floor_fit
    much = max(MUCH_BETTER * (winner.energy - floor), search.judge.least_gain)
    if not best.model or left < much:
        return result
    judge.least_gain = search.judge.least_gain
    size = len(best.model)
    smaller = without_each(best.model)
    known = [best.fit.jacobian_of(model) for model in smaller]
    steps = judge.rules.first_steps
    fits = fit_all(search.judge.fit, smaller, steps, followed=True, jacobians=known)
    sizes = {
        size - 1: search.judge.ranked(search.judge.judge(fits)),
        size: [best],
    }
    return SearchResult(
        nothing.selected,
        search.judge.floor,
        sizes,
        size,
        nothing.fit.energy,
        search.judge.floor_fit,
    )


class Everywhere:
    """One search for effects at all joints and for others beside them.

    Residuals are not whitened with the model's tolerances: what lies within these at
    single joints may be much at all of them.

    Attributes:
      judge: fits and judges the models.
    """

    def __init__(self, judge: Judge) -> None:
        """Prepare a search; the predictors of `judge` must be calibrated already."""
        parts = judge.fit.without_tolerances(), judge.select.without_tolerances()
        for part in parts:  # at the nominal model, whatever was found before
            part.calibrate(tolerances=False)
        self.judge = Judge(*parts, judge.rules, judge.healthy, judge.hooks)
        self._fit = parts[0]
        self._usage = Usage.of(self._fit.plant, self._fit.traces)

    def run(self) -> Judged:
        """The best model; without effects if none explains much at all joints."""
        best = self.nominal()
        for number in range(MOST_ROUNDS):
            self.judge.hooks.stage(f"all joints, round {number + 1}", REPLAYS)
            larger = self._larger(best)
            if larger is None:
                break
            best = self._exact(larger)
        return self._without_idle(self._simplified(best))

    def _exact(self, best: Judged) -> Judged:
        """The model fitted again, with its own integration error taken out.

        That of the nominal model would be explained by further effects.
        """
        for part in (self._fit, self.judge.select):
            part.correct(best.model)
        return self.fitted(best.model)

    def nominal(self) -> Judged:
        """The nominal model, as if it had been fitted."""
        (residual,) = self._fit.residuals([()])
        none = np.zeros((len(residual), 0)), Coordinates(self._fit.plant, ())
        return self.judge.judge([FittedModel((), residual, *none)])[0]

    def _ebic(self, judged: Judged) -> Ebic:
        return Ebic.of(self._fit, self.judge.select, judged.fit.residual)

    def _tried(self, starts: Sequence[Model]) -> list[Judged]:
        """Models fitted in a few steps and judged, the most plausible first."""

        def work() -> list[Judged]:
            steps = self.judge.rules.first_steps
            fits = fit_all(self._fit, starts, steps, followed=True)
            judged = self.judge.judge(fits)
            best = min(judged, key=lambda one: one.energy)
            return sorted(judged, key=self._ebic(best).score)

        return self.judge.saved(work) if starts else []

    def fitted(self, model: Model) -> Judged:
        """A model fitted to the end and judged."""

        def work() -> list[Judged]:
            return self.judge.judge(fit_all(self._fit, [model]))

        return self.judge.saved(work)[0]

    def _larger(self, best: Judged) -> Judged | None:
        """A better model with more effects or values; None if there is none.

        Joints with the same motor are alike until the recordings show that they are
        not: other effects and further values are tried where no value that they share
        helps any more.
        """
        found = signatures(self._fit, best.model, self._usage, (), servo_effects())
        screen = Screen(self._fit, found)
        shared, apart = kinds_to_add(self._fit, screen, best)
        larger = self._best_of(shared, best)
        return larger or self._best_of([*apart, *self._singles(best, found)], best)

    def _best_of(self, models: Sequence[Model], best: Judged) -> Judged | None:
        """The most plausible of some models; None if all are worse than the best one.

        A model with a further value on a bound is none: something else is behind it.
        """
        known = {placed.key for placed in best.model}
        for each in self._tried(models)[:FINISHED]:
            larger = self.fitted(each.model)
            if not self._is_better(larger, best):
                return None
            new = [placed for placed in larger.model if placed.key not in known]
            if len(new) != 1 or not ran_into_bound(larger.fit, new[0]):
                return larger
        return None

    def _is_better(self, larger: Judged, best: Judged) -> bool:
        """Whether all data speak for the larger model, and the selection data do."""
        prefers = self._ebic(larger).prefers(larger, best)
        return prefers and larger.selected < best.selected

    def _singles(self, best: Judged, found: Sequence[Signature]) -> list[Model]:
        """Models with one more single effect; none where no kind explains anything.

        Signatures of effects that any servo may have are known (`found`).
        """
        if not best.model:
            return []
        known = servo_effects()
        others = [
            name
            for name, kind in all_effects().items()
            if not (kind.timed or name in known)
        ]
        more = signatures(self._fit, best.model, self._usage, (), others)
        candidates = Candidates(self._fit, [*found, *more], self.judge.rules)
        self.judge.least_gain = candidates.gain_by_chance(best.fit.residual)
        return candidates.larger([best], near=False, residual=None)

    def _simplified(self, best: Judged) -> Judged:
        """The model with simpler forms of its effects where these explain as much."""
        for group in groups_of(best.model):
            simpler = {one.key: effect(one.name).simpler(one) for one in group}
            keys = {one.key for one in simpler.values()}
            known = {one.key for one in best.model} - set(simpler)
            if all(simpler[one.key] == one for one in group) or keys & known:
                continue
            other = tuple(simpler.get(one.key, one) for one in best.model)
            tried = self.fitted(other)
            if self._ebic(best).prefers(tried, best):
                best = tried
        return best

    def _without_idle(self, best: Judged) -> Judged:
        """The model without effects that explain too little.

        Linear estimates say what to try without, the likeliest first; a fit decides.
        """
        needed = set[str]()
        while True:
            ebic = self._ebic(best)
            worth = {
                group: ebic.nats(gain, best) - ebic.price_within(best.model, group)
                for group, gain in gains_of_each(best.fit)
                if group[0].key not in needed
            }
            if not worth:
                return best
            group = min(worth, key=lambda one: worth[one])
            if worth[group] > CLEARLY:
                return best
            kept = tuple(one for one in best.model if one not in group)
            tried = self.fitted(kept) if kept else self.nominal()
            if ebic.prefers(tried, best):
                best = tried
            else:
                needed.add(group[0].key)


def servo_effects() -> tuple[str, ...]:
    """Names of the effects that an incomplete robot model may lack at every servo."""
    return tuple(
        name
        for name, kind in all_effects().items()
        if kind.on_every_servo and kind.place_kind in ("joint", "commands", "encoders")
    )


def gains_of_each(fit: FittedModel) -> list[tuple[Model, float]]:
    """Energies [nats] by which a fit gets worse without each effect, or tied effects.

    To first order, the other values being fitted again (Wald 1943). Infinite where no
    finite value stands for no effect.
    """
    coordinates, gains = fit.coordinates, list[tuple[Model, float]]()
    jacobian = fit.jacobian
    spread = np.linalg.pinv(jacobian.T @ jacobian, hermitian=True)
    x = coordinates.of(fit.model)
    for group in groups_of(fit.model):
        own = coordinates.columns_of(group)
        own = own[: max(effect(group[0].name).components, 1)]
        neutral = [coordinates.parameters[i].neutral for i in own]
        if not np.isfinite(neutral).all():
            gains.append((group, np.inf))
            continue
        away = [
            x[i] - coordinates.scaled(i, value)
            for i, value in zip(own, neutral, strict=True)
        ]
        part = np.linalg.pinv(spread[np.ix_(own, own)], hermitian=True)
        gains.append((group, 0.5 * float(np.array(away) @ part @ np.array(away))))
    return gains

"""Searches for physics that many joints lack, and for what is missing beside it.

The search for one, two or three effects suits a robot whose model was right once. The
first model of a real robot lacks the same physics at every joint. Here kinds of effects
are added one by one, each at all joints where it may be: with values that all joints
share, with one for each kind of motor, or with one for each joint. Single effects are
tried beside them, and what chance may explain is taken out again. The extended Bayesian
information criterion decides (`ebic.py`).
"""

import itertools
from collections.abc import Sequence

import numpy as np

from diagnosis.effects.library import all_effects, effect
from diagnosis.residuals.bursts import push_intervals
from diagnosis.residuals.predictor import Model
from diagnosis.residuals.signatures import Signature, signatures
from diagnosis.search.candidates import Candidates
from diagnosis.search.coordinates import Coordinates
from diagnosis.search.ebic import Ebic
from diagnosis.search.fitting import FittedModel, fit_all, ran_into_bound
from diagnosis.search.judging import Judge
from diagnosis.search.kinds import kinds_to_add
from diagnosis.search.known_changes import KnownChanges
from diagnosis.search.result import MORE_THAN_NOISE, Judged, SearchResult
from diagnosis.search.screening import Screen
from diagnosis.search.spread import FEWEST
from diagnosis.search.stepwise import Stepwise
from diagnosis.search.ties import Level, groups_of, number_of_values, tied, without_each
from diagnosis.traces.usage import Usage
from groundwalk.arrays import FloatArray

MOST_ROUNDS = 12
"""Most rounds in which a model grows."""

EXCHANGED = 8
"""Number of models with other effects in place of some that are fitted in a round."""

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
        detailed = self._in_detail()
        if self._explains_all(detailed):
            return self._without_idle(self._simplified(self._tied(detailed)))
        best = self.nominal()
        for number in range(MOST_ROUNDS):
            self.judge.hooks.stage(f"all joints, round {number + 1}", REPLAYS)
            larger = self._larger(best)
            if larger is None:
                break
            best = self._exact(larger)
        return self._without_idle(self._simplified(self._replaced(best)))

    def _in_detail(self) -> Judged:
        """The model with effects at each joint by itself, as far as it gets better."""
        best = self.nominal()
        for number in range(MOST_ROUNDS):
            self.judge.hooks.stage(f"each joint, round {number + 1}", REPLAYS)
            other = self._more_detailed(best)
            if other is None:
                break
            best = self._exact(other)
        return best

    def _more_detailed(self, best: Judged) -> Judged | None:
        """A better model with more or other effects; None if there is none.

        What does not last is tried where nothing else helps any more.
        """
        found = signatures(self._fit, best.model, self._usage, (), lasting_effects())
        step = self._step(best, found)
        known = KnownChanges(self._fit, best.fit, found)
        other = self._with_more(best, step, known)
        other = other or self._with_others(best, step, known)
        short = push_intervals(self._fit, best.fit.residual)[1:]
        if other or not short:
            return other
        timed = [name for name, kind in all_effects().items() if kind.timed]
        found = signatures(self._fit, best.model, self._usage, short, timed)
        known = KnownChanges(self._fit, best.fit, found)
        return self._with_more(best, self._step(best, found), known) if found else None

    def _step(self, best: Judged, found: Sequence[Signature]) -> Stepwise:
        screen, floor = Screen(self._fit, found), self._fit.noise_energy
        return Stepwise(screen, self._ebic(best), best, floor)

    def _with_more(
        self, best: Judged, step: Stepwise, known: KnownChanges
    ) -> Judged | None:
        """The model with effects beside its own; None if none makes it better."""
        added = step.model()
        if not added:
            return None
        start = (*best.model, *added)
        (tried,) = self._tried([start], [known.jacobian(start)])
        larger = self.fitted(tried.model)
        return larger if self._is_better(larger, best) else None

    def _with_others(
        self, best: Judged, step: Stepwise, known: KnownChanges
    ) -> Judged | None:
        """The model with other effects in place of some; None if none is better."""
        starts = step.exchanged()[:EXCHANGED]
        tried = self._tried(starts, [known.jacobian(one) for one in starts])
        if not (tried and self._ebic(tried[0]).prefers(tried[0], best)):
            return None
        return self.fitted(tried[0].model)

    def _explains_all(self, best: Judged) -> bool:
        """Whether a model leaves so little that this may be noise."""
        floors = self._fit.noise_energy, self.judge.select.noise_energy
        left = best.fit.energy, best.selected
        return all(
            one <= MORE_THAN_NOISE**2 * floor
            for one, floor in zip(left, floors, strict=True)
        )

    def _tied(self, best: Judged) -> Judged:
        """The model with values that joints share, where these explain as much."""
        plant = self._fit.plant
        levels: tuple[Level, ...] = ("all", "motor")
        joints = set(plant.joints)
        names = {one.name for one in best.model if effect(one.name).of_motor}
        apart = {one.name for one in best.model if one.place not in joints}
        for name in sorted(names - apart):
            for level in levels:
                own = [placed for placed in best.model if placed.name == name]
                shared = tied(plant, own, level)
                if number_of_values(shared) == number_of_values(tuple(own)):
                    continue
                rest = tuple(one for one in best.model if one.name != name)
                (tried,) = self._tried([(*rest, *shared)], [None])
                if self._ebic(best).prefers(tried, best):
                    best = self.fitted(tried.model)
                    break
        return best

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

    def _tried(
        self, starts: Sequence[Model], jacobians: Sequence[FloatArray | None]
    ) -> list[Judged]:
        """Models fitted in a few steps and judged, the most plausible first.

        `jacobians` (N, p) are those at the start values, None if unknown.
        """

        def work() -> list[Judged]:
            steps = self.judge.rules.first_steps
            fits = fit_all(self._fit, starts, steps, followed=True, jacobians=jacobians)
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
        known = KnownChanges(self._fit, best.fit, found)
        larger = self._best_of(shared, best, known)
        if larger:
            return larger
        singles, more = self._singles(best, found)
        known = KnownChanges(self._fit, best.fit, [*found, *more])
        return self._best_of([*apart, *singles], best, known)

    def _best_of(
        self, models: Sequence[Model], best: Judged, known: KnownChanges
    ) -> Judged | None:
        """The most plausible of some models; None if all are worse than the best one.

        What is better at different joints is taken together. A model with a further
        value on a bound is none: something else is behind it.
        """
        tried = self._tried(models, [known.jacobian(one) for one in models])
        better = [
            one.model
            for one in tried
            if self._is_better(one, best) and not self._stopped(one, best)
        ]
        together = united(self._fit.plant.joints, best.model, better)
        if better and together != better[0]:
            larger = self.fitted(together)
            if self._is_better(larger, best):
                return larger
        for each in tried[:FINISHED]:
            larger = self.fitted(each.model)
            if not self._is_better(larger, best):
                return None
            if not self._stopped(larger, best):
                return larger
        return None

    def _stopped(self, larger: Judged, best: Judged) -> bool:
        """Whether a single effect that was added has run into a bound."""
        known = {placed.key for placed in best.model}
        new = [placed for placed in larger.model if placed.key not in known]
        return len(new) == 1 and ran_into_bound(larger.fit, new[0])

    def _is_better(self, larger: Judged, best: Judged) -> bool:
        """Whether all data speak for the larger model, and the selection data do."""
        prefers = self._ebic(larger).prefers(larger, best)
        return prefers and larger.selected < best.selected

    def _singles(
        self, best: Judged, found: Sequence[Signature]
    ) -> tuple[list[Model], list[Signature]]:
        """Models with one more single effect; none where no kind explains anything.

        Signatures of effects that any servo may have are known (`found`); also returns
        those of the others. What does not last is tried where a short error is left.
        """
        if not best.model:
            return [], []
        known = servo_effects()
        others = [name for name in all_effects() if name not in known]
        short = push_intervals(self._fit, best.fit.residual)[1:]
        more = signatures(self._fit, best.model, self._usage, short, others)
        candidates = Candidates(self._fit, [*found, *more], self.judge.rules)
        self.judge.least_gain = candidates.gain_by_chance(best.fit.residual)
        return candidates.larger([best], near=False, residual=None), more

    def _replaced(self, best: Judged) -> Judged:
        """The model with other kinds of effects instead of its own if they fit better.

        What was added first was compared with little else: friction that grows with the
        load may have stood for a different dry friction at each joint.
        """
        for name in sorted({group[0].name for group in groups_of(best.model)}):
            own = [placed for placed in best.model if placed.name == name]
            rest = tuple(placed for placed in best.model if placed.name != name)
            if len(own) < FEWEST or not rest:
                continue
            (base,) = self._tried([rest], [best.fit.jacobian_of(rest)])
            found = signatures(self._fit, base.model, self._usage, (), servo_effects())
            known = KnownChanges(self._fit, base.fit, found)
            screen = Screen(self._fit, found)
            every = itertools.chain(*kinds_to_add(self._fit, screen, base))
            models = [one for one in every if one != best.model]
            for tried in self._tried(models, [known.jacobian(one) for one in models]):
                if not self._ebic(best).prefers(tried, best):
                    break
                if not self._stopped(tried, base):
                    best = self._exact(self.fitted(tried.model))
                    break
        return best

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
        needed, size = set[str](), len(best.model)
        while True:
            ebic = self._ebic(best)
            worth = {
                group: ebic.nats(gain, best) - ebic.price_within(best.model, group)
                for group, gain in gains_of_each(best.fit)
                if group[0].key not in needed
            }
            group = min(worth, key=lambda one: worth[one], default=())
            if not group or worth[group] > CLEARLY:
                return best if len(best.model) == size else self.fitted(best.model)
            kept = tuple(one for one in best.model if one not in group)
            tried = self._tried([kept], [best.fit.jacobian_of(kept)])[0]
            if ebic.prefers(tried, best):
                best = tried
            else:
                needed.add(group[0].key)


def united(joints: Sequence[str], best: Model, larger: Sequence[Model]) -> Model:
    """What larger models, the best first, have beside a model, at different joints.

    Of those that add something at the same joint only the first counts: they are
    alternatives. What is added elsewhere, such as a delay, concerns all joints.
    """
    known = {placed.key: placed.tied for placed in best}
    taken, model = set[str](), best
    for one in larger:
        new = {p.key: p for p in one if known.get(p.key) != p.tied}
        places = {placed.place for placed in new.values()}
        concerned = places if places <= set(joints) else set(joints)
        if concerned & taken:
            continue
        taken |= concerned
        gone = {*new, *(known.keys() - {placed.key for placed in one})}
        kept = [placed for placed in (model if model != best else one)]
        model = (*(p for p in kept if p.key not in gone), *new.values())
    return model


def lasting_effects() -> tuple[str, ...]:
    """Names of the effects that act in all of a recording."""
    return tuple(name for name, kind in all_effects().items() if not kind.timed)


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

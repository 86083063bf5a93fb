"""Searches torques for physics that all joints lack, and for what is missing beside it.

Where the torques that a motion needs are compared with measured ones, each effect acts
on its own joint at once, and models are quickly computed. So a model of many effects is
built up: kinds of effects, each at all joints, as long as each of them explains much;
then single effects upon them. Effects that chance may explain are taken out again.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from diagnosis.effects.library import all_effects, effect
from diagnosis.residuals.predictor import Model, Predictor
from diagnosis.residuals.signatures import signatures
from diagnosis.search.all_joints import (
    LEAST_SHARE,
    MOST_KINDS,
    MUCH_BETTER,
    REPLAYS,
    kinds_to_add,
    servo_effects,
)
from diagnosis.search.candidates import Candidates
from diagnosis.search.chance import by_chance
from diagnosis.search.fitting import (
    Coordinates,
    FittedModel,
    Nudges,
    fit_all,
    ran_into_bound,
)
from diagnosis.search.judging import Judge
from diagnosis.search.result import VALUE_NATS, Judged, SearchResult, without_each
from diagnosis.search.screening import Screen
from diagnosis.traces.usage import Usage
from groundwalk.arrays import BoolArray, FloatArray

MOST_SINGLES = 3
"""Largest number of single effects that are added to those at all joints."""


LEFT = 1.5
"""Multiple of the sensors' squared noise from which on so much is left of torques that
effects at all joints are tried."""


def more_is_missing(fit: Predictor, result: SearchResult) -> bool:
    """Whether torques are compared, and some effects leave more than noise of them."""
    if not fit.by_torque:
        return False
    model = result.winner.model if result.winner else ()
    (left,) = fit.without_tolerances().residuals([model])
    wide = (fit.channels.noise / fit.channels.floor)[fit.channel]
    return bool(np.sum((wide * left) ** 2) > LEFT * fit.scored.sum())


def everywhere(judge: Judge, result: SearchResult) -> SearchResult:
    """The model with effects at all joints and others if it fits much better.

    `result` is that of the search for few effects, which is returned otherwise.
    """
    least = judge.least_gain
    best = Everywhere(judge).run()
    left = result.winner.selected if result.winner else result.nothing
    gain = left - best.selected
    much = MUCH_BETTER * (left - result.floor)
    if not best.model or gain < max(much, judge.least_gain):
        judge.least_gain = least
        return result
    size = len(best.model)
    smaller = without_each(best.model)
    known = [best.fit.jacobian_of(model) for model in smaller]
    steps = judge.rules.first_steps
    fits = fit_all(judge.fit, smaller, steps, followed=True, jacobians=known)
    sizes = {size - 1: judge.ranked(judge.judge(fits)), size: [best]}
    return replace(result, best=sizes, chosen=size)


FEWEST_ALIKE = 2
"""Fewest joints at which a kind must be sure to be one that all joints have."""

FINISHED = 3
"""Number of models with one more single effect that are fitted to the end, until one
has no value on a bound: with such a value something else is behind the error."""


class Everywhere:
    """One search for effects at all joints and for others upon them."""

    def __init__(self, judge: Judge) -> None:
        """Prepare a search; the predictors of `judge` must be calibrated already."""
        self._judge, self._fit = judge, judge.fit
        self._usage = Usage.of(judge.fit.plant, judge.fit.traces)

    def run(self) -> Judged:
        """The best model; without effects if none explains much at all joints."""
        # tolerances at another model would hide what that model explains
        for part in (self._fit, self._judge.select):
            part.calibrate()
        best = self._judge.judge([self._nothing()])[0]
        for number in range(MOST_KINDS):
            self._judge.hooks.stage(f"all joints, round {number + 1}", REPLAYS)
            larger, by_chance = self._with_a_kind(best)
            if larger is None or not self._explains_much(best, larger, by_chance):
                break
            best = larger
        best = self._simplified(best)
        for number in range(MOST_SINGLES if best.model else 0):
            self._judge.hooks.stage(f"beside all joints, round {number + 1}", REPLAYS)
            larger = self._with_one_more(best)
            if larger is None:
                break
            best = larger
        return self._without_idle(best)

    def _nothing(self) -> FittedModel:
        """The nominal model, as if it had been fitted."""
        residual, none = self._judge.residual, np.zeros((len(self._judge.residual), 0))
        return FittedModel((), residual, none, Coordinates(self._fit.plant, ()))

    def _fitted(self, starts: Sequence[Model]) -> list[Judged]:
        """Models fitted in a few steps and judged, the most plausible first."""

        def work() -> list[Judged]:
            steps = self._judge.rules.first_steps
            fits = fit_all(self._fit, starts, steps, nudges_of=apart)
            return self._judge.ranked(self._judge.judge(fits))

        return self._judge.saved(work) if starts else []

    def _finished(self, model: Model) -> Judged:
        """A model fitted to the end and judged."""

        def work() -> list[Judged]:
            return self._judge.judge(fit_all(self._fit, [model], nudges_of=apart))

        return self._judge.saved(work)[0]

    def _with_a_kind(self, best: Judged) -> tuple[Judged | None, float]:
        """The model with one more kind of effect at all joints; None if none helps.

        Also the gain [nats] that a kind has by chance.
        """
        kinds = servo_effects()
        found = signatures(self._fit, best.model, self._usage, (), kinds)
        screen = Screen(self._fit, found)
        guesses = screen.singles(best.fit.residual, best.fit.jacobian)
        added = kinds_to_add(guesses, 0.0, best.model)
        tried = self._fitted([(*best.model, *more) for more in added])
        if not tried:
            return None, 0.0
        larger = self._finished(tried[0].model)
        self._judge.least_gain = screen.gain_by_chance(larger.fit.residual)
        return larger, kind_by_chance(screen, larger.fit.residual)

    def _explains_much(self, best: Judged, larger: Judged, by_chance: float) -> bool:
        """Whether a larger model explains much more of all data, and some of each."""
        gain = best.energy - larger.energy
        enough = gain > max(LEAST_SHARE * best.energy, by_chance)
        return enough and larger.selected < best.selected

    def _with_one_more(self, best: Judged) -> Judged | None:
        """The model with one more single effect; None if none is believed."""
        judge = self._judge
        others = [name for name, kind in all_effects().items() if not kind.timed]
        found = signatures(self._fit, best.model, self._usage, (), others)
        candidates = Candidates(self._fit, found, judge.rules)
        tried = self._fitted(candidates.larger([best], near=False, residual=None))
        for each in tried[:FINISHED]:
            larger = self._finished(each.model)
            if not ran_into_bound(larger.fit, larger.model[-1]):
                least = judge.least_gain
                judge.least_gain = candidates.gain_by_chance(larger.fit.residual)
                if judge.believes(larger, best):
                    return larger
                judge.least_gain = least
                break
        return None

    def _simplified(self, best: Judged) -> Judged:
        """The model with simpler forms of its effects where these explain as much."""
        for placed in best.model:
            simpler = effect(placed.name).simpler(placed)
            if simpler == placed:
                continue
            other = tuple(
                simpler if one.key == placed.key else one for one in best.model
            )
            tried = self._finished(other)
            if tried.energy - best.energy < self._judge.least_gain:
                best = tried
        return best

    def _without_idle(self, best: Judged) -> Judged:
        """The model without effects that explain too little.

        Each must explain more than others do by chance. If a kind of effect does so at
        half of all joints or more, it is taken for one that all joints have, and must
        only be worth its values at the others.
        """
        while best.model:
            gains, least = gains_of_each(best.fit), self._judge.least_gain
            sure = [one.name for i, one in enumerate(best.model) if gains[i] > least]
            half = len(self._fit.plant.joints) / 2
            asked = np.array(
                [
                    VALUE_NATS * len(one.values)
                    if sure.count(one.name) >= max(half, FEWEST_ALIKE)
                    else least
                    for one in best.model
                ]
            )
            worst = int(np.argmin(gains / np.maximum(asked, 1e-12)))
            if gains[worst] > asked[worst]:
                break
            kept = tuple(one for i, one in enumerate(best.model) if i != worst)
            if not kept:
                return self._judge.judge([self._nothing()])[0]
            best = self._finished(kept)
        return best


def kind_by_chance(screen: Screen, residual: FloatArray) -> float:
    """The gain [nats] of the best kind, at all its places, by chance in 1 of 100 cases.

    `residual` (N,) is that which a model leaves [noise]: see `chance.py`.
    """
    kinds: dict[str, FloatArray] = {}
    for key, gains in screen.gains_by_chance(residual).items():
        name = key.partition("@")[0]
        kinds[name] = kinds.get(name, 0.0) + gains
    return by_chance(np.max([*kinds.values()], axis=0))


def gains_of_each(fit: FittedModel) -> FloatArray:
    """(effects,) energies [nats] by which a fit gets worse without each effect.

    To first order, the other values being fitted again (Wald 1943). Infinite where no
    finite value stands for no effect.
    """
    coordinates, gains, first = fit.coordinates, [], 0
    jacobian = fit.jacobian
    spread = np.linalg.pinv(jacobian.T @ jacobian, hermitian=True)
    x = coordinates.of(fit.model)
    for placed in fit.model:
        own = list(range(first, first + len(placed.values)))
        first += len(own)
        size = max(effect(placed.name).components, 1)
        neutral = [coordinates.parameters[i].neutral for i in own[:size]]
        if not np.isfinite(neutral).all():
            gains.append(np.inf)
            continue
        away = [
            x[i] - coordinates.scaled(i, value)
            for i, value in zip(own, neutral, strict=False)
        ]
        part = spread[np.ix_(own[:size], own[:size])]
        gains.append(0.5 * float(away @ np.linalg.pinv(part, hermitian=True) @ away))
    return np.array(gains)


def apart(predictor: Predictor, model: Model) -> Nudges:
    """Finite differences for `fit_all` that change one value at all joints at once.

    What acts at one joint changes the torque that the motion needs at that joint only;
    other effects are changed by themselves.
    """
    groups: dict[tuple[str, int, str], list[int]] = {}
    rows: list[BoolArray] = []
    for placed in model:
        is_joint = placed.place in predictor.plant.joints
        alone = not is_joint or not effect(placed.name).joint_by_joint
        own = predictor.channels.of_joint(placed.place)
        for k in range(len(placed.values)):
            key = (placed.name, k, placed.place if alone else "")
            groups.setdefault(key, []).append(len(rows))
            rows.append(np.isin(predictor.channel, own) | alone)
    return Nudges(list(groups.values()), rows)

"""Proposes the models (sets of effects) to fit, each with values to start from."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from diagnosis.effects.library import all_effects, effect, grown_from
from diagnosis.residuals.predictor import Model, Predictor
from diagnosis.residuals.signatures import FEW_JOINTS, Signature
from diagnosis.residuals.ties import without_each
from diagnosis.search.result import Judged, keys_of
from diagnosis.search.rules import Rules
from diagnosis.search.screening import Screen
from groundwalk.arrays import FloatArray


class Candidates:
    """Proposes models to fit, by linear estimates and by similarity of effects.

    A guess is a model whose values and gain follow from signatures, the changes of the
    residual by each effect at each place, by linear least squares.
    """

    def __init__(
        self, fit: Predictor, found: Sequence[Signature], rules: Rules
    ) -> None:
        """Prepare guesses from the signatures of all effects at all places.

        `fit` is the predictor of the fitting data; `rules` say how many models of each
        sort are proposed.
        """
        self._fit, self._found, self._rules = fit, found, rules
        self._screen = Screen(fit, found)

    def alone(self, residual: FloatArray) -> list[Model]:
        """Models of one effect: the best guesses, and the best of some other kinds.

        With few joints of all other kinds, else of those likely to explain most.
        `residual` (N,) is that of the nominal sim [noise].
        """
        rules, ranked = self._rules, self._screen.singles(residual)
        few = len(self._fit.plant.joints) <= FEW_JOINTS
        most = len(all_effects()) if few else rules.single_effects
        best = ranked[: rules.single_effects - rules.further_effects]
        short = [guess.model for guess in best]
        named = {model[0].name for model in short}
        for guess in ranked[len(short) :]:
            if len(short) < most and guess.model[0].name not in named:
                short.append(guess.model)
                named.add(guess.model[0].name)
        return self._scanned(short)

    def larger(
        self, best: Sequence[Judged], near: bool, residual: FloatArray | None
    ) -> list[Model]:
        """Models with one more effect; the same effects may occur with other values.

        `best` are models with equally many effects, the best first; `near` combines the
        best one with all effects at the same place. Pairs are guessed if the residual
        (N,) of the nominal sim is given.
        """
        starts = self._growths(best)
        if near:
            starts += self._partners(best[0])
        if residual is not None:
            known = {keys_of(model) for model in starts}
            pairs = self.pairs(residual, scanned=False)
            starts += [model for model in pairs if keys_of(model) not in known]
        return self._scanned(starts)

    def pairs(self, residual: FloatArray, scanned: bool = True) -> list[Model]:
        """The pairs of effects that explain most of a residual (N,) of the nominal sim.

        `scanned` tries several sizes of one of each pair.
        """
        guesses = self._screen.pairs(residual, self._rules.pairs)
        models = [guess.model for guess in guesses]
        return self._scanned(models) if scanned else models

    def swapped(self, judged: Judged) -> list[Model]:
        """Variants of a model with one effect replaced by another, or moved."""
        swaps: dict[frozenset[str], Model] = {}
        rests = without_each(judged.model)
        residuals = self._fit.residuals(rests)
        for rest, residual in zip(rests, residuals, strict=True):
            jacobian = judged.fit.jacobian_of(rest)
            others = self._screen.singles(residual, jacobian)[: self._rules.swaps]
            for model in ((*rest, *guess.model) for guess in others):
                keys = keys_of(model)
                if len(keys) == len(model) and keys != judged.keys:
                    swaps.setdefault(keys, model)
        for model in moved(self._fit, judged.model):
            swaps.setdefault(keys_of(model), model)
        return self._scanned(list(swaps.values()))

    def promised(self, judged: Judged) -> float:
        """Linear estimate of the most [nats] that one more effect would gain."""
        guesses = self._screen.singles(judged.fit.residual, judged.fit.jacobian)
        return max((guess.gain for guess in guesses), default=0.0)

    def gain_by_chance(self, residual: FloatArray) -> float:
        """The gain [nats] that the best single effect has by chance in 1 of 100 cases.

        `residual` (N,) is that which a fitted model leaves on the fitting data [noise].
        """
        return self._screen.gain_by_chance(residual)

    def _scanned(self, starts: Sequence[Model]) -> list[Model]:
        """Models with the best of several simulated sizes of their last effect.

        Linear estimates are far off for some effects, such as backlash or delays.
        """
        options = []
        for *rest, last in starts:
            scan = effect(last.name).sizes_to_scan
            sizes = scan(self._fit.plant, last, self._fit.traces)
            options.append([(*rest, other) for other in sizes])
        if not options:
            return []
        every = [model for some in options for model in some]
        energies = (self._fit.residuals(every) ** 2).sum(axis=1)
        ends = np.cumsum([len(some) for some in options])
        return [
            some[int(np.argmin(energy))]
            for some, energy in zip(options, np.split(energies, ends[:-1]), strict=True)
        ]

    def _leading(self, best: Sequence[Judged]) -> list[Judged]:
        """The models to extend: the best on the selection data, and on all data.

        A final answer must do well on the selection data; a partial answer may do well
        only on the fitting data.
        """
        beam = self._rules.beam
        on_all = sorted(best, key=lambda one: one.energy)[:beam]
        selected = sorted(best, key=lambda one: one.selected)[:beam]
        leading = [*best[:beam], *on_all, *selected]
        return list({one.keys: one for one in leading}.values())

    def _growths(self, best: Sequence[Judged]) -> list[Model]:
        """Models with one more effect, no two with the same effects and places."""
        seen: set[frozenset[str]] = set()
        grown: list[Model] = []
        for judged in self._leading(best):
            added = 0
            for guess in self._screen.singles(judged.fit.residual, judged.fit.jacobian):
                model = (*judged.model, *guess.model)
                keys = keys_of(model)
                if len(keys) == len(model) and keys not in seen:
                    seen.add(keys)
                    grown.append(model)
                    added += 1
                if added == self._rules.growths_each:
                    break
        return grown

    def _partners(self, judged: Judged) -> list[Model]:
        """A model of one effect, combined with each other effect at its joint or body.

        Effects at one place may need each other, such as a stiffer servo and a payload:
        the residual that one leaves need not point to the other.
        """
        near = self._near(judged.model[0].place)
        found = [one.placed for one in reversed(self._found)]
        first = {placed.key: placed for placed in found if placed.place in near}
        others = [one for key, one in first.items() if key not in judged.keys]
        return [(*judged.model, placed) for placed in others]

    def _near(self, place: str) -> set[str]:
        """A joint and the body that it moves, if `place` is one of the two."""
        model, near = self._fit.plant.model, {place}
        for joint in self._fit.plant.joints:
            pair = joint, model.body(int(model.joint(joint).bodyid[0])).name
            if place in pair:
                near.update(pair)
        return near


def moved(fit: Predictor, model: Model) -> list[Model]:
    """Variants of a model with an effect moved along the chain of bodies."""
    return [
        tuple(
            replace(other, place=place) if other is placed else other for other in model
        )
        for placed in model
        if effect(placed.name).place_kind == "body"
        for place in effect(placed.name).places(fit.plant, fit.traces)
        if place in fit.plant.neighbours(placed.place)
    ]


def grown(fit: Predictor, model: Model) -> list[Model]:
    """Variants of a model with one effect replaced by a more general one."""
    return [
        tuple(grown if other is placed else other for other in model)
        for placed in model
        for grown in grown_from(placed)
        if grown.place in effect(grown.name).places(fit.plant, fit.traces)
    ]

"""Search over effects and places, alone and in company, judged on data kept aside.

Models grow one effect at a time, several of them side by side, since the best single
effect need not be part of the best pair. Guesses at first order say what is worth a
fit; fits see the fitting data only; whether an effect earns its place is decided on
the selection data.
"""

from collections.abc import Sequence

import numpy as np

from diagnosis.bursts import push_intervals
from diagnosis.effect import Placed
from diagnosis.fitting import fit_all
from diagnosis.library import EFFECTS
from diagnosis.predictor import Model, Predictor
from diagnosis.screening import Guess, Screen, stretched
from diagnosis.search_result import Found, Judged, Rules, keys_of, ranked
from diagnosis.signatures import Signature, signatures
from diagnosis.usage import Usage
from groundwalk.arrays import FloatArray

STRETCHES = (0.3, 0.6, 1.0, 1.7, 3.0)
"""Of a guess, tried before it is fitted."""


class Search:
    """One search; keeps what several steps need."""

    def __init__(
        self,
        fit: Predictor,
        select: Predictor,
        rules: Rules | None = None,
        well: Sequence[Predictor] = (),
    ) -> None:
        """Get ready.

        Args:
          fit: of the fitting data, calibrated.
          select: of the selection data, calibrated, with the same channels.
          rules: the usual ones where None.
          well: of recordings when all was well, likewise: what a model gains there is
            no evidence of a change.
        """
        self.well = well
        self.fit, self.select, self.rules = fit, select, rules or Rules()
        self.usage = Usage.of(fit.plant, fit.traces)
        self.floor = 0.5 * float(select.scored.sum())
        self.signatures: list[Signature] = []
        """Of all effects at all places, once the search has run."""
        self._nothing_fit = np.inf

    def run(self) -> Found:
        """Grow models until another effect is not worth it."""
        nothing = self._energy(())
        residual = self.fit.residuals([()])[0]
        self._nothing_fit = 0.5 * float(residual @ residual)
        intervals = push_intervals(self.fit, residual)
        self.signatures = signatures(self.fit, (), self.usage, intervals)
        screen = Screen(self.fit, self.signatures)
        best = {1: self.judged(self._scanned(self._short(screen.singles(residual))))}
        chosen, size, energy = 0, 1, nothing
        while best.get(size):
            if self.worth(energy, best[size][0].selected, nothing):
                chosen = size
                best[size] = self._refined(best[size])
                energy = best[size][0].selected
            # two together may explain what each alone does not: a gap that rattles
            # without its friction, say
            elif size > 1 or nothing < self.rules.suspicious * self.floor:
                break
            if size == self.rules.largest or self._exhausted(best[size][0], screen):
                break
            starts = self._growths(best[size], screen)
            if size == 1:
                starts += self._pairs(screen, residual, starts)
            size += 1
            best[size] = self.judged(self._scanned(starts))
        if chosen:
            swaps = self._scanned(self._swaps(best[chosen][0], screen))
            swapped = self.judged(swaps)
            best[chosen] = ranked(best[chosen] + swapped, self.floor)
        return Found(nothing, self.floor, best, chosen)

    @property
    def least_gain(self) -> float:
        """Log-likelihood that any effect must gain on the selection data."""
        pattern = self.rules.least_pattern**2 * self.floor
        return max(self.rules.least_gain, pattern / len(self.fit.channels.names))

    def worth(self, before: float, after: float, nothing: float) -> bool:
        """Whether a step from one energy to another is to be believed."""
        rules = self.rules
        return before - after > max(
            self.least_gain,
            rules.least_share * (before - self.floor),
            rules.least_of_all * (nothing - self.floor),
        )

    def _exhausted(self, judged: Judged, screen: Screen) -> bool:
        """Whether a model leaves little, and no effect promises to explain it."""
        if judged.selected > self.rules.suspicious * self.floor:
            return False
        guesses = screen.singles(judged.fit.residual)
        gain = max((guess.gain for guess in guesses), default=0.0)
        selected = gain * self.select.scored.sum() / self.fit.scored.sum()
        return bool(selected < self.rules.promising * self.least_gain)

    def _refined(self, best: list[Judged]) -> list[Judged]:
        """The best once more, with the integrator's error as it is at the best.

        Dry friction and stops change that error. With the best come effects that
        contain one of theirs.
        """
        for part in (self.fit, self.select):
            part.calibrate(best[0].model)
        first, rest = best[: self.rules.beam], best[self.rules.beam :]
        again = [*(judged.model for judged in first), *_grown(best[0].model)]
        refined = ranked([*self.judged(again), *rest], self.floor)
        if refined[0].keys != best[0].keys and refined[0].keys in map(keys_of, again):
            return self._refined(refined)
        return refined

    def _scanned(self, starts: Sequence[Model]) -> list[Model]:
        """Starts with the effect that was added last as large as does best.

        Guesses are of first order; a gap or a delay may be far from what they say.
        """
        options = [
            [(*start[:-1], stretched(self.fit.plant, start[-1], k)) for k in STRETCHES]
            for start in starts
        ]
        if not options:
            return []
        residuals = self.fit.residuals([model for some in options for model in some])
        energies = (residuals**2).sum(axis=1).reshape(len(starts), -1)
        return [
            some[int(i)]
            for some, i in zip(options, energies.argmin(axis=1), strict=True)
        ]

    def _short(self, ranked: Sequence[Guess]) -> list[Model]:
        """The best guesses, and the best place of each effect that comes close."""
        short = [
            guess.model for guess in ranked[: self.rules.singles - self.rules.others]
        ]
        named = {model[0].effect for model in short}
        for guess in ranked[len(short) :]:
            if len(short) == self.rules.singles:
                break
            if guess.model[0].effect not in named:
                short.append(guess.model)
                named.add(guess.model[0].effect)
        return short

    def _growths(self, best: Sequence[Judged], screen: Screen) -> list[Model]:
        """Models of one effect more, none twice."""
        seen: set[frozenset[str]] = set()
        grown: list[Model] = []
        for judged in best[: self.rules.beam]:
            added = 0
            for guess in screen.singles(judged.fit.residual):
                model = (*judged.model, *guess.model)
                keys = keys_of(model)
                if len(keys) == len(model) and keys not in seen:
                    seen.add(keys)
                    grown.append(model)
                    added += 1
                if added == self.rules.growths:
                    break
        return grown

    def _pairs(
        self, screen: Screen, residual: FloatArray, known: Sequence[Model]
    ) -> list[Model]:
        """Pairs that are better than their members let think."""
        seen = {keys_of(model) for model in known}
        pairs = screen.pairs(residual, self.rules.paired, self.rules.pairs)
        return [guess.model for guess in pairs if keys_of(guess.model) not in seen]

    def _swaps(self, judged: Judged, screen: Screen) -> list[Model]:
        """The model with one effect exchanged for another: what else it may be."""
        swaps: dict[frozenset[str], Model] = {}
        rests = [
            tuple(other for other in judged.model if other is not placed)
            for placed in judged.model
        ]
        residuals = self.fit.residuals(rests)
        for rest, residual in zip(rests, residuals, strict=True):
            others = screen.singles(residual)[: self.rules.swaps]
            for model in ((*rest, *guess.model) for guess in others):
                keys = keys_of(model)
                if len(keys) == len(model) and keys != judged.keys:
                    swaps.setdefault(keys, model)
        for model in self._moved(judged):
            swaps.setdefault(keys_of(model), model)
        return list(swaps.values())

    def _moved(self, judged: Judged) -> list[Model]:
        """The model with an effect on a body moved to the next bodies of the chain."""
        plant, traces = self.fit.plant, self.fit.traces
        return [
            tuple(
                Placed(other.effect, place, other.values) if other is placed else other
                for other in judged.model
            )
            for placed in judged.model
            if EFFECTS[placed.effect].place_kind == "body"
            for place in EFFECTS[placed.effect].places(plant, traces)
            if place in plant.neighbours(placed.place)
        ]

    def judged(self, starts: Sequence[Model]) -> list[Judged]:
        """Fitted and judged, the best on the selection data first.

        Most starts lead nowhere: only those that are among the best after a few steps
        are fitted to the end.
        """
        rough = fit_all(self.fit, starts, self.rules.first_steps)
        rough.sort(key=lambda fit: fit.energy)
        count = self._worthy([fit.energy for fit in rough])
        worthy = [fit.model for fit in rough[:count]]
        fits = fit_all(self.fit, worthy) + rough[count:]
        energies = self.energies([fit.model for fit in fits])
        judged = [
            Judged(fit, energy) for fit, energy in zip(fits, energies, strict=True)
        ]
        return ranked(list(judged), self.floor)

    def _worthy(self, energies: Sequence[float]) -> int:
        """How many of the best are worth more steps: none that is far behind.

        Args:
          energies: on the fitting data, the least first.
        """
        if not energies:
            return 0
        explained = self._nothing_fit - energies[0]
        most = energies[0] + max(self.least_gain, self.rules.far * explained)
        near = sum(energy <= most for energy in energies)
        return min(near, self.rules.finished)

    def _energy(self, model: Model) -> float:
        return self.energies([model])[0]

    def energies(self, models: Sequence[Model]) -> list[float]:
        """Of models on the selection data, with what they gained when all was well."""
        if not models:
            return []
        residuals = self.select.residuals(models)
        energies = [0.5 * float(row @ row) for row in residuals]
        before = self._gains_before(models)
        return [e + gain for e, gain in zip(energies, before, strict=True)]

    def _gains_before(self, models: Sequence[Model]) -> list[float]:
        """What each model would have gained when all was well, had it been as much."""
        if not self.well:
            return [0.0] * len(models)
        energies = sum(
            0.5 * np.sum(well.residuals([(), *models]) ** 2, axis=1)
            for well in self.well
        )
        floor = 0.5 * sum(float(well.scored.sum()) for well in self.well)
        gains = (energies[0] - energies[1:]) * self.floor / floor
        return [max(float(gain), 0.0) for gain in gains]


def _grown(model: Model) -> list[Model]:
    """The model with one effect exchanged for another that contains it."""
    return [
        tuple(grown if other is placed else other for other in model)
        for placed in model
        for kind in EFFECTS.values()
        for grown in kind.grown_from(placed)
    ]

"""Search over effects and places, alone and in company, judged on data kept aside.

Models grow one effect at a time, several of them side by side, since the best single
effect need not be part of the best pair. Guesses at first order say what is worth a
fit; fits see the fitting data only; whether an effect earns its place is decided on
the selection data.
"""

from collections.abc import Sequence

from diagnosis.bursts import push_intervals
from diagnosis.effect import Placed
from diagnosis.fitting import fit_all
from diagnosis.library import EFFECTS
from diagnosis.predictor import Model, Predictor
from diagnosis.screening import Guess, Screen
from diagnosis.search_result import Found, Judged, Rules, keys_of, ranked
from diagnosis.signatures import Signature, signatures
from diagnosis.usage import Usage
from groundwalk.arrays import FloatArray


class Search:
    """One search; keeps what several steps need."""

    def __init__(
        self, fit: Predictor, select: Predictor, rules: Rules | None = None
    ) -> None:
        """Get ready.

        Args:
          fit: of the fitting data, calibrated.
          select: of the selection data, calibrated, with the same channels.
          rules: the usual ones where None.
        """
        self.fit, self.select, self.rules = fit, select, rules or Rules()
        self.usage = Usage.of(fit.plant, fit.traces)
        self.floor = 0.5 * float(select.scored.sum())
        self.signatures: list[Signature] = []
        """Of all effects at all places, once the search has run."""

    def run(self) -> Found:
        """Grow models until another effect is not worth it."""
        nothing = self._energy(())
        residual = self.fit.residuals([()])[0]
        intervals = push_intervals(self.fit, residual)
        self.signatures = signatures(self.fit, (), self.usage, intervals)
        screen = Screen(self.fit, self.signatures)
        best = {1: self.judged(self._short(screen.singles(residual)))}
        chosen, size, energy = 0, 1, nothing
        while best.get(size):
            if self._worth(energy, best[size][0].selected, nothing):
                chosen, energy = size, best[size][0].selected
            # two together may explain what each alone does not: a gap that rattles
            # without its friction, say
            elif size > 1 or nothing < self.rules.suspicious * self.floor:
                break
            if size == self.rules.largest:
                break
            starts = self._growths(best[size], screen)
            if size == 1:
                starts += self._pairs(screen, residual, starts)
            size += 1
            best[size] = self.judged(starts)
        if chosen:
            swapped = self.judged(self._swaps(best[chosen][0], screen))
            best[chosen] = ranked(best[chosen] + swapped, self.floor)
        return Found(nothing, self.floor, best, chosen)

    @property
    def least_gain(self) -> float:
        """Log-likelihood that any effect must gain on the selection data."""
        pattern = self.rules.least_pattern**2 * self.floor
        return max(self.rules.least_gain, pattern / len(self.fit.channels.names))

    def _worth(self, before: float, after: float, nothing: float) -> bool:
        """Whether a step from one energy to another is to be believed."""
        rules = self.rules
        return before - after > max(
            self.least_gain,
            rules.least_share * (before - self.floor),
            rules.least_of_all * (nothing - self.floor),
        )

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
        worthy = [fit.model for fit in rough[: self.rules.finished]]
        fits = fit_all(self.fit, worthy) + rough[self.rules.finished :]
        energies = self._energies([fit.model for fit in fits])
        judged = [
            Judged(fit, energy) for fit, energy in zip(fits, energies, strict=True)
        ]
        return ranked(list(judged), self.floor)

    def _energy(self, model: Model) -> float:
        return self._energies([model])[0]

    def _energies(self, models: Sequence[Model]) -> list[float]:
        if not models:
            return []
        residuals = self.select.residuals(models)
        return [0.5 * float(row @ row) for row in residuals]

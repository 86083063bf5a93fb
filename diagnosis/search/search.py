"""Search over effects and places, alone and in company, judged on data kept aside.

Models grow one effect at a time, several of them side by side, since the best single
effect need not be part of the best pair. Guesses at first order say what is worth a
fit; fits see the fitting data only; whether an effect earns its place is decided on
the selection data.
"""

from collections.abc import Sequence

import numpy as np

from diagnosis.residuals.bursts import push_intervals
from diagnosis.residuals.predictor import Model, Predictor
from diagnosis.search.candidates import Starts, grown
from diagnosis.search.fitting import Fit, fit_all
from diagnosis.search.result import Found, Judged, Rules, ranked
from diagnosis.search.signatures import Signature, signatures
from diagnosis.traces.usage import Usage
from groundwalk.arrays import FloatArray

PUSH = "external_force"


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
        self.floor_fit = 0.5 * float(fit.scored.sum())
        # models of one size fit nothing by chance that others do not; but on feet two
        # runs part by chance, and what happened before is held against both
        self._weight = float(fit.plant.base == "fixed" and not well)
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
        starts = Starts(self.fit, self.signatures, self.rules)
        best = {1: self.judged(starts.alone(residual))}
        chosen, size, energy, fitted = 0, 1, nothing, self._nothing_fit
        while best.get(size):
            first = best[size][0]
            gains = fitted - first.fit.energy, energy - first.selected
            shows = self._shows(*gains)
            shows &= self._matters(energy, first.selected, nothing)
            if shows or (size == 1 and self._hints(*gains)):
                chosen = size
                best[size] = self._refined(best[size])
                energy, fitted = best[size][0].selected, best[size][0].fit.energy
                starts = self._starts_from(best[size][0])
            # two together may explain what each alone does not: a gap that rattles
            # without its friction, say
            elif size > chosen + 1 or energy < self.rules.suspicious * self.floor:
                break
            larger = self._larger(starts, best[size], residual)
            size += 1
            best[size] = self.judged(larger)
        if chosen:
            swapped = self.judged(starts.swapped(best[chosen][0]))
            best[chosen] = _distinct(self.ranked(best[chosen] + swapped))
        return Found(
            nothing, self.floor, best, chosen, self._nothing_fit, self.floor_fit
        )

    def ranked(self, judged: Sequence[Judged]) -> list[Judged]:
        """The most plausible first."""
        return ranked(judged, self.floor + self._weight * self.floor_fit)

    @property
    def least_gain(self) -> float:
        """Log-likelihood that any effect must gain on the selection data."""
        pattern = self.rules.least_pattern**2 * self.floor
        return max(self.rules.least_gain, pattern / len(self.fit.channels.names))

    @property
    def least_fitted(self) -> float:
        """The same on the fitting data, of an effect that shows evenly in both kinds.

        On a fixed base both together must tell enough, on feet each of them.
        """
        share = float(self.fit.scored.sum() / self.select.scored.sum())
        if self.fit.plant.base == "fixed":
            return max(self.least_gain, 2 * self.least_gain * share / (1 + share))
        return max(1.0, share) * self.least_gain

    def worth(self, before: float, after: float, nothing: float) -> bool:
        """Whether a step from one energy to another is to be believed."""
        enough = before - after > self.least_gain
        return enough and self._matters(before, after, nothing)

    def _matters(self, before: float, after: float, nothing: float) -> bool:
        """Whether a step takes away enough of what there is to explain.

        How much that is nobody knows better than the noise: near it there is no share.
        """
        rules = self.rules
        left = before - (1 + rules.unsure_floor) * self.floor
        return before - after > max(
            rules.least_share * left, rules.least_of_all * (nothing - self.floor), 0.0
        )

    def _shows(self, fitted: float, selected: float) -> bool:
        """Whether gains on both kinds of data are enough, each for itself.

        What fits the selection data by chance gains little where it was fitted.
        """
        return min(fitted, selected) > self.least_gain

    def _hints(self, fitted: float, selected: float) -> bool:
        """Whether they are enough together, as one effect on a fixed base may show.

        A joint need not move as much in the selection data as in the others; a stop or
        a push need not be met there at all. On feet two runs part by chance, and much
        is gained in some that is lost in others.
        """
        rules, gain = self.rules, fitted + selected
        left = self._nothing_fit - (1 + rules.unsure_floor) * self.floor_fit
        if self.fit.plant.base != "fixed" or gain < rules.least_share * left:
            return False
        both = fitted > self.least_gain and selected > rules.least_hint
        one = fitted > rules.alone * self.least_gain and selected > -rules.least_hint
        return bool((both and gain > 2 * self.least_gain) or one)

    def _starts_from(self, leader: Judged) -> Starts:
        """Starts that also know of pushes that show once the leader is known."""
        left = leader.fit.residual
        _, *bursts = push_intervals(self.fit, left)
        pushes: list[Signature] = []
        if bursts:
            pushes = signatures(self.fit, leader.model, self.usage, bursts, (PUSH,))
        return Starts(self.fit, [*self.signatures, *pushes], self.rules)

    def _larger(
        self, starts: Starts, best: Sequence[Judged], residual: FloatArray
    ) -> list[Model]:
        """What to try next; nothing where little is left, and no effect promises."""
        leader = best[0]
        alone = len(leader.model) == 1
        if len(leader.model) == self.rules.largest:
            return []
        if leader.selected > self.rules.suspicious * self.floor:
            return starts.larger(best, near=alone, residual=residual if alone else None)
        gain = starts.promised(leader) * self.select.scored.sum()
        least = self.rules.promising * self.least_gain * self.fit.scored.sum()
        if gain < least:
            return []
        return starts.larger(best, near=False, residual=residual if alone else None)

    def _refined(self, best: list[Judged]) -> list[Judged]:
        """The best once more, with the integrator's error as it is at the best.

        Dry friction and stops change that error. With the best come effects that
        contain one of theirs.
        """
        for _ in range(self.rules.rounds):
            before = best[0]
            for part in (self.fit, self.select):
                part.calibrate(before.model)
            first, rest = best[: self.rules.beam], best[self.rules.beam :]
            wider = grown(before.model)
            again = [*(judged.model for judged in first), *wider]
            known = [None, *(judged.fit.jacobian for judged in first[1:])]
            tried = self.judged(again, [*known, *(None for _ in wider)])
            best = _distinct(self.ranked([*tried, *rest]))
            if best[0].keys == before.keys or best[0] not in tried:
                break
        return best

    def judged(
        self,
        starts: Sequence[Model],
        jacobians: Sequence[FloatArray | None] | None = None,
    ) -> list[Judged]:
        """Fitted and judged, the best on the selection data first.

        Most starts lead nowhere: only those that are among the best after a few steps
        are fitted to the end.

        Args:
          starts: models with values to begin with.
          jacobians: there, where they are known.
        """
        rough = fit_all(
            self.fit,
            starts,
            self.rules.first_steps,
            followed=True,
            jacobians=jacobians,
        )
        rough.sort(key=lambda fit: fit.energy)
        count = self._worthy([fit.energy for fit in rough])
        fits = fit_all(
            self.fit,
            [fit.model for fit in rough[:count]],
            followed=True,
            jacobians=[fit.jacobian for fit in rough[:count]],
        )
        return _distinct(self.ranked(self.judge([*fits, *rough[count:]])))

    def judge(self, fits: Sequence[Fit], exactly: bool = False) -> list[Judged]:
        """What fits come to on the selection data, in their order.

        Args:
          fits: to the fitting data.
          exactly: with the integrator's error as it is at each model.
        """
        energies = self.energies([fit.model for fit in fits], exactly)
        return [
            Judged(fit, energy, self._weight)
            for fit, energy in zip(fits, energies, strict=True)
        ]

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

    def energies(self, models: Sequence[Model], exactly: bool = False) -> list[float]:
        """Of models on the selection data, with what they gained when all was well."""
        if not models:
            return []
        residuals = self.select.residuals(models, exactly)
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


def _distinct(judged: Sequence[Judged]) -> list[Judged]:
    """The first of each structure: several starts may lead to the same."""
    first = {one.keys: one for one in reversed(judged)}
    return [one for one in judged if first[one.keys] is one]

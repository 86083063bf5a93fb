"""Chooses many effects at once, each at its own place, by linear estimates.

Where many joints are off, each round of a search that adds one effect, or one kind,
costs as much as the last one. But signatures say what every effect would change, and
linear least squares what several would change together: effects are added one by one to
a linear model as long as the criterion falls, and exchanged for others that suit
better (stepwise regression, Efroymson 1960). Only the result is fitted by replays.
"""

from collections.abc import Collection, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.optimize import lsq_linear

from diagnosis.effects.library import effect
from diagnosis.residuals.predictor import Model
from diagnosis.residuals.ties import groups_of
from diagnosis.search.many.ebic import Ebic
from diagnosis.search.result import Judged, keys_of
from diagnosis.search.screening import SAME, TINY, Guess, Screen, View
from groundwalk.arrays import FloatArray

MOST_AT_ONCE = 30
"""Most effects that are chosen before they are fitted."""

TRUSTED = 0.05
"""Share of the energy above the noise at which a choice ends: effects are not linear,
and what a linear model leaves when little is left says little."""

UNSURE = 20.0
"""Nats by which an exchange may look worse and is still tried: linear estimates of what
replaces an effect are rough."""

EXCHANGES = 3
"""Most times that each chosen effect is compared with all others in its place."""


@dataclass(frozen=True, eq=False)
class _Start:
    """Effects of the fitted model beside which others are to be chosen.

    Attributes:
      model: the effects.
      kept: indices of the columns of its Jacobian, whose values are free.
      away: (p,) how far the other values go, to stand for no effect.
      without: names and "effect@place" of effects that are not to be chosen.
    """

    model: Model
    kept: tuple[int, ...]
    away: FloatArray
    without: frozenset[str] = frozenset()


class Stepwise:
    """A linear choice of effects beside those of a fitted model.

    Residuals are linear in p values of the model and in the sizes of K signatures. All
    that least squares need are the scalar products of these columns with each other and
    with the residual, which are computed once.
    """

    def __init__(self, screen: Screen, ebic: Ebic, best: Judged, floor: float) -> None:
        """Prepare choices beside a model.

        Args:
          screen: has the signatures of all effects beside the model.
          ebic: decides.
          best: the fitted model.
          floor: energy that noise alone leaves on the fitting data [nats].
        """
        self.ebic, self.best = ebic, best
        self._screen, self._floor = screen, floor
        fit = best.fit
        columns = np.concatenate([fit.jacobian, screen.changes()], axis=1)
        self._values = fit.jacobian.shape[1]
        self._products = columns.T @ columns
        self._wanted = columns.T @ fit.residual
        self._square = float(fit.residual @ fit.residual)

    def models(self, most: int) -> list[Model]:
        """Effects to add, with values to start a fit from; none if none helps.

        The first model is the best linear one. Each of the others, at most `most` in
        all, does without one kind of its effects: what a small effect of a kind changes
        may look like the truth, and a large one not.
        """
        first = self._added(frozenset())
        found = {keys_of(first): first} if first else {}
        for name in dict.fromkeys(placed.name for placed in first):
            if len(found) >= most:
                break
            other = self._added(frozenset({name}))
            if other:
                found.setdefault(keys_of(other), other)
        return list(found.values())

    def _added(self, without: frozenset[str]) -> Model:
        """Effects to add, but none of some names; () if none helps."""
        every = tuple(range(self._values))
        away = np.zeros(self._values)
        start = _Start(self.best.model, every, away, without)
        taken = self._chosen(start)
        for _ in range(EXCHANGES):
            before = {guess.rows for guess in taken}
            for guess in list(taken):
                rest = [one for one in taken if one is not guess]
                other = self._next(start, rest)
                taken = [*rest, other] if other else rest
            if before == {guess.rows for guess in taken}:
                break
        return self._sized(start, taken)

    def exchanged(self) -> list[Model]:
        """Models with other effects in place of some, the most promising first.

        Effects are left out one by one, and a kind at all of its joints: their values
        go back to that of no effect. What they explained is known from the Jacobian.
        """
        model, found = self.best.model, list[tuple[float, Model]]()
        kinds = {
            tuple(placed for placed in model if placed.name == one.name)
            for one in model
            if effect(one.name).of_motor
        }
        now = self._criterion(0.5 * self._square, model)
        for own in sorted({*groups_of(model), *kinds}, key=lambda some: some[0].key):
            start = self._without(own)
            taken = self._chosen(start) if start else []
            if start is None or not taken:
                continue
            added = tuple(placed for guess in taken for placed in guess.model)
            left, _ = self._left(start, taken)
            other = self._criterion(left, (*start.model, *added))
            if other < now + UNSURE:
                sized = self._sized(start, taken)
                found.append((other, (*start.model, *sized)))
        found.sort(key=lambda one: one[0])
        return [one for _, one in found]

    def _criterion(self, energy: float, model: Model) -> float:
        """The criterion of a model that leaves an energy of the fitting data [nats]."""
        return self.ebic.nats_between(energy, 1.0) + self.ebic.price(model)

    def _without(self, own: Model) -> _Start | None:
        """The model without some effects; None if no value stands for no effect.

        Neither these are to be chosen again nor, if they are several, others of their
        kind.
        """
        coordinates = self.best.fit.coordinates
        x, away = coordinates.of(self.best.model), np.zeros(self._values)
        for i in coordinates.columns_of(own):
            neutral = coordinates.parameters[i].neutral
            if not np.isfinite(neutral):
                return None
            away[i] = coordinates.scaled(i, neutral) - x[i]
        rest = tuple(placed for placed in self.best.model if placed not in own)
        gone = {own[0].name} if len(own) > 1 else {own[0].key}
        kept = tuple(coordinates.columns_of(rest))
        return _Start(rest, kept, away, frozenset(gone))

    def _chosen(self, start: _Start) -> list[Guess]:
        """Effects that are added one by one as long as the criterion falls."""
        taken = list[Guess]()
        begun = self._left(start, [])[0] - self._floor
        while len(taken) < MOST_AT_ONCE:
            more = self._next(start, taken)
            if more is None:
                break
            taken.append(more)
            if self._left(start, taken)[0] - self._floor < TRUSTED * begun:
                break
        return taken

    def _next(self, start: _Start, taken: Sequence[Guess]) -> Guess | None:
        """The effect that lowers the criterion most beside some; None if none does."""
        energy, view = self._left(start, taken)
        added = tuple(placed for guess in taken for placed in guess.model)
        model = (*start.model, *added)
        known = start.without | {placed.key for placed in model}
        best, least = None, 0.0
        for guess in self._options(view, known):
            nats = self.ebic.nats_between(energy, energy - guess.gain)
            price = self.ebic.price_within((*model, *guess.model), guess.model)
            if nats - price > least:
                best, least = guess, nats - price
        return best

    def _options(self, view: View, without: Collection[str]) -> list[Guess]:
        """Single effects, and kinds of effects at all joints that lack them.

        None of the names and "effect@place" in `without`.
        """
        singles = [
            guess
            for guess in self._screen.singles_in(view)
            if not {guess.model[0].key, guess.model[0].name} & set(without)
        ]
        kinds = dict[str, list[Guess]]()
        for guess in singles:
            if effect(guess.model[0].name).of_motor:
                kinds.setdefault(guess.model[0].name, []).append(guess)
        every = [
            self._screen.together(view, own) for own in kinds.values() if len(own) > 1
        ]
        return [*singles, *(guess for guess in every if guess)]

    def _free(self, start: _Start, taken: Sequence[Guess]) -> list[int]:
        """Indices of the columns whose sizes are free."""
        rows = (row for guess in taken for row in guess.rows)
        return [*start.kept, *(self._values + row for row in rows)]

    def _begun(self, start: _Start) -> tuple[float, FloatArray]:
        """Square of what is left before sizes are fitted, and its products (p + K,)."""
        own = slice(0, self._values)
        wanted = self._wanted + self._products[:, own] @ start.away
        square = self._square + (self._wanted + wanted)[own] @ start.away
        return float(square), wanted

    def _left(self, start: _Start, taken: Sequence[Guess]) -> tuple[float, View]:
        """Energy that is left [nats], and the signatures as seen beside some effects.

        That is, without the part that is linear in the values of these effects.
        """
        square, wanted = self._begun(start)
        free, some = self._free(start, taken), slice(self._values, None)
        shared = self._products[:, free]
        length = np.sqrt(np.maximum(np.diag(self._products)[free], TINY))
        within = shared[free] / np.outer(length, length)
        inverse = np.linalg.pinv(within, TINY, hermitian=True)
        inverse /= np.outer(length, length)
        found = inverse @ wanted[free]
        left = wanted - shared @ found
        products = self._products[some, some] - shared[some] @ inverse @ shared[some].T
        energy = 0.5 * max(square - float(wanted[free] @ found), TINY)
        return energy, View(-left[some], products, SAME)

    def _sized(self, start: _Start, taken: Sequence[Guess]) -> Model:
        """The effects with the sizes that are best together."""
        if not taken:
            return ()
        free, known = self._free(start, taken), len(start.kept)
        rows = [row for guess in taken for row in guess.rows]
        low = np.full(len(free), -np.inf)
        high = -low
        low[known:], high[known:] = self._screen.bounds(rows)
        # least squares with the same products: the columns' own number is not needed
        wanted = self._begun(start)[1][free]
        power, turn = np.linalg.eigh(self._products[np.ix_(free, free)])
        root = np.sqrt(np.maximum(power, TINY * power.max()))
        found = lsq_linear(
            root[:, None] * turn.T, -(turn.T @ wanted) / root, (low, high)
        )
        ends = np.cumsum([len(guess.rows) for guess in taken])[:-1]
        sizes = np.split(found.x[known:], ends)
        return tuple(
            placed
            for guess, size in zip(taken, sizes, strict=True)
            for placed in self._screen.sized(guess.rows, size)
        )

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
from diagnosis.search.ebic import Ebic
from diagnosis.search.result import Judged
from diagnosis.search.screening import Guess, Screen
from diagnosis.search.ties import groups_of
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
    """What is left, by linear estimates, where effects are to be chosen beside others.

    Attributes:
      model: the effects that are there.
      jacobian: (N, p) its Jacobian.
      residual: (N,) what it leaves [noise].
      without: names and "effect@place" of effects that are not to be chosen.
    """

    model: Model
    jacobian: FloatArray
    residual: FloatArray
    without: frozenset[str] = frozenset()


@dataclass(frozen=True, eq=False)
class Stepwise:
    """A linear choice of effects beside those of a fitted model.

    Attributes:
      screen: has the signatures of all effects beside the model.
      ebic: decides.
      best: the model.
      floor: energy that noise alone leaves on the fitting data [nats].
    """

    screen: Screen
    ebic: Ebic
    best: Judged
    floor: float

    def model(self) -> Model:
        """The effects to add, with values to start a fit from; none if none helps."""
        start = _Start(self.best.model, self.best.fit.jacobian, self.best.fit.residual)
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
        now = self._criterion(self.best.fit.residual, model)
        for own in sorted({*groups_of(model), *kinds}, key=lambda some: some[0].key):
            start = self._without(own)
            taken = self._chosen(start) if start else []
            if start is None or not taken:
                continue
            left = self._residual(self._columns(start, taken), start.residual)
            added = tuple(placed for guess in taken for placed in guess.model)
            other = self._criterion(left, (*start.model, *added))
            if other < now + UNSURE:
                sized = self._sized(start, taken)
                found.append((other, (*start.model, *sized)))
        found.sort(key=lambda one: one[0])
        return [one for _, one in found]

    def _criterion(self, residual: FloatArray, model: Model) -> float:
        """The criterion of a model that leaves an (N,) residual of the fitting data."""
        energy = 0.5 * float(residual @ residual)
        return self.ebic.nats_between(energy, 1.0) + self.ebic.price(model)

    def _without(self, own: Model) -> _Start | None:
        """The model without some effects; None if no value stands for no effect.

        Neither these are to be chosen again nor, if they are several, others of their
        kind.
        """
        fit = self.best.fit
        coordinates, residual = fit.coordinates, fit.residual
        x = coordinates.of(self.best.model)
        for i in coordinates.columns_of(own):
            neutral = coordinates.parameters[i].neutral
            if not np.isfinite(neutral):
                return None
            residual = residual - fit.jacobian[:, i] * (
                x[i] - coordinates.scaled(i, neutral)
            )
        rest = tuple(placed for placed in self.best.model if placed not in own)
        gone = {own[0].name} if len(own) > 1 else {own[0].key}
        return _Start(rest, fit.jacobian_of(rest), residual, frozenset(gone))

    def _chosen(self, start: _Start) -> list[Guess]:
        """Effects that are added one by one as long as the criterion falls."""
        taken = list[Guess]()
        begun = 0.5 * float(start.residual @ start.residual) - self.floor
        while len(taken) < MOST_AT_ONCE:
            more = self._next(start, taken)
            if more is None:
                break
            taken.append(more)
            left = self._residual(self._columns(start, taken), start.residual)
            if 0.5 * float(left @ left) - self.floor < TRUSTED * begun:
                break
        return taken

    def _next(self, start: _Start, taken: Sequence[Guess]) -> Guess | None:
        """The effect that lowers the criterion most beside some; None if none does."""
        jacobian = self._columns(start, taken)
        residual = self._residual(jacobian, start.residual)
        energy = 0.5 * float(residual @ residual)
        added = tuple(placed for guess in taken for placed in guess.model)
        model = (*start.model, *added)
        known = start.without | {placed.key for placed in model}
        best, least = None, 0.0
        for guess in self._options(residual, jacobian, known):
            nats = self.ebic.nats_between(energy, energy - guess.gain)
            price = self.ebic.price_within((*model, *guess.model), guess.model)
            if nats - price > least:
                best, least = guess, nats - price
        return best

    def _options(
        self, residual: FloatArray, jacobian: FloatArray, without: Collection[str]
    ) -> list[Guess]:
        """Single effects, and kinds of effects at all joints that lack them.

        None of the names and "effect@place" in `without`.
        """
        singles = [
            guess
            for guess in self.screen.singles(residual, jacobian)
            if not {guess.model[0].key, guess.model[0].name} & set(without)
        ]
        kinds = dict[str, list[Guess]]()
        for guess in singles:
            if effect(guess.model[0].name).of_motor:
                kinds.setdefault(guess.model[0].name, []).append(guess)
        every = [
            self.screen.together(residual, jacobian, own)
            for own in kinds.values()
            if len(own) > 1
        ]
        return [*singles, *(guess for guess in every if guess)]

    def _columns(self, start: _Start, taken: Sequence[Guess]) -> FloatArray:
        """(N, p) Jacobian of the model and of some effects beside it."""
        own = [self.screen.changes(guess.rows) for guess in taken]
        return np.concatenate([start.jacobian, *own], axis=1)

    def _residual(self, jacobian: FloatArray, residual: FloatArray) -> FloatArray:
        """(N,) what a linear model leaves of a residual."""
        if not jacobian.shape[1]:
            return residual
        size = np.linalg.lstsq(jacobian, residual, rcond=None)[0]
        return np.asarray(residual - jacobian @ size)

    def _sized(self, start: _Start, taken: Sequence[Guess]) -> Model:
        """The effects with the sizes that are best together."""
        if not taken:
            return ()
        jacobian, known = self._columns(start, taken), start.jacobian.shape[1]
        rows = [row for guess in taken for row in guess.rows]
        low = np.full(jacobian.shape[1], -np.inf)
        high = -low
        low[known:], high[known:] = self.screen.bounds(rows)
        length = np.linalg.norm(jacobian, axis=0)
        length = np.where(length > 0, length, 1.0)
        found = lsq_linear(
            jacobian / length, -start.residual, (low * length, high * length)
        )
        ends = np.cumsum([len(guess.rows) for guess in taken])[:-1]
        sizes = np.split((found.x / length)[known:], ends)
        return tuple(
            placed
            for guess, size in zip(taken, sizes, strict=True)
            for placed in self.screen.sized(guess.rows, size)
        )

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
        taken = list[Guess]()
        begun = self.best.fit.energy - self.floor
        while len(taken) < MOST_AT_ONCE:
            more = self._next(taken)
            if more is None:
                break
            taken.append(more)
            if self._left(taken) - self.floor < TRUSTED * begun:
                break
        for _ in range(EXCHANGES):
            before = [guess.rows for guess in taken]
            for guess in list(taken):
                rest = [one for one in taken if one is not guess]
                other = self._next(rest)
                taken = [*rest, other] if other else rest
            if {*before} == {guess.rows for guess in taken}:
                break
        return self._sized(taken)

    def exchanged(self) -> list[Model]:
        """Models with other effects in place of some, the most promising first.

        Effects are exchanged one by one, and a kind at all of its joints. What they
        explain is known from the Jacobian; where an effect is left out its value goes
        back to that of no effect.
        """
        model, found = self.best.model, list[tuple[float, Model]]()
        kinds = {
            tuple(placed for placed in model if placed.name == one.name)
            for one in model
            if effect(one.name).of_motor
        }
        for own in sorted({*groups_of(model), *kinds}, key=lambda some: some[0].key):
            far = self._away(own)
            if far is None:
                continue
            rest = tuple(placed for placed in model if placed not in own)
            jacobian = self.best.fit.jacobian_of(rest)
            residual = self._residual(jacobian, self.best.fit.residual - far)
            energy = 0.5 * float(residual @ residual)
            lost = self.ebic.nats_between(energy, self.best.fit.energy)
            least = lost - self.ebic.price_within(model, own)
            keys = {placed.key for placed in rest}
            for guess in self._options(residual, jacobian, keys):
                gained = self._gained(energy, guess, rest)
                if gained > least - UNSURE and {p.key for p in guess.model} != {
                    p.key for p in own
                }:
                    found.append((gained - least, (*rest, *guess.model)))
        found.sort(key=lambda one: -one[0])
        return [one for _, one in found]

    def _away(self, own: Model) -> FloatArray | None:
        """(N,) what effects change by linear estimate; None if no value is nothing."""
        coordinates = self.best.fit.coordinates
        x, change = (
            coordinates.of(self.best.model),
            np.zeros_like(self.best.fit.residual),
        )
        for i in coordinates.columns_of(own):
            neutral = coordinates.parameters[i].neutral
            if not np.isfinite(neutral):
                return None
            far = x[i] - coordinates.scaled(i, neutral)
            change += far * self.best.fit.jacobian[:, i]
        return change

    def _next(self, taken: Sequence[Guess]) -> Guess | None:
        """The effect that lowers the criterion most beside some; None if none does."""
        jacobian = self._columns(taken)
        residual = self._residual(jacobian, self.best.fit.residual)
        energy = 0.5 * float(residual @ residual)
        added = tuple(placed for guess in taken for placed in guess.model)
        model = (*self.best.model, *added)
        keys = {placed.key for placed in model}
        best, least = None, 0.0
        for guess in self._options(residual, jacobian, keys):
            gained = self._gained(energy, guess, model)
            if gained > least:
                best, least = guess, gained
        return best

    def _gained(self, energy: float, guess: Guess, beside: Model) -> float:
        """How much the criterion falls [nats] by effects beside those of a model."""
        nats = self.ebic.nats_between(energy, energy - guess.gain)
        return nats - self.ebic.price_within((*beside, *guess.model), guess.model)

    def _options(
        self, residual: FloatArray, jacobian: FloatArray, known: Collection[str]
    ) -> list[Guess]:
        """Single effects, and kinds of effects at all joints that lack them.

        None of the effects `known`, as "effect@place".
        """
        singles = [
            guess
            for guess in self.screen.singles(residual, jacobian)
            if guess.model[0].key not in known
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

    def _columns(self, taken: Sequence[Guess]) -> FloatArray:
        """(N, p) Jacobian of the model and of some effects beside it."""
        own = [self.screen.changes(guess.rows) for guess in taken]
        return np.concatenate([self.best.fit.jacobian, *own], axis=1)

    def _residual(self, jacobian: FloatArray, residual: FloatArray) -> FloatArray:
        """(N,) what a linear model leaves of a residual."""
        if not jacobian.shape[1]:
            return residual
        size = np.linalg.lstsq(jacobian, residual, rcond=None)[0]
        return np.asarray(residual - jacobian @ size)

    def _left(self, taken: Sequence[Guess]) -> float:
        """Energy that some effects leave by linear estimates [nats]."""
        residual = self._residual(self._columns(taken), self.best.fit.residual)
        return 0.5 * float(residual @ residual)

    def _sized(self, taken: Sequence[Guess]) -> Model:
        """The effects with the sizes that are best together."""
        if not taken:
            return ()
        jacobian, known = self._columns(taken), self.best.fit.jacobian.shape[1]
        rows = [row for guess in taken for row in guess.rows]
        low = np.full(jacobian.shape[1], -np.inf)
        high = -low
        low[known:], high[known:] = self.screen.bounds(rows)
        length = np.linalg.norm(jacobian, axis=0)
        length = np.where(length > 0, length, 1.0)
        found = lsq_linear(
            jacobian / length, -self.best.fit.residual, (low * length, high * length)
        )
        ends = np.cumsum([len(guess.rows) for guess in taken])[:-1]
        sizes = np.split((found.x / length)[known:], ends)
        return tuple(
            placed
            for guess, size in zip(taken, sizes, strict=True)
            for placed in self.screen.sized(guess.rows, size)
        )

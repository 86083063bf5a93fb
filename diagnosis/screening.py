"""Which effects could explain a residual, by first-order guesses that are cheap.

A signature is linear in the effect's size, so the size that explains most is a
projection; that of two effects together is least squares.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from diagnosis.effect import Placed
from diagnosis.fitting import Coordinates
from diagnosis.plant import Plant
from diagnosis.predictor import Model, Predictor
from diagnosis.signatures import Signature
from diagnosis.trial_values import THRESHOLDS, VECTORS
from groundwalk.arrays import FloatArray

LARGEST_STRETCH = 4.0
"""A signature may be stretched so far before it is no guess any more."""


@dataclass(frozen=True)
class Guess:
    """How much of a residual some effects explain at first order.

    Attributes:
      model: the effects, with the values that explain most.
      gain: reduction of half the squared residual.
    """

    model: Model
    gain: float


class Screen:
    """All signatures side by side: what they explain alone, and two at a time."""

    def __init__(self, predictor: Predictor, found: Sequence[Signature]) -> None:
        """Work out all products of signatures once.

        Args:
          predictor: that the signatures are of.
          found: at least one. Components of a vector effect go together; other
            signatures of one effect and place are alternatives.
        """
        self._predictor, self._found = predictor, list(found)
        self._columns = np.zeros((len(found), len(predictor.scored)), np.float32)
        for row, signature in enumerate(found):
            self._columns[row, signature.rows] = signature.change
        self._products = (self._columns @ self._columns.T).astype(float)
        self._groups = self._grouped()

    def singles(self, residual: FloatArray) -> list[Guess]:
        """The best guess of each effect and place, those that explain most first."""
        wanted = self._wanted(residual)
        best: dict[str, Guess] = {}
        for group in self._groups:
            guess = self._guess(wanted, [group])
            key = self._found[group[0]].placed.key
            if guess and (key not in best or guess.gain > best[key].gain):
                best[key] = guess
        return sorted(best.values(), key=lambda guess: -guess.gain)

    def pairs(self, residual: FloatArray, among: int, count: int) -> list[Guess]:
        """The pairs that explain most together, those that explain most first.

        Args:
          residual: (N,) to be explained.
          among: so many groups are paired with each other: those that explain most
            alone, as each of a pair nearly always explains something.
          count: how many pairs.
        """
        wanted = self._wanted(residual)
        alone = [(self._guess(wanted, [group]), group) for group in self._groups]
        ranked = sorted(
            ((guess.gain, group) for guess, group in alone if guess), reverse=True
        )
        groups = [group for _, group in ranked[:among]]
        best: dict[frozenset[str], Guess] = {}
        for i, first in enumerate(groups):
            for second in groups[:i]:
                keys = frozenset(self._found[g[0]].placed.key for g in (first, second))
                guess = self._guess(wanted, [first, second]) if len(keys) == 2 else None
                if guess and (keys not in best or guess.gain > best[keys].gain):
                    best[keys] = guess
        return sorted(best.values(), key=lambda guess: -guess.gain)[:count]

    def _grouped(self) -> list[list[int]]:
        vectors: dict[tuple[str, tuple[float, ...]], list[int]] = {}
        alone = []
        for row, signature in enumerate(self._found):
            placed = signature.placed
            if placed.effect in VECTORS:
                rest = placed.values[VECTORS[placed.effect] :]
                vectors.setdefault((placed.key, rest), []).append(row)
            elif self._products[row, row] > 0:
                alone.append([row])
        return [*alone, *vectors.values()]

    def _wanted(self, residual: FloatArray) -> FloatArray:
        return np.asarray(-(self._columns @ residual.astype(np.float32)), float)

    def _guess(self, wanted: FloatArray, groups: Sequence[list[int]]) -> Guess | None:
        """Least squares within what is allowed; None if that explains nothing."""
        rows = [row for group in groups for row in group]
        products, target = self._products[np.ix_(rows, rows)], wanted[rows]
        power = np.diag(products).copy()
        ridge = np.diag(1e-9 * power + 1e-12)
        size = np.linalg.solve(products + ridge, target)
        sided = [self._found[row].two_sided for row in rows]
        least = np.where(sided, -LARGEST_STRETCH, 0.0)
        clipped = np.clip(size, least, LARGEST_STRETCH)
        gain = float(clipped @ target - 0.5 * clipped @ products @ clipped)
        if gain <= 0 or (clipped == 0).all():
            return None
        model, first = [], 0
        for group in groups:
            stretch = clipped[first : first + len(group)]
            model.append(self._placed(group, stretch))
            first += len(group)
        return Guess(tuple(model), gain)

    def _placed(self, group: list[int], stretch: FloatArray) -> Placed:
        first = self._found[group[0]].placed
        if first.effect not in VECTORS:
            return stretched(self._predictor.plant, first, float(stretch[0]))
        parts = VECTORS[first.effect]
        every = np.array([self._found[row].placed.values[:parts] for row in group])
        values = (*map(float, stretch @ every), *first.values[parts:])
        return Placed(first.effect, first.place, values)


def stretched(plant: Plant, placed: Placed, stretch: float) -> Placed:
    """The effect that many times as large: its first value, or its components.

    What acts above a threshold only is left as it is.
    """
    parameters = Coordinates(plant, (placed,)).parameters
    if placed.effect in THRESHOLDS:
        return placed
    values = list(placed.values)
    for i in range(VECTORS.get(placed.effect, 1)):
        one = parameters[i]
        value = one.neutral + stretch * (values[i] - one.neutral)
        if not np.isfinite(one.neutral):
            value = values[i] / max(stretch, 1e-3)
        values[i] = min(max(value, one.low), one.high)
    return Placed(placed.effect, placed.place, tuple(values))

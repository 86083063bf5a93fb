"""Which effects could explain a residual, by first-order guesses that are cheap.

An effect's signature is what it changes in the predictions. Servos are stiff, so what
is done at one joint hardly moves the others: an effect is tried at all joints in one
replay, and each joint's own channel is that joint's signature. The guess is linear in
the effect's size, so the size that explains most is a projection.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from diagnosis.effect import Effect, Placed
from diagnosis.fitting import Coordinates
from diagnosis.library import EFFECTS
from diagnosis.plant import Plant
from diagnosis.predictor import Model, Predictor
from diagnosis.trial_values import THRESHOLDS, VECTORS, Interval, trial_values
from diagnosis.usage import Usage
from groundwalk.arrays import FloatArray, IntArray

ALONE = frozenset({"joint_elasticity"})
"""Effects that show at the neighbours more than at their own joint."""

AT_TIPS = frozenset({"external_force", "drag"})
"""Effects that are first tried at the outermost bodies only: there they show most."""

LARGEST_STRETCH = 4.0
"""A signature may be stretched so far before it is no guess any more."""


@dataclass(frozen=True, eq=False)
class Signature:
    """What an effect at a place changes, at first order.

    Attributes:
      placed: the effect, with the values that were tried.
      change: (rows,) of the residual, in units of noise.
      rows: of the residual: all, or the joint's own channel.
      two_sided: whether the effect may be there with the other sign.
    """

    placed: Placed
    change: FloatArray
    rows: IntArray
    two_sided: bool


def signatures(
    predictor: Predictor,
    base: Model,
    usage: Usage,
    intervals: Sequence[Interval] = (),
    names: Sequence[str] = (),
) -> list[Signature]:
    """Signatures of all effects at all their places, seen from a model.

    Args:
      predictor: of the traces.
      base: the model so far.
      usage: of the joints.
      intervals: when something may have pushed.
      names: of the effects; all where empty.
    """
    trials = _trials(predictor, usage, intervals, names or tuple(EFFECTS))
    models = [base, *(base + added for added, _ in trials)]
    residuals = predictor.residuals(models)
    found = []
    for row, (added, joint_wise) in enumerate(trials, start=1):
        change = residuals[row] - residuals[0]
        for placed in added:
            rows = np.arange(len(change))
            if joint_wise:
                own = predictor.channels.of_joint(placed.place)
                rows = np.flatnonzero(np.isin(predictor.channel, own))
            found.append(
                Signature(placed, change[rows], rows, _two_sided(predictor, placed))
            )
    return found


def _trials(
    predictor: Predictor,
    usage: Usage,
    intervals: Sequence[Interval],
    names: Sequence[str],
) -> list[tuple[Model, bool]]:
    """Models to try: an effect at all joints at once, or at one other place."""
    trials: list[tuple[Model, bool]] = []
    for name in names:
        kind = EFFECTS[name]
        places = kind.places(predictor.plant, predictor.traces)
        if name in AT_TIPS:
            places = tuple(p for p in places if p in tips(predictor.plant)) or places
        options = {
            place: _values(predictor, kind, place, usage, intervals) for place in places
        }
        if not any(options.values()):
            continue
        if kind.place_kind == "joint" and name not in ALONE:
            for level in range(max(map(len, options.values()))):
                model = tuple(
                    Placed(name, place, values[level])
                    for place, values in options.items()
                )
                trials.append((model, True))
        else:
            trials += [
                ((Placed(name, place, each),), False)
                for place, values in options.items()
                for each in values
            ]
    return trials


def tips(plant: Plant) -> frozenset[str]:
    """Bodies that carry no other."""
    model = plant.model
    carrying = {int(parent) for parent in model.body_parentid[1:]}
    every = range(1, model.nbody)
    return frozenset(model.body(i).name for i in every if i not in carrying)


def _values(
    predictor: Predictor,
    kind: Effect,
    place: str,
    usage: Usage,
    intervals: Sequence[Interval],
) -> list[tuple[float, ...]]:
    plant = predictor.plant
    column = plant.joints.index(place) if kind.place_kind == "joint" else None
    parameters = kind.parameters(plant, place)
    return trial_values(kind.name, parameters, column, usage, intervals)


def _two_sided(predictor: Predictor, placed: Placed) -> bool:
    """Whether the effect may be there with the other sign."""
    first = Coordinates(predictor.plant, (placed,)).parameters[0]
    return first.low < first.neutral < first.high


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
            return _stretched(self._predictor, first, float(stretch[0]))
        parts = VECTORS[first.effect]
        every = np.array([self._found[row].placed.values[:parts] for row in group])
        values = (*map(float, stretch @ every), *first.values[parts:])
        return Placed(first.effect, first.place, values)


def _stretched(predictor: Predictor, placed: Placed, stretch: float) -> Placed:
    """The effect with its first value that many times as far from neutral."""
    first = Coordinates(predictor.plant, (placed,)).parameters[0]
    if placed.effect in THRESHOLDS:
        return placed
    value = first.neutral + stretch * (placed.values[0] - first.neutral)
    if placed.effect == "joint_elasticity":
        value = placed.values[0] / max(stretch, 1e-3)
    value = min(max(value, first.low), first.high)
    return Placed(placed.effect, placed.place, (value, *placed.values[1:]))

"""Guesses, by linear estimates, which effects could explain a residual.

A signature is the change of the residual by an effect at a place. Servos are stiff, so
that a change at one joint hardly moves the others: an effect is tried at all joints in
one simulation, and the change in each joint's own channels is its signature there.

Signatures are taken as proportional to the effect's size. The size that explains most
of a residual is then a projection, and the sizes of two effects together follow from
linear least squares: thousands of guesses need no further simulation.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from diagnosis.effects.library import all_effects, effect
from diagnosis.effects.parts import Interval, PlacedEffect
from diagnosis.plant.plant import Plant
from diagnosis.residuals.predictor import Model, Predictor
from diagnosis.search.fitting import Coordinates
from diagnosis.traces.usage import Usage
from groundwalk.arrays import FloatArray, IntArray


@dataclass(frozen=True, eq=False)
class Signature:
    """The change of the residual that an effect of a tried size causes at a place.

    Attributes:
      placed: the effect with the values that were tried.
      change: (rows,) change of the residual, in units of noise.
      rows: (rows,) indices into the residual: all, or those of the joint's channels.
      two_sided: whether the effect may also have the opposite sign.
    """

    placed: PlacedEffect
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
    """Simulate effects at all their places, to see how each changes the residual.

    The effects `names`, all if empty, are added to the model `base`, one or one kind at
    a time. The `usage` of the joints sets the sizes that are tried; `intervals` are
    start and duration [s] of possible pushes.
    """
    trials = _trials(predictor, usage, intervals, names or tuple(all_effects()))
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
            # whether its first value may be below and above the neutral one
            first = Coordinates(predictor.plant, (placed,)).parameters[0]
            two_sided = first.low < first.neutral < first.high
            found.append(Signature(placed, change[rows], rows, two_sided))
    return found


def _trials(
    predictor: Predictor,
    usage: Usage,
    intervals: Sequence[Interval],
    names: Sequence[str],
) -> list[tuple[Model, bool]]:
    """Effects to simulate together, and whether these are one kind at all joints."""
    trials: list[tuple[Model, bool]] = []
    for name in names:
        kind = effect(name)
        places = kind.places(predictor.plant, predictor.traces)
        if kind.at_tips:
            places = tuple(p for p in places if p in tips(predictor.plant)) or places
        options = {
            place: kind.first_tries(predictor.plant, place, usage) for place in places
        }
        if kind.timed:
            options = {
                place: [values[:-2] + when for when in intervals for values in tries]
                for place, tries in options.items()
            }
        if not any(options.values()):
            continue
        if kind.place_kind == "joint" and kind.joint_by_joint:
            for level in range(max(map(len, options.values()))):
                model = tuple(
                    PlacedEffect(name, place, values[level])
                    for place, values in options.items()
                )
                trials.append((model, True))
        else:
            trials += [
                ((PlacedEffect(name, place, each),), False)
                for place, values in options.items()
                for each in values
            ]
    return trials


def tips(plant: Plant) -> frozenset[str]:
    """Names of the bodies that carry no other body, such as hands and feet."""
    model = plant.model
    carrying = {int(parent) for parent in model.body_parentid[1:]}
    every = range(1, model.nbody)
    return frozenset(model.body(i).name for i in every if i not in carrying)


SHORT, VECTORS_PAIRED = 200, 20
"""Numbers of the most promising candidates for pairs: of pairs of scalar effects, and
of vector effects (such as forces), each of which is paired with all other effects."""

LARGEST_STRETCH = 4.0
"""Largest factor between the estimated size of an effect and the size simulated."""

TINY, SAME = 1e-9, 1e-5
"""Relative tolerances: one against rounding errors, one for signatures that are linear
combinations of others or of the model's Jacobian."""


@dataclass(frozen=True)
class Guess:
    """Effects that explain a part of a residual, by a linear estimate.

    `gain` is the reduction of half the sum of squared residuals [nats].
    """

    model: Model
    gain: float


@dataclass(frozen=True, eq=False)
class _View:
    """Scalar products of K signatures (changes by effects) with one residual.

    `wanted` (K,) are products with the negative residual, `products` (K, K) those with
    each other. `ridge` is the share of each signature's square that is added to the
    diagonal; `bounded` whether effects with one possible sign must keep it.
    """

    wanted: FloatArray
    products: FloatArray
    ridge: float
    bounded: bool = True


class Screen:
    """Finds the effects, and the pairs of effects, that explain most of a residual."""

    def __init__(self, predictor: Predictor, found: Sequence[Signature]) -> None:
        """Compute the scalar products of all signatures, at least one, once.

        Components of a vector effect are combined; other signatures of one effect and
        place are alternatives.
        """
        self._predictor, self._found = predictor, list(found)
        self._columns = np.zeros((len(found), len(predictor.scored)), np.float32)
        for row, signature in enumerate(found):
            self._columns[row, signature.rows] = signature.change
        self._products = (self._columns @ self._columns.T).astype(float)
        self._groups = self._grouped()

    def singles(
        self, residual: FloatArray, jacobian: FloatArray | None = None
    ) -> list[Guess]:
        """The best guess of each effect and place for a residual (N,) [noise].

        The largest gain comes first. With the Jacobian (N, p) of the model that leaves
        the residual, its values may change when an effect is added, so that two effects
        that nearly cancel each other are found.
        """
        view = self._view(residual, jacobian)
        best: dict[str, Guess] = {}
        for group in self._groups:
            guess = self._guess(view, [group])
            key = self._found[group[0]].placed.key
            if guess and (key not in best or guess.gain > best[key].gain):
                best[key] = guess
        return sorted(best.values(), key=lambda guess: -guess.gain)

    def pairs(self, residual: FloatArray, count: int) -> list[Guess]:
        """The pairs of effects that explain most together, largest gain first.

        Each of two effects that nearly cancel may explain nothing alone. At most
        `count` pairs for a residual (N,) [noise].
        """
        view = self._view(residual)
        best: dict[frozenset[str], Guess] = {}
        for first, second in self._promising(view):
            keys = frozenset(self._found[g[0]].placed.key for g in (first, second))
            guess = self._guess(view, [first, second]) if len(keys) == 2 else None
            if guess and (keys not in best or guess.gain > best[keys].gain):
                best[keys] = guess
        return sorted(best.values(), key=lambda guess: -guess.gain)[:count]

    def _promising(self, view: _View) -> list[tuple[list[int], list[int]]]:
        """Pairs of effects, as groups of signature indices, whose gain to compute."""
        alone = [group for group in self._groups if len(group) == 1]
        rows = np.array([row for group in alone for row in group], int)
        gain = self._gains_together(view, rows)
        most = np.argsort(-gain, axis=None)[:SHORT]
        pairs = [
            (alone[int(i)], alone[int(j)])
            for i, j in zip(*np.unravel_index(most, gain.shape), strict=True)
            if gain[i, j] > 0
        ]
        free = replace(view, bounded=False)
        guesses = [
            (guess.gain, group)
            for group in self._groups
            if len(group) > 1 and (guess := self._guess(free, [group]))
        ]
        for _, vector in sorted(guesses, reverse=True)[:VECTORS_PAIRED]:
            others = [group for group in self._groups if group is not vector]
            pairs += [(vector, other) for other in others]
        return pairs

    def _gains_together(self, view: _View, rows: IntArray) -> FloatArray:
        """(K, K) gains of pairs of K signatures by least squares, above the diagonal.

        0 if an effect would need an impossible sign, or both signatures are
        proportional.
        """
        products, wanted = view.products[np.ix_(rows, rows)], view.wanted[rows]
        power = np.diag(products)
        both = np.outer(power, power)
        rest = both - products**2
        apart = np.triu(rest > SAME * both, 1)
        with np.errstate(divide="ignore", invalid="ignore"):
            size = (wanted[:, None] * power - wanted * products) / rest
        sided = np.array([self._found[row].two_sided for row in rows], bool)
        possible = apart & ((size > 0) | sided[:, None]) & ((size.T > 0) | sided)
        gain = 0.5 * (size * wanted[:, None] + size.T * wanted)
        return np.where(possible, gain, 0.0)

    def _grouped(self) -> list[list[int]]:
        """Indices of signatures, grouped such that vector effects are complete."""
        vectors: dict[tuple[str, tuple[float, ...]], list[int]] = {}
        alone = []
        for row, signature in enumerate(self._found):
            placed = signature.placed
            components = effect(placed.name).components
            if components > 1:
                rest = placed.values[components:]
                vectors.setdefault((placed.key, rest), []).append(row)
            elif self._products[row, row] > 0:
                alone.append([row])
        return [*alone, *vectors.values()]

    def _view(self, residual: FloatArray, jacobian: FloatArray | None = None) -> _View:
        """Scalar products with a residual, less the part in the span of a Jacobian."""
        wanted = -(self._columns @ residual.astype(np.float32)).astype(float)
        if jacobian is None or not jacobian.any():
            return _View(wanted, self._products, TINY)
        basis, size, _ = np.linalg.svd(jacobian, full_matrices=False)
        basis = basis[:, size > SAME * size[0]]
        done = (self._columns @ basis.astype(np.float32)).astype(float)
        wanted = wanted + done @ (basis.T @ residual)
        return _View(wanted, self._products - done @ done.T, SAME)

    def _guess(self, view: _View, groups: Sequence[list[int]]) -> Guess | None:
        """The best allowed sizes of some groups of signatures; None if useless."""
        rows = [row for group in groups for row in group]
        products, target = view.products[np.ix_(rows, rows)], view.wanted[rows]
        ridge = np.diag(view.ridge * np.diag(self._products)[rows] + 1e-12)
        size = np.linalg.solve(products + ridge, target)
        sided = [self._found[row].two_sided or not view.bounded for row in rows]
        least = np.where(sided, -LARGEST_STRETCH, 0.0)
        clipped = np.clip(size, least, LARGEST_STRETCH)
        gain = float(clipped @ target - 0.5 * clipped @ products @ clipped)
        if gain <= 0 or (clipped == 0).all():
            return None
        stretches = np.split(clipped, np.cumsum([len(group) for group in groups])[:-1])
        return Guess(tuple(map(self._placed, groups, stretches)), gain)

    def _placed(self, group: list[int], stretch: FloatArray) -> PlacedEffect:
        """The effect of a group of signatures, with tried sizes times `stretch`."""
        first = self._found[group[0]].placed
        kind = effect(first.name)
        parts = kind.components
        if parts == 1:
            return kind.stretched(self._predictor.plant, first, float(stretch[0]))
        every = np.array([self._found[row].placed.values[:parts] for row in group])
        values = (*map(float, stretch @ every), *first.values[parts:])
        return replace(first, values=values)

"""Guesses, by linear estimates, which effects could explain a residual.

A signature is the change of the residual by an effect at a place. Servos are stiff, so
that a change at one joint hardly moves the others: an effect is tried at all joints in
one simulation, and the change in each joint's own channels is its signature there.

Signatures are taken as proportional to the effect's size. The size that explains most
of a residual is then a projection, and the sizes of two effects together follow from
linear least squares: thousands of guesses need no further simulation.
"""

from collections.abc import Collection, Sequence
from dataclasses import dataclass, replace

import numpy as np

from diagnosis.effects.library import effect
from diagnosis.effects.parts import PlacedEffect, Values
from diagnosis.residuals.predictor import Model, Predictor
from diagnosis.residuals.signatures import Signature
from diagnosis.search.chance import by_chance, independent_blocks, signs
from groundwalk.arrays import FloatArray, IntArray

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

    `gain` is the reduction of half the sum of squared residuals [nats]; `rows` are the
    indices of the signatures from which it was estimated.
    """

    model: Model
    gain: float
    rows: tuple[int, ...] = ()


@dataclass(frozen=True, eq=False)
class View:
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
        return self.singles_in(self._view(residual, jacobian))

    def singles_in(self, view: View) -> list[Guess]:
        """The best guess of each effect and place, the largest gain first."""
        best: dict[str, Guess] = {}
        for group in self._groups:
            guess = self._guess(view, [group])
            key = self._found[group[0]].placed.key
            if guess and (key not in best or guess.gain > best[key].gain):
                best[key] = replace(guess, rows=tuple(group))
        return sorted(best.values(), key=lambda guess: -guess.gain)

    def together(self, view: View, guesses: Sequence[Guess]) -> Guess | None:
        """The best guess of several single effects at once; None if it is useless.

        `guesses` are those of `singles_in` the same view.
        """
        guess = self._guess(view, [list(one.rows) for one in guesses])
        rows = tuple(row for one in guesses for row in one.rows)
        return replace(guess, rows=rows) if guess else None

    def changes(self) -> FloatArray:
        """(N, K) changes of the residual by the effects of all signatures."""
        return self._columns.T.astype(float)

    def bounds(self, rows: Sequence[int]) -> tuple[FloatArray, FloatArray]:
        """(k,) smallest and largest factors of the sizes that were tried."""
        sided = np.array([self._found[row].two_sided for row in rows], bool)
        high = np.full(len(rows), LARGEST_STRETCH)
        return np.where(sided, -high, 0.0), high

    def sized(self, rows: Sequence[int], stretch: FloatArray) -> Model:
        """The effects of k signatures with (k,) multiples of the sizes tried."""
        sizes = dict(zip(rows, stretch, strict=True))
        return tuple(
            self._placed(group, np.array([sizes[row] for row in group]))
            for group in self._groups
            if set(group) <= set(rows)
        )

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

    def shared(
        self, residual: FloatArray, jacobian: FloatArray, keys: Collection[str]
    ) -> Guess | None:
        """The best guess of effects of one kind whose first values are the same.

        `keys` are their "effect@place". None if no common value explains anything, or
        if their size cannot be extrapolated. Arguments as in `singles`.
        """
        view, best = self._view(residual, jacobian), None
        rows = [i for i, one in enumerate(self._found) if one.placed.key in keys]
        tries = dict[str, list[int]]()
        for row in rows:
            tries.setdefault(self._found[row].placed.key, []).append(row)
        for together in zip(*tries.values(), strict=False):
            guess = self._shared(view, together)
            if guess and (best is None or guess.gain > best.gain):
                best = guess
        return best

    def freed(
        self, residual: FloatArray, jacobian: FloatArray, keys: Collection[str]
    ) -> float:
        """Linear estimate of what is gained [nats] by values that differ freely.

        `keys` are "effect@place" of effects that the model of the Jacobian has.
        """
        view = self._view(residual, jacobian)
        first = {
            one.placed.key: row for row, one in reversed([*enumerate(self._found)])
        }
        rows = [first[key] for key in keys if key in first]
        part = np.linalg.pinv(view.products[np.ix_(rows, rows)], SAME, hermitian=True)
        return float(0.5 * view.wanted[rows] @ part @ view.wanted[rows])

    def gain_by_chance(self, residual: FloatArray) -> float:
        """The gain [nats] that the best candidate has by chance in 1 of 100 cases.

        `residual` (N,) is that which a model leaves [noise]: see `chance.py`.
        """
        block = independent_blocks(self._predictor, residual)
        count = int(block.max()) + 1
        parts = np.stack(
            [np.bincount(block, one * residual, count) for one in self._columns]
        )
        wanted = signs(count) @ parts.T
        best = np.zeros(len(wanted))
        for group in self._groups:
            own = wanted[:, group]
            if len(group) == 1 and not self._found[group[0]].two_sided:
                own = np.maximum(own, 0.0)
            products = self._products[np.ix_(group, group)]
            inverse = np.linalg.pinv(products, rcond=SAME, hermitian=True)
            gain = 0.5 * np.einsum("di,ij,dj->d", own, inverse, own)
            best = np.maximum(best, gain)
        return by_chance(best)

    def _shared(self, view: View, rows: Sequence[int]) -> Guess | None:
        """The best allowed common first value of the effects of some signatures."""
        every = [self._found[row].placed for row in rows]
        kind, plant = effect(every[0].name), self._predictor.plant
        neutral = kind.parameters(plant, every[0].place)[0].neutral
        if kind.threshold or not np.isfinite(neutral):
            return None
        # changes for a value that is 1 above the neutral one, and how far each went
        far = np.array([one.values[0] - neutral for one in every])
        share = 1 / far
        wanted = float(share @ view.wanted[list(rows)])
        power = float(share @ view.products[np.ix_(rows, rows)] @ share)
        change = wanted / max(power, TINY)
        if not all(self._found[row].two_sided for row in rows):
            change = max(change * np.sign(far[0]), 0.0) * np.sign(far[0])
        most = LARGEST_STRETCH * float(np.abs(far).max())
        change = min(max(change, -most), most)
        gain = change * wanted - 0.5 * change**2 * power
        if gain <= 0:
            return None
        model = [
            kind.stretched(plant, one, change / (one.values[0] - neutral))
            for one in every
        ]
        return Guess(tuple(model), gain)

    def _promising(self, view: View) -> list[tuple[list[int], list[int]]]:
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

    def _gains_together(self, view: View, rows: IntArray) -> FloatArray:
        """(K, K) gains of pairs of K signatures by least squares, above the diagonal.

        0 if an effect would need an impossible sign, or both signatures are
        proportional.
        """
        products, wanted = view.products[np.ix_(rows, rows)], view.wanted[rows]
        power = np.diag(products)
        both = np.outer(power, power)
        rest = both - products**2
        apart = np.triu(rest > SAME * both, 1)
        size = wanted[:, None] * power - wanted * products
        size = np.divide(size, rest, out=np.zeros_like(rest), where=rest != 0)
        sided = np.array([self._found[row].two_sided for row in rows], bool)
        possible = apart & ((size > 0) | sided[:, None]) & ((size.T > 0) | sided)
        gain = 0.5 * (size * wanted[:, None] + size.T * wanted)
        return np.where(possible, gain, 0.0)

    def _grouped(self) -> list[list[int]]:
        """Indices of signatures, grouped such that vector effects are complete."""
        vectors: dict[tuple[str, str | None, Values], list[int]] = {}
        alone = []
        for row, signature in enumerate(self._found):
            placed = signature.placed
            components = effect(placed.name).components
            if components > 1:
                rest = placed.values[components:]
                same = placed.key, placed.recording, rest
                vectors.setdefault(same, []).append(row)
            elif self._products[row, row] > 0:
                alone.append([row])
        return [*alone, *vectors.values()]

    def _view(self, residual: FloatArray, jacobian: FloatArray | None = None) -> View:
        """Scalar products with a residual, less the part in the span of a Jacobian."""
        wanted = -(self._columns @ residual.astype(np.float32)).astype(float)
        if jacobian is None or not jacobian.any():
            return View(wanted, self._products, TINY)
        basis, size, _ = np.linalg.svd(jacobian, full_matrices=False)
        basis = basis[:, size > SAME * size[0]]
        done = (self._columns @ basis.astype(np.float32)).astype(float)
        wanted = wanted + done @ (basis.T @ residual)
        return View(wanted, self._products - done @ done.T, SAME)

    def _guess(self, view: View, groups: Sequence[list[int]]) -> Guess | None:
        """The best allowed sizes of some groups of signatures; None if useless."""
        rows = [row for group in groups for row in group]
        products, target = view.products[np.ix_(rows, rows)], view.wanted[rows]
        power = np.diag(self._products)[rows]
        # a component that changes nothing, up to rounding, stays small
        ridge = np.diag(view.ridge * power + TINY * power.max() + 1e-12)
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

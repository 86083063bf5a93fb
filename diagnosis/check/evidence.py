"""What recordings would show of each effect, by simulations of the nominal model.

Nothing is fitted: signatures are those of the nominal model, and what a right model
would leave is drawn, as noise and rounding were measured. So what is missing in these
recordings does not change the sizes that they would tell.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from diagnosis.conclude.smallest_sizes import Demand, Smallest, smallest_sizes
from diagnosis.effects.effect import Effect
from diagnosis.effects.library import all_effects, effect
from diagnosis.effects.parts import PlacedEffect
from diagnosis.plant.plant import Plant
from diagnosis.residuals.changes import Changes
from diagnosis.residuals.predictor import Predictor
from diagnosis.residuals.signatures import (
    Signature,
    signatures_apart,
    signatures_of,
    tips,
)
from diagnosis.residuals.small_mismatch.usual_errors import usual_errors
from diagnosis.residuals.tolerance import Tolerance
from diagnosis.search.judging import gain_of_noise
from diagnosis.search.screening import Screen
from diagnosis.traces.usage import Usage
from groundwalk.arrays import FloatArray

Simulated = Callable[[Predictor, Sequence[PlacedEffect]], list[Signature]]
"""How effects are simulated: kinds at all joints together, or each by itself."""

SEED = 20_260_202
"""Seed of the drawn noise: the same recordings always give the same sizes."""

LEAST_S = 1.0
"""Time [s] that is simulated at least of each recording: more than twice that in which
a wrong start state counts."""

APART = 2.0
"""Least factor between two sizes of which it is taken how a change grows with them."""

POWERS = (0.5, 3.0)
"""Smallest and largest power of its size with which what an effect changes may grow; of
play it is 2 or so where noise hides small gaps."""

TINY = 1e-12
"""Smallest gain [nats] that has a logarithm."""

MILDEST = 2
"""Tries of each limit or stop that are simulated, the mildest ones, so that no joint
collapses and takes others along."""


@dataclass(frozen=True, eq=False)
class Evidence:
    """What some motions would show of effects, in units of noise.

    Attributes:
      found: what was tried, with the changes of all entries of a residual.
      unknown: (m, N) changes by one standard deviation of each usual error of a model.
      noise: (N,) residual that a right model would leave, as drawn.
      weight: by how much the recordings are longer than what was simulated of them.
      predictor: simulates them.
    """

    found: tuple[Signature, ...]
    unknown: FloatArray
    noise: FloatArray
    weight: float
    predictor: Predictor

    def beside(self, other: "Evidence") -> "Evidence":
        """With that of other motions, of the same effects in the same order."""
        scale = np.sqrt(other.weight / self.weight)
        joined = [
            _whole(one, np.concatenate([one.change, scale * more.change]))
            for one, more in zip(self.found, other.found, strict=True)
        ]
        unknown = np.hstack([self.unknown, scale * other.unknown])
        noise = np.concatenate([self.noise, other.noise])
        return replace(self, found=tuple(joined), unknown=unknown, noise=noise)

    def part(self, number: int) -> "Evidence":
        """That of one of the predictor's recordings."""
        own = self.predictor.trace == number
        found = tuple(_whole(one, one.change[own]) for one in self.found)
        unknown, noise = self.unknown[:, own], self.noise[own]
        return replace(self, found=found, unknown=unknown, noise=noise)

    def signatures(self) -> list[Signature]:
        """The signatures for the whole length, whitened with small mismatch."""
        longer = np.sqrt(self.weight)
        if not self.found:
            return []
        tolerance = Tolerance(Changes.of(longer * self.unknown))
        changes = longer * np.stack([one.change for one in self.found])
        every = zip(self.found, tolerance.without(changes), strict=True)
        return [_whole(one, change) for one, change in every]

    def demand(self, whitened: Sequence[Signature], rows: int) -> Demand:
        """What effects must gain in recordings of so many rows.

        That is what the best one gains by chance from the drawn noise, whose blocks are
        as long as its correlations last: rounding lasts as long as a joint rests.
        """
        tolerance = Tolerance(Changes.of(self.unknown))
        (left,) = tolerance.without(self.noise[None])
        gain = Screen(self.predictor, whitened).gain_by_chance(left)
        return Demand(max(gain, gain_of_noise(1)), rows)

    def sizes(self, rows: int) -> "Sizes":
        """How large effects must be to be told in recordings of so many rows.

        That size is simulated then, so that it is right for what is not linear, such as
        play, and each effect by itself.
        """
        whitened = self.signatures()
        demand = self.demand(whitened, rows)
        plant = self.predictor.plant
        first = smallest_sizes(plant, whitened, demand)
        again = [one.placed for one in first.values() if _is_scaled(one)]
        keys = {placed.key for placed in again}
        more = _of_whole(self.predictor, again, signatures_apart)
        kept = [one for one in self.found if one.placed.key not in keys]
        found = (*kept, *more)
        unknown = _unknown(self.predictor, found)
        refined = replace(self, found=found, unknown=unknown)
        second = refined.signatures()
        powers = {
            one.placed.key: _power(first[one.placed.key], one)
            for one in second[len(kept) :]
        }
        sizes = smallest_sizes(plant, second, demand, powers)
        return Sizes(sizes, demand, powers, refined)


@dataclass(frozen=True, eq=False)
class Sizes:
    """How large effects must be to be told.

    Attributes:
      smallest: the sizes, by "effect@place".
      demand: what effects must gain.
      powers: the power of its size with which what an effect changes grows.
      evidence: what was simulated, of each scalar effect that in about this size.
    """

    smallest: dict[str, Smallest]
    demand: Demand
    powers: dict[str, float]
    evidence: Evidence

    def with_more(self, other: Evidence) -> dict[str, Smallest]:
        """The sizes if other motions are recorded, too."""
        both = self.evidence.beside(other)
        plant = both.predictor.plant
        return smallest_sizes(plant, both.signatures(), self.demand, self.powers)


def _is_scaled(one: Smallest) -> bool:
    """Whether an effect's size is one number, which may be any."""
    kind = effect(one.placed.name)
    return kind.components == 1 and not kind.threshold


def _power(first: Smallest, again: Signature) -> float:
    """With which power of the size a change grows, by two sizes of it; 1 if unknown."""
    if 1 / APART < first.factor < APART or first.told is None:
        return 1.0
    gain = 0.5 * float(again.change @ again.change)
    grown = 0.5 * np.log(max(gain, TINY) / first.gain) / np.log(first.factor)
    return float(np.clip(grown, *POWERS))


def evidence_of(
    predictor: Predictor,
    tries: Sequence[PlacedEffect],
    weight: float,
    simulated: Simulated = signatures_of,
) -> Evidence:
    """What the recordings of a predictor would show of effects in tried sizes.

    The predictor knows the nominal model's integration error (`correct`), but not what
    wrong start states change.
    """
    predictor.doubt(tolerances=False)
    found = _of_whole(predictor, tries, simulated)
    drawn = predictor.drawn(np.random.default_rng(SEED))
    noise = predictor.residual_of(drawn)
    return Evidence(tuple(found), _unknown(predictor, found), noise, weight, predictor)


def _of_whole(
    predictor: Predictor, tries: Sequence[PlacedEffect], simulated: Simulated
) -> list[Signature]:
    """Signatures of effects, in their order, with changes of all of a residual."""
    order = {id(placed): i for i, placed in enumerate(tries)}
    found = []
    for one in simulated(predictor, tries):
        change = np.zeros(len(predictor.scored))
        change[one.rows] = one.change
        found.append(_whole(one, change))
    return sorted(found, key=lambda one: order[id(one.placed)])


def tries_of(predictor: Predictor) -> list[PlacedEffect]:
    """Effects to try at all their places: those that last, at most two tries of limits.

    What acts for a while only, as a push, has no size that recordings tell: it depends
    on how long it lasts. General forms of other effects, as Stribeck's of dry friction,
    are looked for where these are found.
    """
    plant, traces = predictor.plant, predictor.traces
    usage = Usage.of(plant, traces)
    tries = []
    for name, kind in all_effects().items():
        if kind.timed or _is_general(kind, plant):
            continue
        places = kind.places(plant, traces)
        if kind.at_tips:
            places = tuple(p for p in places if p in tips(plant)) or places
        for place in places:
            every = kind.first_tries(plant, place, usage)
            some = every[:MILDEST] if kind.threshold else every
            tries += [PlacedEffect(name, place, tuple(map(float, v))) for v in some]
    return tries


def _is_general(kind: Effect, plant: Plant) -> bool:
    """Whether an effect contains another one."""
    for name, other in all_effects().items():
        for place in other.places(plant, ())[:1]:
            values = tuple(one.typical for one in other.parameters(plant, place))
            if kind.grown_from(PlacedEffect(name, place, values)):
                return True
    return False


def _unknown(predictor: Predictor, found: Sequence[Signature]) -> FloatArray:
    """(m, N) changes by usual errors, as multiples of what was tried of the effects."""
    plant = predictor.plant
    first: dict[tuple[str, int], Signature] = {}
    for one in found:
        first.setdefault((one.placed.key, _component(plant, one.placed)), one)
    changes = [np.zeros(len(predictor.scored))]
    for unit in usual_errors(plant, predictor.traces):
        i = _component(plant, unit)
        tried = first.get((unit.key, i))
        if tried is not None and plant.base == "fixed":
            parameter = effect(unit.name).parameters(plant, unit.place)[i]
            share = unit.values[i] - parameter.neutral
            share /= tried.placed.values[i] - parameter.neutral
            changes.append(share * tried.change)
    return np.stack(changes)


def _component(plant: Plant, placed: PlacedEffect) -> int:
    """Index of the component of a vector that an effect has; 0 for what is none."""
    size = effect(placed.name).components
    values = placed.values[:size]
    return int(np.argmax(np.abs(values))) if size > 1 else 0


def _whole(one: Signature, change: FloatArray) -> Signature:
    return replace(one, change=change, rows=np.arange(len(change)))

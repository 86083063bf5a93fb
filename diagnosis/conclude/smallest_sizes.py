"""The smallest sizes of effects that recordings would tell.

A signature s is what an effect of a tried size changes in a residual, in units of noise
and whitened with what small mismatch may change: of a signature that usual errors of a
model can make, little is left. An effect that is f times as large changes f^k s, with
k = 1 for effects that are linear. Fitted to a residual, it gains on average

    G(f) = f^(2k) |s|^2 / 2  nats.

It is *seen* where that is what the best candidate gains by chance in 1 of 100 cases,
plus the price of its values. Another effect with the signature r stands for it as well
as it can at the size at which r is nearest to s; it then gains G(f) c^2, where c is the
cosine of the angle between r and s, and 0 if it cannot have that sign. The right one
leads by G(f) (1 - c^2) on the data that are fitted, and in proportion on those that
select. It is *told* where it leads each other effect by what a verdict takes as clear.

Dry friction is a usual error of models, too, but is named wherever it is sure: then it
must stand out from what all other errors may change only, on all data that are learned.
Let q be what is left of one standard deviation of it, squared, beside all errors; then
q / (1 - q) is left beside all others (Sherman and Morrison 1950), as q = r / (1 + r).

With noise, the lead at this size is above that half of the time. A lead of L nats has a
standard deviation of sqrt(2 L): at twice the size L is 40 instead of 10 nats, three
standard deviations above what is demanded.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from diagnosis.conclude.answer import TIED_NATS
from diagnosis.conclude.effect_sizes import (
    SAME,
    least_known,
    least_named,
    scaled,
    size_of,
    unit_of,
)
from diagnosis.conclude.nuisance_found import LITTLE
from diagnosis.effects.library import effect, grown_from
from diagnosis.effects.parts import PlacedEffect
from diagnosis.plant.plant import Plant
from diagnosis.residuals.predictor import Predictor
from diagnosis.residuals.signatures import Signature
from diagnosis.search.judging import price
from diagnosis.verdict import Amount
from groundwalk.arrays import FloatArray


@dataclass(frozen=True)
class Smallest:
    """How large an effect must be for recordings to tell it.

    Attributes:
      placed: the effect in the smallest size that is told; in the largest one possible
        if none is.
      factor: that size as a multiple of the one that was tried.
      gain: what the effect gains [nats] in the size that was tried.
      seen: smallest size at which something is seen to be missing; None if no possible
        one is. For effects that are absent at an infinite value, such as elasticity,
        the largest value instead.
      told: smallest size at which it is told from all others, likewise.
      nearest: the effect from which it is told last; None if no other is like it.
      alike: cosine squared of the two signatures, from 0 to 1.
      usual: whether the size is that of usual errors of models, which are not named.
    """

    placed: PlacedEffect
    factor: float
    gain: float
    seen: Amount | None
    told: Amount | None
    nearest: PlacedEffect | None
    alike: float
    usual: bool = False


@dataclass(frozen=True)
class Demand:
    """What a verdict demands of an effect.

    Attributes:
      gain: gain [nats] that no effect reaches by chance on the data that are fitted.
      rows: rows of the recordings, among which short effects may begin.
      more: information of fitting and selection data together, as a multiple of that of
        the fitting data.
    """

    gain: float
    rows: int
    more: float = 1.5


@dataclass(frozen=True)
class Rival:
    """An effect that may stand for others, rows of its signatures, its price [nats]."""

    placed: PlacedEffect
    rows: tuple[int, ...]
    price: float


def smallest_sizes(
    plant: Plant,
    found: Sequence[Signature],
    demand: Demand,
    powers: Mapping[str, float] | None = None,
) -> dict[str, Smallest]:
    """How large each effect must be to be told, by "effect@place".

    Signatures have been whitened with small mismatch. Of several tries of an effect the
    one counts that shows it at the smallest size. `powers` are exponents k with which
    changes grow with the size, by "effect@place"; 1 if None.
    """
    products = _products_of(found)
    rivals = _rivals_of(found, products)
    cosines = _cosines_squared(found, products, rivals)
    sizes: dict[str, Smallest] = {}
    for row, signature in enumerate(found):
        change = np.asarray(signature.change, float)
        placed, gain = signature.placed, 0.5 * float(change @ change)
        if gain <= 0 or effect(placed.name).timed:
            continue
        k = (powers or {}).get(placed.key, 1.0)
        one = _smallest(
            plant, placed, gain, list(zip(rivals, cosines[row], strict=True)), demand, k
        )
        before = sizes.get(placed.key)
        if before is None or _is_smaller(plant, one, before):
            sizes[placed.key] = one
    return sizes


def smallest_detectable(
    predictor: Predictor, found: Sequence[Signature], gain: float
) -> Mapping[str, Amount]:
    """The size of each effect, by "effect@place", that would just be reported.

    `gain` [nats] is what an effect needs to be reported. Effects that act only above a
    threshold, or whose values are infinite without them, are left out.
    """
    rows = sum(trace.ticks for trace in predictor.traces)
    sizes = smallest_sizes(predictor.plant, found, Demand(gain, rows))
    return {
        key: one.seen
        for key, one in sizes.items()
        if one.seen is not None and _has_size(predictor.plant, one.placed)
    }


def _has_size(plant: Plant, placed: PlacedEffect) -> bool:
    kind = effect(placed.name)
    neutral = kind.parameters(plant, placed.place)[0].neutral
    return not kind.threshold and bool(np.isfinite(neutral))


def _products_of(found: Sequence[Signature]) -> FloatArray:
    """(K, K) products of the changes by K signatures with each other."""
    entries = max((int(one.rows.max()) + 1 for one in found), default=0)
    columns = np.zeros((len(found), entries), np.float32)
    for row, signature in enumerate(found):
        columns[row, signature.rows] = signature.change
    return np.asarray((columns @ columns.T).astype(float))


def _rivals_of(found: Sequence[Signature], products: FloatArray) -> list[Rival]:
    """Effects that may stand for others.

    Components of a vector are together, as they are fitted together. Effects that act
    beyond a threshold or for some time are none: what they change is no multiple of
    what was tried.
    """
    vectors: dict[tuple[object, ...], list[int]] = {}
    for row, signature in enumerate(found):
        kind, placed = effect(signature.placed.name), signature.placed
        if kind.threshold or kind.timed or products[row, row] <= 0:
            continue
        if kind.components > 1:
            key: tuple[object, ...] = placed.key, placed.values[kind.components :]
        else:
            key = placed.key, row
        vectors.setdefault(key, []).append(row)
    return [
        Rival(found[rows[0]].placed, tuple(rows), price((found[rows[0]].placed,), 1))
        for rows in vectors.values()
    ]


def _smallest(
    plant: Plant,
    placed: PlacedEffect,
    own: float,
    rivals: Sequence[tuple[Rival, float]],
    demand: Demand,
    k: float,
) -> Smallest:
    """How large an effect must be whose tried size gains `own` nats.

    The rivals have their cosines squared; k is the power of the size.
    """
    sure = _gain_if_sure(plant, placed, own)
    if sure is not None:
        own, rivals = demand.more * sure, ()
    seen = (demand.gain + price((placed,), demand.rows)) / own
    most, nearest, alike = 0.0, None, 0.0
    general, dearer = {one.key for one in grown_from(placed)}, price((placed,), 1)
    for other, cosine in rivals:
        if other.placed.key == placed.key or other.placed.key in general:
            continue
        lead = max(TIED_NATS + dearer - other.price, 0.0)
        wanted = lead / (own * max(1 - cosine, SAME) * demand.more)
        if wanted > most:
            most, nearest, alike = wanted, other.placed, float(cosine)
    named = [float(one ** (0.5 / k)) for one in (seen, max(seen, most))]
    usual = least_named(plant, placed)
    factors = [max(one, usual, least_known(plant, placed)) for one in named]
    largest, unit = scaled(plant, placed, factors[1]), unit_of(plant, placed)
    shown, told = (
        None if (size := size_of(plant, placed, factor)) is None else Amount(size, unit)
        for factor in factors
    )
    is_usual = told is not None and named[1] < usual
    return Smallest(largest, factors[1], own, shown, told, nearest, alike, is_usual)


def _gain_if_sure(plant: Plant, placed: PlacedEffect, gain: float) -> float | None:
    """What dry friction gains [nats] beside all other usual errors; None of others.

    `gain` is that beside all errors, its own kind included. Its size is never known
    better than the simulation stops joints.
    """
    kind = effect(placed.name)
    spread = kind.spread(plant, placed.place)
    if not (kind.jumps and spread):
        return None
    first = kind.parameters(plant, placed.place)[0]
    deviations = (placed.values[0] - first.neutral) / spread
    left = 2 * gain / deviations**2
    most = 1 / LITTLE**2
    beside_others = most if left >= most / (1 + most) else left / (1 - left)
    return 0.5 * deviations**2 * beside_others


def _cosines_squared(
    found: Sequence[Signature], products: FloatArray, rivals: Sequence[Rival]
) -> FloatArray:
    """(K, rivals) shares of signatures' squares that rivals in their best size explain.

    0 where a rival would need a sign that is impossible.
    """
    power = np.maximum(np.diag(products), np.finfo(float).tiny)
    sided = np.array([one.two_sided for one in found], bool)
    cosines = np.zeros((len(found), len(rivals)))
    for number, one in enumerate(rivals):
        rows = list(one.rows)
        wanted = products[:, rows]
        if len(rows) == 1:
            possible = sided | sided[rows[0]] | (wanted[:, 0] > 0)
            own = np.where(possible, wanted[:, 0] ** 2 / power[rows[0]], 0.0)
        else:
            inverse = np.linalg.pinv(products[np.ix_(rows, rows)], SAME, hermitian=True)
            own = np.einsum("ki,ij,kj->k", wanted, inverse, wanted)
        cosines[:, number] = np.clip(own / power, 0.0, 1.0)
    return cosines


def _is_smaller(plant: Plant, one: Smallest, other: Smallest) -> bool:
    """Whether one try of an effect shows it at a smaller size than another one."""
    kind = effect(one.placed.name)
    neutral = kind.parameters(plant, one.placed.place)[0].neutral
    milder = -1.0 if kind.threshold or not np.isfinite(neutral) else 1.0
    values = [
        np.inf if each is None else milder * each.value
        for each in (one.told, other.told, one.seen, other.seen)
    ]
    return (values[0], values[2]) < (values[1], values[3])

"""The size of an effect: how it is scaled, and from which on it can be told."""

from dataclasses import replace

import numpy as np

from diagnosis.effects.library import effect
from diagnosis.effects.parts import Parameter, PlacedEffect
from diagnosis.plant.plant import Plant
from diagnosis.residuals.small_mismatch.usual_errors import USUAL, far_of, value_at

SAME = 1e-6
"""Share of a size, or of a signature's square, below which what differs is rounding."""


def scaled(plant: Plant, placed: PlacedEffect, factor: float) -> PlacedEffect:
    """The effect `factor` times as large, as far as it may be.

    All values that say how large it is are scaled. One that acts beyond a threshold is
    returned unchanged.
    """
    kind = effect(placed.name)
    if kind.threshold:
        return placed
    every = kind.parameters(plant, placed.place)
    names = kind.main_parameters or [one.name for one in every[: kind.components]]
    values = list(placed.values)
    for i, one in enumerate(every):
        if one.name in names:
            finite = np.isfinite(one.neutral)
            far = factor * (values[i] - one.neutral) if finite else 0.0
            value = one.neutral + far if finite else values[i] / max(factor, SAME)
            values[i] = float(min(max(value, one.low), one.high))
    return replace(placed, values=tuple(values))


def size_of(plant: Plant, placed: PlacedEffect, factor: float) -> float | None:
    """The size of the effect `factor` times as large; None if it cannot be as large.

    That is how far its first value is from the neutral one; of a vector its length; of
    an effect that is absent at an infinite value, and of one with a threshold, the
    value itself. The latter was tried at one size only, which is enough or not.
    """
    kind = effect(placed.name)
    first = kind.parameters(plant, placed.place)[0]
    if kind.threshold:
        return abs(placed.values[0]) if factor <= 1 else None
    sized = scaled(plant, placed, factor)
    if _is_largest(first, factor, placed.values[0], sized.values[0]):
        return None
    if kind.components > 1:
        return float(np.linalg.norm(sized.values[: kind.components]))
    if not np.isfinite(first.neutral):
        return abs(sized.values[0])
    return abs(sized.values[0] - first.neutral)


def _is_largest(first: Parameter, factor: float, tried: float, value: float) -> bool:
    """Whether a value that was tried, times a factor, is more than is possible."""
    if not np.isfinite(first.neutral):
        return tried / factor < first.low
    wanted = first.neutral + factor * (tried - first.neutral)
    return abs(wanted - value) > SAME * abs(wanted - first.neutral)


def unit_of(plant: Plant, placed: PlacedEffect) -> str:
    """The unit of an effect's size at its place."""
    first = effect(placed.name).parameters(plant, placed.place)[0]
    return plant.unit(first.unit, placed.place)


def least_named(plant: Plant, placed: PlacedEffect) -> float:
    """Multiple of the effect's size up to which it is a usual error of a model.

    0 if no size is.
    """
    kind = effect(placed.name)
    first = kind.parameters(plant, placed.place)[0]
    spread, size = kind.spread(plant, placed.place), size_of(plant, placed, 1.0)
    if not (spread and size) or kind.jumps:  # dry friction is missing, however little
        return 0.0
    way = np.sign(far_of(first, placed.values[0])) or 1.0
    most = abs(value_at(first, float(way) * USUAL * spread) - first.neutral)
    return most / size


def least_known(plant: Plant, placed: PlacedEffect) -> float:
    """Multiple of the effect's size below which it lies within what models leave out.

    0 if no size does, see `Effect.faintest`.
    """
    kind = effect(placed.name)
    least, size = kind.faintest(plant, placed.place), size_of(plant, placed, 1.0)
    if least is None or not size:
        return 0.0
    finite = np.isfinite(kind.parameters(plant, placed.place)[0].neutral)
    return least / size if finite else size / least

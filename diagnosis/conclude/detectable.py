"""The smallest effects that some data could have shown."""

from collections.abc import Mapping, Sequence

import numpy as np

from diagnosis.effects.library import effect
from diagnosis.residuals.predictor import Predictor
from diagnosis.search.fitting import Coordinates
from diagnosis.search.signatures import Signature
from diagnosis.verdict.verdict import Amount


def smallest_detectable(
    predictor: Predictor, found: Sequence[Signature], gain: float
) -> Mapping[str, Amount]:
    """By "effect@place" the size whose gain would just be believed.

    A signature is linear in the effect's size, so its gain is quadratic in it. Effects
    that act above a threshold only have no such size.

    Args:
      predictor: of the data.
      found: signatures of the effects.
      gain: that is asked for.
    """
    sizes: dict[str, Amount] = {}
    for signature in found:
        placed = signature.placed
        power = 0.5 * float(signature.change @ signature.change)
        if effect(placed.name).threshold or power <= 0:
            continue
        first = Coordinates(predictor.plant, (placed,)).parameters[0]
        if not np.isfinite(first.neutral):
            continue
        tried = max(abs(value) for value in placed.values[:1])
        size = abs(tried - first.neutral) or max(map(abs, placed.values))
        least = size * float(np.sqrt(gain / power))
        if placed.key not in sizes or least < sizes[placed.key].value:
            sizes[placed.key] = Amount(
                least, predictor.plant.unit(first.unit, placed.place)
            )
    return sizes

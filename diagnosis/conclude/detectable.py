"""The smallest effects that the recordings could have shown."""

from collections.abc import Mapping, Sequence

import numpy as np

from diagnosis.effects.library import effect
from diagnosis.residuals.predictor import Predictor
from diagnosis.search.fitting import Coordinates
from diagnosis.search.signatures import Signature
from diagnosis.verdict import Amount


def smallest_detectable(
    predictor: Predictor, found: Sequence[Signature], gain: float
) -> Mapping[str, Amount]:
    """The size of each effect, by "effect@place", that would just be reported.

    The change of the residual by an effect (its signature) is taken as proportional to
    the effect's size, hence the gain grows with the square of the size. Effects that
    act only above a threshold are left out.

    Args:
      predictor: predictor of the data.
      found: signatures of the effects.
      gain: gain [nats] that an effect needs to be reported.
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
            unit = predictor.plant.unit(first.unit, placed.place)
            sizes[placed.key] = Amount(least, unit)
    return sizes

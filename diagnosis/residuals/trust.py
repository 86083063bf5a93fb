"""Weights of recordings in which models leave more than in most.

No model of a real robot is exact, and it is less so in some motions than in others: in
very fast ones servos saturate and clocks matter. A few such recordings would decide all
values. So what is left in them counts in units of what is left there.
"""

from collections.abc import Mapping, Sequence

import numpy as np

from groundwalk.arrays import FloatArray

Trust = Mapping[str, FloatArray]
"""By the names of recordings (c,) weights of the channels' residuals, at most 1."""

FEWEST = 3
"""Fewest recordings of which most can be told from a few."""


def trust_of(parts: Sequence[Mapping[str, FloatArray]]) -> Trust:
    """Weights of recordings by what a model leaves in parts of them.

    Each part has by the names of its recordings (2, c) sums of squares and numbers of
    entries, in units of noise. The recording in the middle, and all that leave less,
    count in full.
    """
    names = list(dict.fromkeys(name for part in parts for name in part))
    if len(names) < FEWEST:
        return {}
    sums = np.stack([sum(part.get(name, 0.0) for part in parts) for name in names])
    left = np.sqrt(sums[:, 0] / np.maximum(sums[:, 1], 1.0))
    usual = np.maximum(np.median(left, axis=0), 1.0)
    weights = np.minimum(usual / np.maximum(left, 1e-12), 1.0)
    return dict(zip(names, weights, strict=True))

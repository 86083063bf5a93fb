"""Makes random generators from seeds."""

import numpy as np

from groundwalk.errors import BadValueError

Seed = int | np.random.SeedSequence


def generator_of(seed: Seed) -> np.random.Generator:
    """Make a PCG64 generator from a seed; the same seed gives the same numbers.

    Args:
      seed: a whole number of 0 or more, or a NumPy `SeedSequence`; it is not changed.

    Raises:
      BadValueError: the seed is neither.
    """
    if not isinstance(seed, np.random.SeedSequence):
        seed = np.random.SeedSequence(checked_seed(seed))
    return np.random.Generator(np.random.PCG64(seed))


def checked_seed(seed: object) -> int:
    """Convert a seed to a Python int.

    Raises:
      BadValueError: the seed is no whole number of 0 or more.
    """
    if isinstance(seed, bool) or not isinstance(seed, int | np.integer) or seed < 0:
        raise BadValueError(f"seed must be a whole number of 0 or more, not {seed!r}")
    return int(seed)

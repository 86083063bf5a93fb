"""From a seed to randomness."""

import numpy as np

from groundwalk.errors import BadValueError

Seed = int | np.random.SeedSequence


def generator_of(seed: Seed) -> np.random.Generator:
    """Make the generator that belongs to a seed: PCG64, the same numbers every time.

    Args:
      seed: a whole number of 0 or more, or a seed sequence, which stays as it is.

    Raises:
      BadValueError: the seed is neither.
    """
    if not isinstance(seed, np.random.SeedSequence):
        seed = np.random.SeedSequence(checked_seed(seed))
    return np.random.Generator(np.random.PCG64(seed))


def checked_seed(seed: object) -> int:
    """Return a seed as a plain whole number.

    Raises:
      BadValueError: the seed is no whole number of 0 or more.
    """
    if isinstance(seed, bool) or not isinstance(seed, int | np.integer) or seed < 0:
        raise BadValueError(f"seed must be a whole number of 0 or more, not {seed!r}")
    return int(seed)

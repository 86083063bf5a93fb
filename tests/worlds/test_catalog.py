"""What is fixed for each world, since numbers of earlier evaluations hang on it."""

import pytest

from groundwalk.errors import UnknownNameError
from worlds import WORLDS, kind


def test_each_world_has_a_key_of_its_own_for_seeds_that_never_changes():
    """A further world must not change the random numbers of the others."""
    keys = {name: kind(name).seed_key for name in WORLDS}
    assert (keys["real"], keys["sim"]) == (0, 1)
    assert len(set(keys.values())) == len(keys)


def test_an_unknown_world_brings_the_one_that_is_meant():
    with pytest.raises(UnknownNameError, match="did you mean 'real'"):
        kind("reel")

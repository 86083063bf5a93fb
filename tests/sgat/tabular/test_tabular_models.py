import numpy as np
import pytest

from groundwalk.errors import BadValueError
from sgat.tabular.grounding import NONE, counted_forward_model, inverse_model
from sgat.tabular.mdp import FiniteMdp


def steps(targets):
    """A deterministic world: targets[state][action]; nothing ends."""
    targets = np.asarray(targets)
    states = len(targets)
    return FiniteMdp(np.eye(states)[targets], np.zeros(states), np.zeros(states, bool))


SIM = steps([[1, 2], [1, 0], [0, 0]])


def test_shares_are_the_forward_model():
    counts = np.zeros((3, 2, 3), int)
    counts[0, 1] = [1, 0, 3]
    counts[1, 0] = [2, 2, 0]
    forward = counted_forward_model(counts, SIM)
    np.testing.assert_array_equal(forward[0, 1], [0.25, 0, 0.75])
    np.testing.assert_array_equal(forward[1, 0], [0.5, 0.5, 0])


def test_where_nothing_was_seen_the_sim_is_believed():
    nothing = np.zeros((3, 2, 3), int)
    np.testing.assert_array_equal(counted_forward_model(nothing, SIM), SIM.transition)


def test_what_was_seen_too_rarely_is_not_believed():
    counts = np.zeros((3, 2, 3), int)
    counts[0, 0] = [9, 0, 0]
    counts[0, 1] = [10, 0, 0]
    forward = counted_forward_model(counts, SIM, known_after=10)
    np.testing.assert_array_equal(forward[0], [[0, 1, 0], [1, 0, 0]])


def test_the_inverse_model_names_the_action():
    inverse = inverse_model(SIM)
    np.testing.assert_array_equal(
        inverse, [[NONE, 0, 1], [1, 0, NONE], [0, NONE, NONE]]
    )


def test_a_random_sim_has_no_inverse_model():
    coin = FiniteMdp(np.full((2, 1, 2), 0.5), np.zeros(2), np.zeros(2, bool))
    with pytest.raises(BadValueError, match="deterministic"):
        inverse_model(coin)

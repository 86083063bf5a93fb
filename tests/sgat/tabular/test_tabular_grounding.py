import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from sgat.tabular.grounding import action_transformer, grounded_sim
from sgat.tabular.mdp import FiniteMdp

# From state 0 the actions lead to 1, 2 and 3; state 4 cannot be reached in the sim.
TARGETS = np.array([[1, 2, 3], [1, 1, 1], [2, 2, 2], [3, 3, 3], [4, 4, 4]])
SIM = FiniteMdp(
    np.eye(5)[TARGETS],
    reward=np.array([0.0, 1.0, -1.0, 10.0, 0.0]),
    ends=np.arange(5) > 0,
)


def forward(*rows):
    """The sim's own dynamics but for the three actions of state 0."""
    model = SIM.transition.copy()
    model[0] = rows
    return model


REAL = forward([0, 1, 0, 0, 0], [0, 0, 0.8, 0.2, 0], [0, 0, 1, 0, 0])


def test_sgat_mixes_actions_and_gat_takes_the_likeliest():
    sgat = action_transformer(SIM, REAL, samples=True)[0]
    np.testing.assert_array_equal(sgat, [[1, 0, 0], [0, 0.8, 0.2], [0, 1, 0]])
    gat = action_transformer(SIM, REAL, samples=False)[0]
    np.testing.assert_array_equal(gat, [[1, 0, 0], [0, 1, 0], [0, 1, 0]])


def test_only_the_dynamics_are_grounded():
    grounded = grounded_sim(SIM, REAL, samples=True)
    np.testing.assert_array_equal(grounded.transition, REAL)
    assert grounded.reward is SIM.reward
    assert grounded.ends is SIM.ends
    gat = grounded_sim(SIM, REAL, samples=False)
    np.testing.assert_array_equal(gat.transition[0, 1], [0, 0, 1, 0, 0])


@pytest.mark.parametrize("samples", [True, False])
def test_a_perfect_sim_is_left_alone(samples):
    transformer = action_transformer(SIM, SIM.transition, samples)
    np.testing.assert_array_equal(transformer[0], np.eye(3))
    grounded = grounded_sim(SIM, SIM.transition, samples)
    np.testing.assert_array_equal(grounded.transition, SIM.transition)


def test_next_states_that_the_sim_cannot_reach():
    partly = [0, 0.1, 0.3, 0, 0.6]
    never = [0, 0, 0, 0, 1]
    model = forward(partly, never, never)
    sgat = action_transformer(SIM, model, samples=True)[0]
    np.testing.assert_allclose(sgat, [[0.25, 0.75, 0], [0, 1, 0], [0, 0, 1]])
    gat = action_transformer(SIM, model, samples=False)[0]
    np.testing.assert_array_equal(gat, [[0, 1, 0], [0, 1, 0], [0, 0, 1]])


def test_the_first_of_equally_likely_next_states_is_gats():
    model = forward([0, 0, 0.5, 0.5, 0], [0, 0.4, 0.2, 0.4, 0], [0, 0, 0, 1, 0])
    gat = action_transformer(SIM, model, samples=False)[0]
    np.testing.assert_array_equal(gat.argmax(axis=1), [1, 0, 2])


@given(st.lists(st.floats(0, 1), min_size=9, max_size=9), st.booleans())
def test_sgat_behaves_like_the_real_world_where_the_sim_can(numbers, samples):
    wanted = np.array(numbers).reshape(3, 3) + 1e-3
    wanted /= wanted.sum(axis=1, keepdims=True)
    model = forward(*np.pad(wanted, ((0, 0), (1, 1))))
    transition = grounded_sim(SIM, model, samples).transition
    if samples:
        np.testing.assert_allclose(transition, model, atol=1e-12)
    else:
        np.testing.assert_array_equal(transition[0].max(axis=1), 1)
        np.testing.assert_array_equal(
            transition[0].argmax(axis=1), model[0].argmax(axis=1)
        )

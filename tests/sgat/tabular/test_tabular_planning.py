import itertools

import numpy as np
import pytest

from sgat.tabular.mdp import (
    FiniteMdp,
    action_values,
    expected_return,
    policy_iteration,
    policy_values,
)

COST = 0.25


def ruin(size=10, start=3, win=0.5):
    """Gambler's ruin: steps up with probability `win`, ends at 0 and at `size`."""
    transition = np.zeros((size + 1, 1, size + 1))
    for i in range(1, size):
        transition[i, 0, i + 1], transition[i, 0, i - 1] = win, 1 - win
    transition[0, 0, 0] = transition[size, 0, size] = 1
    reward = np.full(size + 1, -COST)
    reward[size] += 1
    ends = np.isin(np.arange(size + 1), (0, size))
    return FiniteMdp(transition, reward, ends, start)


def ruin_return(size, start, win):
    """Feller: chance of reaching `size`, and mean number of steps."""
    if win == 0.5:
        chance, steps = start / size, start * (size - start)
    else:
        odds = (1 - win) / win
        chance = (1 - odds**start) / (1 - odds**size)
        steps = (start - size * chance) / (1 - 2 * win)
    return chance - COST * steps


def random_world(generator, states=5, actions=3):
    """Two states end; every action may end the episode, so that all policies do."""
    transition = generator.random((states, actions, states)) ** 4
    transition[..., -1] += 0.05 * transition.sum(axis=-1)
    transition /= transition.sum(axis=-1, keepdims=True)
    reward = generator.normal(size=states) - COST
    return FiniteMdp(transition, reward, np.arange(states) >= states - 2)


def corridor(ways):
    """State 0 and the ends 3 and 4 (worth 1 and -10); `ways` are an action's targets.

    1 and 2 lead to each other forever, whatever is done.
    """
    targets = np.array([ways, [2] * len(ways), [1] * len(ways)])
    transition = np.zeros((5, len(ways), 5))
    for state, action in np.ndindex(targets.shape):
        transition[state, action, targets[state, action]] = 1
    transition[3:] = np.eye(5)[3:, np.newaxis]
    reward = np.array([-COST, -COST, -COST, 1.0, -10.0])
    return FiniteMdp(transition, reward, np.arange(5) > 2)


@pytest.mark.parametrize("win", [0.5, 0.45, 0.7])
@pytest.mark.parametrize("start", [1, 3, 9])
def test_returns_are_those_of_the_gamblers_ruin(win, start):
    mdp, nothing = ruin(10, start, win), np.zeros(11, int)
    exact = ruin_return(10, start, win)
    assert expected_return(mdp, nothing, 3000) == pytest.approx(exact, abs=1e-9)
    assert policy_values(mdp, nothing)[start] == pytest.approx(exact, abs=1e-4)
    assert expected_return(mdp, nothing, 5) != pytest.approx(exact, abs=1e-3)


def test_a_policy_that_never_ends_pays_until_it_is_cut():
    mdp = corridor([1])
    policy = np.zeros(5, int)
    assert expected_return(mdp, policy, 400) == pytest.approx(-400 * COST)
    assert policy_values(mdp, policy)[0] < -1e5


@pytest.mark.parametrize("seed", range(20))
def test_no_policy_is_better_than_policy_iterations(seed):
    mdp = random_world(np.random.default_rng(seed))
    every = [
        np.array([*choice, 0, 0]) for choice in itertools.product(range(3), repeat=3)
    ]
    returns = [expected_return(mdp, policy, 2000) for policy in every]
    found = policy_iteration(mdp)
    best = expected_return(mdp, found, 2000)
    assert best == pytest.approx(max(returns), abs=1e-6)
    assert min(returns) < max(returns) - 1e-3
    for start in every[::5]:
        np.testing.assert_array_equal(policy_iteration(mdp, start), found)


@pytest.mark.parametrize(
    ("ways", "best"),
    [
        ([4, 3], 1),  # the good end
        ([1, 4], 1),  # better fall than wander forever
        ([0, 4], 1),  # or stay forever
        ([4, 1, 2], 0),
        ([3, 3], 0),  # of equally good actions the first
        ([4, 3, 3], 1),
        ([1, 2], 0),  # all is lost: the first
    ],
)
def test_what_is_chosen_at_a_crossing(ways, best):
    assert policy_iteration(corridor(ways))[0] == best


def test_nothing_comes_after_an_end():
    mdp = corridor([3, 4])
    mdp.transition[3, 1] = [0, 0, 0, 1, 0]  # would pay again
    mdp.transition[3, 0] = [0, 0, 0, 0, 1]
    policy = policy_iteration(mdp)
    assert list(policy) == [0] * 5
    np.testing.assert_array_equal(policy_values(mdp, policy)[3:], 0)
    np.testing.assert_array_equal(action_values(mdp, np.ones(5))[3:], 0)
    assert expected_return(mdp, policy, 10) == 1

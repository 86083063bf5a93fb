import numpy as np
import pytest

from sgat.tabular.mdp import FiniteMdp, roll_out


def die(sides=6):
    """A throw of a die; action 1 throws a die on which low and high are swapped."""
    states = sides + 1
    reward = np.arange(states, dtype=float)
    transition = np.zeros((states, 2, states))
    transition[1:] = np.eye(states)[1:, np.newaxis]
    transition[0, :, 1:] = 1 / sides
    return FiniteMdp(transition, reward, reward > 0)


def walk(length=4):
    """One step to the right at a time; action 1 stays."""
    states = length + 1
    transition = np.zeros((states, 2, states))
    transition[:, 0] = np.eye(states)[np.minimum(np.arange(states) + 1, length)]
    transition[:, 1] = np.eye(states)
    reward = np.full(states, -0.5)
    return FiniteMdp(transition, reward, np.arange(states) == length)


def luck(seed=1):
    return np.random.default_rng(seed)


def test_a_walk_without_luck():
    done = roll_out(walk(), np.zeros(5, int), 3, luck())
    np.testing.assert_array_equal(done.returns, [-2, -2, -2])
    assert (done.mean, done.standard_error, done.cut) == (-2, 0, 0)
    assert done.counts.sum() == 12
    np.testing.assert_array_equal(done.counts[range(4), 0, range(1, 5)], 3)


def test_episodes_that_do_not_end_are_cut():
    done = roll_out(walk(), np.array([0, 0, 1, 0, 0]), 3, luck(), step_limit=7)
    assert done.cut == 3
    np.testing.assert_array_equal(done.returns, -3.5)
    assert done.counts[2, 1, 2] == 3 * 5


def test_means_and_shares_are_those_of_a_die():
    n = 20_000
    done = roll_out(die(), np.zeros(7, int), n, luck())
    error = np.sqrt(35 / 12 / n)  # variance of a die
    assert done.standard_error == pytest.approx(error, rel=0.02)
    assert done.mean == pytest.approx(3.5, abs=4 * error)
    shares = done.counts[0, 0] / n
    assert shares[0] == 0
    np.testing.assert_allclose(shares[1:], 1 / 6, atol=4 * np.sqrt(5 / 36 / n))


def test_impossible_states_are_never_entered():
    rare = die()
    rare.transition[0, 0] = [0, 0.5, 0, 0, 0, 0.5, 0]
    counts = roll_out(rare, np.zeros(7, int), 5000, luck()).counts
    assert set(np.flatnonzero(counts[0, 0])) == {1, 5}


def test_policies_share_their_luck():
    one = roll_out(die(), np.zeros(7, int), 100, luck())
    other = roll_out(die(), np.ones(7, int), 100, luck())
    np.testing.assert_array_equal(one.returns, other.returns)
    assert (one.returns != roll_out(die(), np.ones(7, int), 100, luck(2)).returns).any()


def two_throws(over):
    """A coin leads to state 1 or 2; from there a die to one of 3 to 8."""
    transition = np.zeros((9, 2, 9))
    transition[0, :, 1:3] = 1 / 2
    transition[1:3, :, 3:] = 1 / 6
    transition[3:] = np.eye(9)[3:, np.newaxis]
    ends = np.arange(9) >= 3
    ends[over] = True
    return FiniteMdp(transition, np.arange(9.0), ends)


@pytest.mark.parametrize("exploration", [0.0, 0.5])
def test_luck_does_not_depend_on_who_else_still_plays(exploration):
    whole, short = (
        roll_out(two_throws(over), np.zeros(9, int), 100, luck(), exploration).returns
        for over in ([], [1])
    )
    still = short != 1
    assert 20 < still.sum() < 80
    np.testing.assert_array_equal(short[still], whole[still])


@pytest.mark.parametrize("number", [0.0, np.nextafter(1.0, 0.0)])
def test_the_most_extreme_luck_leads_to_possible_states(number):
    class Luck:
        def random(self, size):
            return np.full(size, number)

    world = die()
    world.transition[0, 0] = [0, 0.5, 0, 0, 0.5 - 4e-10, 0, 0]  # as if by rounding
    done = roll_out(world, np.zeros(7, int), 1, Luck())
    assert done.returns[0] == (1 if number == 0 else 4)


def test_exploration_tries_every_action_as_often():
    counts = roll_out(die(), np.zeros(7, int), 10_000, luck(), exploration=1.0).counts
    assert counts[0, 1].sum() == pytest.approx(5000, abs=200)
    counts = roll_out(die(), np.zeros(7, int), 10_000, luck(), exploration=0.2).counts
    assert counts[0, 1].sum() == pytest.approx(1000, abs=120)

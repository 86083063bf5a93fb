"""The loop of Algorithm 1 with a policy that is one number."""

import math

import numpy as np
import pytest

from groundwalk.errors import BadValueError
from sgat.grounding_loop import GroundingTools, ground, start
from sgat.transitions import Transitions

SEED = np.random.SeedSequence(1, spawn_key=(4,))


class Shop:
    """Counts what it is asked for; real likes policies near 3, optimising adds 1."""

    def __init__(self):
        self.calls = []

    def rows(self, policy, n, seed):
        value = np.random.default_rng(seed).normal(size=(n, 1))
        policies = np.full((n, 1), float(policy))
        return Transitions(value, policies, value, np.zeros(n))

    def evaluate_real(self, policy, seed):
        self.calls.append(("evaluate", policy))
        return -abs(policy - 3) + 1e-9 * np.random.default_rng(seed).random()

    def collect_real(self, policy, seed):
        self.calls.append(("real", policy))
        return self.rows(policy, 3, seed)

    def collect_sim(self, policy, seed):
        self.calls.append(("sim", policy))
        return self.rows(policy, 5, seed)

    def fit(self, real, sim, seed):
        self.calls.append(("fit", real.n, sim.n))
        return seed

    def optimise(self, transformer, policy, seed):
        self.calls.append(("optimise", policy))
        return policy + 1

    def tools(self):
        names = ("evaluate_real", "collect_real", "collect_sim", "fit", "optimise")
        return GroundingTools(*(getattr(self, name) for name in names))


def run(max_steps=9, min_gain=0.0, policy=1, seed=SEED):
    shop = Shop()
    tools = shop.tools()
    first = start(policy, tools, seed)
    return shop, [first, *ground(first, tools, seed, max_steps, min_gain)]


def test_a_step_is_that_of_the_algorithm():
    shop, _ = run(max_steps=1)
    assert shop.calls == [
        ("evaluate", 1),
        ("real", 1),
        ("sim", 1),
        ("fit", 3, 5),
        ("optimise", 1),
        ("evaluate", 2),
    ]


def test_it_goes_on_while_the_policy_improves_on_real():
    """1, 2, 3, then 4 is worse: the best is 3."""
    _, states = run()
    assert [state.policy for state in states] == [1, 2, 3, 4]
    assert [state.improves for state in states] == [True, True, True, False]
    assert [state.step for state in states] == [0, 1, 2, 3]
    assert [round(state.real_return) for state in states] == [-2, -1, 0, -1]
    assert states[-1].best_policy == 3
    assert states[-1].best_return == states[2].real_return


def test_data_of_all_steps_are_kept():
    shop, states = run()
    assert [call for call in shop.calls if call[0] == "fit"] == [
        ("fit", 3, 5),
        ("fit", 6, 10),
        ("fit", 9, 15),
    ]
    assert states[-1].real.action[:, 0].tolist() == [1] * 3 + [2] * 3 + [3] * 3
    assert states[-1].real.episode.tolist() == [0] * 3 + [1] * 3 + [2] * 3


def test_it_stops_where_it_is_told():
    assert [state.policy for state in run(max_steps=2)[1]] == [1, 2, 3]
    assert [state.policy for state in run(min_gain=1.5)[1]] == [1, 2]
    all_steps = run(max_steps=5, min_gain=-math.inf)[1]
    assert [state.policy for state in all_steps] == [1, 2, 3, 4, 5, 6]
    assert all_steps[-1].best_policy == 3


def test_it_goes_on_from_a_state_as_if_it_had_never_stopped():
    _, whole = run()
    for k in range(3):
        later = list(ground(whole[k], Shop().tools(), SEED, 9))
        assert len(later) == len(whole) - k - 1
        for ours, theirs in zip(later, whole[k + 1 :], strict=True):
            assert ours.real_return == theirs.real_return
            np.testing.assert_array_equal(ours.real.state, theirs.real.state)
            np.testing.assert_array_equal(ours.sim.state, theirs.sim.state)
    assert list(ground(whole[-1], Shop().tools(), SEED, 9)) == []


def test_every_call_has_its_own_seed():
    _, states = run()
    data = states[-1]
    values = [*data.real.state[:, 0], *data.sim.state[:, 0]]
    assert len(set(values)) == len(values)
    assert SEED.n_children_spawned == 0
    other = run(seed=np.random.SeedSequence(2))[1][-1]
    assert (other.real.state != data.real.state).all()


def test_no_steps_are_refused():
    with pytest.raises(BadValueError, match="max_steps"):
        run(max_steps=0)

"""Collected transitions end with the true last state, however envs reset themselves."""

import gymnasium as gym
import numpy as np
import pytest
from falling_env import FallingEnv, half, jumps
from gymnasium.vector import AutoresetMode, SyncVectorEnv
from gymnasium.wrappers import Autoreset, FlattenObservation, TimeLimit
from stable_baselines3.common.monitor import Monitor
from stable_baselines3.common.vec_env import DummyVecEnv

from groundwalk.errors import BadValueError
from sgat.gym import collect
from sgat.transitions import Transitions

LENGTHS = [3, 4, 5, 6]


def rng():
    return np.random.default_rng(1)


def check(transitions):
    """Every step is one that the environment makes, and every end is there."""
    assert jumps(transitions) == 0
    for episode in np.unique(transitions.episode):
        rows = transitions.episode == episode
        number, step, _ = transitions.state[rows].T
        assert len(set(number)) == 1
        assert step.tolist() == [*range(len(step))]


@pytest.mark.parametrize(
    "wrap",
    [
        FallingEnv,
        lambda: FallingEnv(truncates=True),
        lambda: FallingEnv(reuses=True),
        lambda: Monitor(FallingEnv()),
        lambda: Autoreset(FallingEnv()),
        lambda: TimeLimit(FallingEnv(), 4),
    ],
)
def test_one_environment(wrap):
    found = collect(wrap(), half, 21, rng())
    check(found)
    assert found.n == 21
    assert found.action.tolist() == [[0.5]] * 21
    if "TimeLimit" not in str(wrap()):
        assert np.unique(found.episode, return_counts=True)[1].tolist() == [*LENGTHS, 3]


def test_the_defect_would_be_seen():
    """Taking what a self-resetting environment returns for the next state is wrong."""
    envs = SyncVectorEnv([FallingEnv], autoreset_mode=AutoresetMode.SAME_STEP)
    state, _ = envs.reset()
    rows = []
    for _ in range(20):
        after, _, end, _, info = envs.step(half(state))
        truth = info["final_obs"][0] if end[0] else after[0]
        rows.append((state[0].copy(), after[0].copy(), truth))
        state = after
    before, returned, true = (np.array(column) for column in zip(*rows, strict=True))
    action, episode = np.full((20, 1), 0.5), before[:, 0].astype(int)
    assert jumps(Transitions(before, action, true, episode)) == 0
    assert jumps(Transitions(before, action, returned, episode)) == len(LENGTHS)
    theirs = DummyVecEnv([FallingEnv])  # the same in the library that trains policies
    state, jumped = theirs.reset(), 0
    for _ in range(20):
        after, _, end, _ = theirs.step(half(state))
        jumped += bool(end[0]) and after[0, 1] == 0
        state = after
    assert jumped == len(LENGTHS)


def test_actions_are_clipped_in_the_data_too():
    found = collect(FallingEnv(), lambda _: np.array([3.0]), 6, rng())
    assert found.action.tolist() == [[1.0]] * 6
    np.testing.assert_array_equal(found.change[:, 2], 1.0)


def test_the_generator_seeds_the_environment():
    env = gym.make("InvertedPendulum-v5")
    runs = [
        collect(env, lambda _: np.zeros(1), 30, np.random.default_rng(seed)).state
        for seed in (1, 1, 2)
    ]
    np.testing.assert_array_equal(runs[0], runs[1])
    assert (runs[0] != runs[2]).any()


def test_actions_that_are_no_numbers_are_refused():
    class Choice(FallingEnv):
        action_space = gym.spaces.Discrete(2)

    with pytest.raises(BadValueError, match="Box"):
        collect(Choice(), half, 5, rng())
    assert FlattenObservation(FallingEnv()).action_space.shape == (1,)

"""A grounded environment: what passes through, and Gymnasium's own checks."""

import gymnasium as gym
import numpy as np
import pytest
from falling_env import FallingEnv
from gymnasium.utils.env_checker import check_env

from groundwalk.errors import BadValueError
from sgat.gym import GroundedEnv
from sgat.noise import ActionNoise


class Halving:
    """Halves actions, and writes down what it was given."""

    def __init__(self):
        self.seeds, self.states = [], []

    def reset(self, seeds):
        self.seeds.append(seeds)

    def __call__(self, state, action):
        self.states.append(state.copy())
        return action / 2


def noisy(deviation=0.1):
    env = gym.make("InvertedPendulum-v5")
    return GroundedEnv(env, ActionNoise(deviation, [-3.0], [3.0]))


@pytest.mark.filterwarnings("ignore:.*WARN")
@pytest.mark.parametrize("transformer", [Halving(), ActionNoise(0.1, [-3.0], [3.0])])
def test_gymnasium_finds_nothing_wrong(transformer):
    env = gym.make("InvertedPendulum-v5").unwrapped
    check_env(GroundedEnv(env, transformer), skip_render_check=True)


def test_the_environment_gets_the_transformed_action():
    transformer = Halving()
    env = GroundedEnv(FallingEnv(), transformer)
    first, _ = env.reset(seed=1)
    first = first.copy()
    action = np.array([0.8])
    after, reward, *_, info = env.step(action)
    assert after.tolist() == [0, 1, pytest.approx(0.4)]
    assert reward == pytest.approx(-0.16)  # the environment's, for what it was given
    assert info["transformed_action"] == pytest.approx(0.4)
    assert info["transformed_action"].dtype == np.float32
    assert action == 0.8
    env.step(action)
    np.testing.assert_array_equal(transformer.states[0], first[None])
    np.testing.assert_array_equal(transformer.states[1], [[0, 1, np.float32(0.4)]])


def test_the_reward_can_be_made_one_of_the_policys_action():
    def reward_of(reward, action, transformed):
        return reward + transformed[0] ** 2 - action[0] ** 2

    env = GroundedEnv(FallingEnv(), Halving(), reward_of)
    env.reset(seed=1)
    assert env.step(np.array([0.8]))[1] == pytest.approx(-0.64)


def episode(env, seed, steps=15):
    seen = [env.reset(seed=seed)[0]]
    for _ in range(steps):
        observation, _, _, _, info = env.step(np.zeros(1))
        seen.append(np.concatenate([observation, info["transformed_action"]]))
    return np.concatenate(seen)


def test_a_seed_is_the_noises_too():
    one, two = noisy(), noisy()
    np.testing.assert_array_equal(episode(one, 3), episode(two, 3))
    np.testing.assert_array_equal(episode(one, 3), episode(one, 3))
    assert (episode(one, 3) != episode(one, 4)).any()


def test_each_episode_has_new_noise_and_the_seed_gives_them_all():
    one, two = noisy(), noisy()
    first = [episode(one, seed) for seed in (5, None, None)]
    again = [episode(two, seed) for seed in (5, None, None)]
    for a, b in zip(first, again, strict=True):
        np.testing.assert_array_equal(a, b)
    assert (first[1][4:] != first[2][4:]).any()


def test_the_transformers_noise_is_not_the_environments():
    """Both are seeded by the same number, yet they must not be alike."""
    env = noisy(1.0)
    start = env.reset(seed=7)[0]
    noise = [env.step(np.zeros(1))[-1]["transformed_action"][0] for _ in range(4)]
    reset_noise = start / 0.01
    drawn = np.random.default_rng(7).standard_normal(4)
    assert np.abs(np.array(noise) - reset_noise).min() > 1e-3
    assert np.abs(np.array(noise) - drawn).min() > 1e-3


def test_a_transformer_that_does_nothing_changes_nothing():
    """Without noise the wrapper is nothing but the transformer before the env."""
    plain, env = gym.make("InvertedPendulum-v5"), noisy(0.0)
    a, b = plain.reset(seed=2)[0], env.reset(seed=2)[0]
    for _ in range(20):
        np.testing.assert_array_equal(a, b)
        action = np.array([0.1], np.float32)
        a, b = plain.step(action)[0], env.step(action)[0]


def test_spaces_that_are_no_vectors_are_refused():
    class Choice(FallingEnv):
        action_space = gym.spaces.Discrete(2)

    with pytest.raises(BadValueError, match="Box"):
        GroundedEnv(Choice(), Halving())

"""Transitions of a Gymnasium environment, with the true last state of each episode.

An environment that resets itself returns, for an episode's last step, the first
observation of the next episode. That is a jump which does not come from the dynamics: a
model that learned from it would predict too wide a spread where episodes fail.
"""

from collections.abc import Callable
from typing import Any, TypeAlias

import gymnasium as gym
import numpy as np
from gymnasium.spaces import Box

from groundwalk.arrays import FloatArray
from groundwalk.errors import BadValueError
from sgat.transitions import Transitions

Policy = Callable[[FloatArray], FloatArray]
"""A function of an observation (o,) that gives an action (a,)."""
Environment: TypeAlias = gym.Env[FloatArray, FloatArray]


def collect(
    env: Environment, policy: Policy, steps: int, rng: np.random.Generator
) -> Transitions:
    """Run a policy for an exact number of steps, and return the transitions.

    Args:
      env: plain or wrapped. It is reset here after each episode, even if a wrapper
        resets it as well.
      policy: gives the actions; they are clipped to the action space, also in the data.
      steps: number of transitions; the last episode may be incomplete.
      rng: gives the seed of the first episode, from which the others follow.

    Raises:
      BadValueError: the action space is not a Box with one axis.

    Example:
      >>> env = gymnasium.make("InvertedPendulum-v5")
      >>> collect(env, lambda observation: np.zeros(1), 100, np.random.default_rng(1)).n
      100
    """
    low, high = _bounds(env.action_space)
    rows, episode = [], 0
    observation, _ = env.reset(seed=int(rng.integers(2**31)))
    for _ in range(steps):
        before = np.array(observation, float)
        action = np.clip(policy(observation), low, high)
        after, _, terminated, truncated, _ = env.step(action)
        end = bool(terminated or truncated)
        rows.append((before, action.astype(float), np.array(after, float), episode))
        episode += end
        observation = env.reset()[0] if end else after
    state, taken, after, episodes = map(np.array, zip(*rows, strict=True))
    return Transitions(state, taken, after, episodes)


def _bounds(space: gym.Space[Any]) -> tuple[FloatArray, FloatArray]:
    if not isinstance(space, Box) or len(space.shape) != 1:
        raise BadValueError(f"the actions are {space}; they must be a Box of one axis")
    return space.low, space.high

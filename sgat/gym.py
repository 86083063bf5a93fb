"""Gymnasium environments: recording transitions, and transforming actions."""

from collections.abc import Callable
from typing import Any, TypeAlias

import gymnasium as gym
import numpy as np
from gymnasium.spaces import Box

from groundwalk.arrays import FloatArray
from groundwalk.errors import BadValueError
from sgat.transformers.catalogue import Transformer
from sgat.transitions import Transitions

Policy = Callable[[FloatArray], FloatArray]
"""A function of an observation (o,) that gives an action (a,)."""
RewardOf = Callable[[float, FloatArray, FloatArray], float]
"""A function that gives a corrected reward, from the environment's reward, the
policy's action (a,) and the transformed action (a,)."""
Environment: TypeAlias = gym.Env[FloatArray, FloatArray]


def collect(
    env: Environment, policy: Policy, steps: int, rng: np.random.Generator
) -> Transitions:
    """Run a policy for an exact number of steps, and return the transitions.

    An environment that resets itself returns, for an episode's last step, the first
    observation of the next one. Here each episode ends with its true last state.

    Args:
      env: plain or wrapped, with a Box of one axis as action space; reset here after
        each episode, even if a wrapper resets it as well.
      policy: gives the actions; they are clipped to the action space, also in the data.
      steps: number of transitions; the last episode may be incomplete.
      rng: gives the seed of the first episode, from which the others follow.

    Example:
      >>> env = gymnasium.make("InvertedPendulum-v5")
      >>> collect(env, lambda observation: np.zeros(1), 100, np.random.default_rng(1)).n
      100
    """
    space = env.action_space
    if not isinstance(space, Box) or len(space.shape) != 1:
        raise BadValueError(f"the actions are {space}; they must be a Box of one axis")
    rows, episode = [], 0
    observation, _ = env.reset(seed=int(rng.integers(2**31)))
    for _ in range(steps):
        before = np.array(observation, float)
        action = np.clip(policy(observation), space.low, space.high)
        after, _, terminated, truncated, _ = env.step(action)
        end = bool(terminated or truncated)
        rows.append((before, action.astype(float), np.array(after, float), episode))
        episode += end
        observation = env.reset()[0] if end else after
    state, taken, after, episodes = map(np.array, zip(*rows, strict=True))
    return Transitions(state, taken, after, episodes)


Wrapper: TypeAlias = gym.Wrapper[FloatArray, FloatArray, FloatArray, FloatArray]


class GroundedEnv(Wrapper, gym.utils.RecordConstructorArgs):
    """An environment's wrapper that passes each action through an action transformer.

    The transformer sees the observation as the state; `info["transformed_action"]` is
    the action (a,) that the environment was given.

    Example:
      >>> env = GroundedEnv(gymnasium.make("InvertedPendulum-v5"), transformer)
    """

    def __init__(
        self,
        env: Environment,
        transformer: Transformer,
        reward_of: RewardOf | None = None,
    ) -> None:
        """Wrap an environment with Box actions and Box observations of one axis each.

        No other environment may use the transformer; an environment that is made again
        from its `spec` gets a copy. Without `reward_of`, the reward is the
        environment's own, which charges control costs for the transformed action; the
        SGAT paper charges them for the policy's action.
        """
        gym.utils.RecordConstructorArgs.__init__(
            self, transformer=transformer, reward_of=reward_of
        )
        super().__init__(env)
        for space in (env.observation_space, env.action_space):
            if not isinstance(space, Box) or len(space.shape) != 1:
                raise BadValueError(f"a space is {space}; it must be a Box of one axis")
        self._transformer = transformer
        self._reward_of = reward_of
        self._seeds = np.random.SeedSequence()
        self._state = np.empty((1, 0))

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[FloatArray, dict[str, Any]]:
        """Start an episode; environment and transformer both use the seed."""
        if seed is not None:
            self._seeds = np.random.SeedSequence(seed)
        self._transformer.reset(self._seeds.spawn(1))
        observation, info = self.env.reset(seed=seed, options=options)
        self._state = np.array(observation, dtype=float)[None]
        return observation, info

    def step(
        self, action: FloatArray
    ) -> tuple[FloatArray, float, bool, bool, dict[str, Any]]:
        """Advance by one step: the environment gets the transformed action (a,)."""
        asked = np.array(action, dtype=float)
        given = self._transformer(self._state, asked[None])[0]
        given = given.astype(self.env.action_space.dtype)
        observation, reward, terminated, truncated, info = self.env.step(given)
        self._state = np.array(observation, dtype=float)[None]
        if self._reward_of is not None:
            reward = self._reward_of(float(reward), asked, given)
        info = {**info, "transformed_action": given}
        return observation, float(reward), terminated, truncated, info

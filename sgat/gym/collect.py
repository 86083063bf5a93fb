"""Transitions from Gymnasium environments, with the true last state of each episode.

An environment that resets itself answers an episode's last step with the next
episode's first observation. Taken for a next state that is a jump that no dynamics
made, and it teaches a forward model a wide spread just where episodes fail.
"""

from collections.abc import Callable
from typing import Any, TypeAlias

import gymnasium as gym
import numpy as np
from gymnasium.spaces import Box
from gymnasium.vector import AutoresetMode, VectorEnv

from groundwalk.arrays import FloatArray
from groundwalk.errors import BadValueError
from sgat.transitions import Transitions

Policy = Callable[[FloatArray], FloatArray]
"""Observations to actions: (o,) to (a,), or (n, o) to (n, a) for n environments."""
Environment: TypeAlias = gym.Env[FloatArray, FloatArray]
Environments: TypeAlias = VectorEnv[FloatArray, FloatArray, Any]


class _Rows:
    """Transitions of one environment, as they come."""

    def __init__(self) -> None:
        self.state: list[FloatArray] = []
        self.action: list[FloatArray] = []
        self.next_state: list[FloatArray] = []
        self.episode: list[int] = []
        self._episode = 0

    def add(
        self, state: FloatArray, action: FloatArray, next_state: FloatArray, end: bool
    ) -> None:
        """Remember one transition; copies, as environments may reuse their arrays."""
        self.state.append(np.array(state, float))
        self.action.append(np.array(action, float))
        self.next_state.append(np.array(next_state, float))
        self.episode.append(self._episode)
        self._episode += end

    def to_transitions(self) -> Transitions:
        """All of them."""
        return Transitions(
            np.array(self.state),
            np.array(self.action),
            np.array(self.next_state),
            np.array(self.episode),
        )


def collect(
    env: Environment, policy: Policy, steps: int, rng: np.random.Generator
) -> Transitions:
    """Exactly so many steps of one environment.

    Args:
      env: plain or wrapped. Whether or not a wrapper would reset it, it is reset here.
      policy: its actions are clipped to the action space, in the data, too.
      steps: the last episode may be cut off.
      rng: gives the seed of the first episode; the others follow from it.
    """
    low, high = _bounds(env.action_space)
    rows = _Rows()
    observation, _ = env.reset(seed=int(rng.integers(2**31)))
    for _ in range(steps):
        before = np.array(observation, float)
        action = np.clip(policy(observation), low, high)
        after, _, terminated, truncated, _ = env.step(action)
        end = bool(terminated or truncated)
        rows.add(before, action, after, end)
        observation = env.reset()[0] if end else after
    return rows.to_transitions()


def collect_vector(
    envs: Environments, policy: Policy, steps: int, rng: np.random.Generator
) -> Transitions:
    """At least so many transitions of n environments that reset themselves.

    Environments that reset in the same step tell the true last observation in
    `info["final_obs"]`. Those that reset in the next step return it; their step of
    resetting ignores the action and is no transition.

    Args:
      envs: with either mode of automatic reset.
      policy: its actions are clipped to the action space, in the data, too.
      steps: all environments together.
      rng: gives the seed of the first episodes; the others follow from it.
    """
    mode = envs.metadata["autoreset_mode"]
    if mode not in (AutoresetMode.SAME_STEP, AutoresetMode.NEXT_STEP):
        raise BadValueError(f"the environments' reset mode is {mode}; it must be on")
    low, high = _bounds(envs.single_action_space)
    every = [_Rows() for _ in range(envs.num_envs)]
    resetting = np.zeros(envs.num_envs, bool)
    observation, _ = envs.reset(seed=int(rng.integers(2**31)))
    while sum(len(rows.state) for rows in every) < steps:
        before = np.array(observation, float)
        action = np.clip(policy(observation), low, high)
        after, _, terminated, truncated, info = envs.step(action)
        end = terminated | truncated
        for i in np.flatnonzero(~resetting):
            final = end[i] and mode == AutoresetMode.SAME_STEP
            next_state = info["final_obs"][i] if final else after[i]
            every[i].add(before[i], action[i], next_state, bool(end[i]))
        if mode == AutoresetMode.NEXT_STEP:
            resetting = end
        observation = after
    transitions = [rows.to_transitions() for rows in every if rows.state]
    joined = transitions[0]
    for more in transitions[1:]:
        joined = joined.joined(more)
    return joined


def _bounds(space: gym.Space[Any]) -> tuple[FloatArray, FloatArray]:
    if not isinstance(space, Box) or len(space.shape) != 1:
        raise BadValueError(f"the actions are {space}; they must be a Box of one axis")
    return space.low, space.high

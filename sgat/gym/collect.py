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

from groundwalk.arrays import FloatArray
from groundwalk.errors import BadValueError
from sgat.transitions import Transitions

Policy = Callable[[FloatArray], FloatArray]
"""Observations to actions: (o,) to (a,), or (n, o) to (n, a) for n environments."""
Environment: TypeAlias = gym.Env[FloatArray, FloatArray]


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


def _bounds(space: gym.Space[Any]) -> tuple[FloatArray, FloatArray]:
    if not isinstance(space, Box) or len(space.shape) != 1:
        raise BadValueError(f"the actions are {space}; they must be a Box of one axis")
    return space.low, space.high

"""A Gymnasium environment whose every state tells where it is from."""

import gymnasium as gym
import numpy as np
from gymnasium.spaces import Box


class FallingEnv(gym.Env):
    """State (episode, step, sum of actions); ends at a step that differs by episode.

    The first state of an episode is unlike any last one: a jump would be seen.
    """

    observation_space = Box(-1e6, 1e6, (3,), np.float64)
    action_space = Box(-1.0, 1.0, (1,), np.float32)

    def __init__(self, first=0, truncates=False, reuses=False):
        self.episode = first - 1
        self.truncates = truncates
        self.reuses = reuses  # one array for all observations
        self._state = np.zeros(3)

    def reset(self, *, seed=None, options=None):
        super().reset(seed=seed)
        self.episode += 1
        self._state[:] = self.episode, 0, 0
        return self._seen(), {}

    def step(self, action):
        self._state += 0, 1, action[0]
        end = self._state[1] >= 3 + self.episode % 4
        ends = (end and not self.truncates, end and self.truncates)
        return self._seen(), float(-(action[0] ** 2)), *ends, {}

    def _seen(self):
        return self._state if self.reuses else self._state.copy()


def half(observation):
    """A policy: always 0.5."""
    return np.full((*observation.shape[:-1], 1), 0.5)


def jumps(transitions):
    """Transitions that no step of `FallingEnv` makes."""
    right = transitions.change == [0.0, 1.0, 0.5]
    return np.count_nonzero(~right.all(axis=1))

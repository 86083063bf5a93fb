"""Finite Markov decision processes: the smallest worlds that can be grounded."""

from dataclasses import dataclass

import numpy as np

from groundwalk.arrays import BoolArray, FloatArray
from groundwalk.errors import BadValueError

ROUNDING = 1e-9
"""Largest difference of a sum of probabilities from 1 that counts as rounding."""


@dataclass(frozen=True, eq=False)
class FiniteMdp:
    """A finite world with S states, A actions and undiscounted episodes.

    Attributes:
      transition: (S, A, S) probability of each next state. Rows of states that end an
        episode are never used.
      reward: (S,) reward for entering a state, costs of the step included. It is the
        SGAT paper's R(a, s') without the action, which its examples do not need.
      ends: (S,) whether an episode ends in a state.
      start: state in which episodes begin.

    Example:
      >>> stay_or_go = np.array([[[1.0, 0.0], [0.0, 1.0]], [[0.0, 1.0], [0.0, 1.0]]])
      >>> FiniteMdp(stay_or_go, np.array([-1.0, 5.0]), np.array([False, True])).states
      2
    """

    transition: FloatArray
    reward: FloatArray
    ends: BoolArray
    start: int = 0

    def __post_init__(self) -> None:
        """Refuse tables of different sizes, and rows that are no probabilities."""
        states, _, after = shape = self.transition.shape
        if not states == after == len(self.reward) == len(self.ends):
            raise BadValueError(
                f"transition is {shape}, with {len(self.reward)} rewards and "
                f"{len(self.ends)} ends; it must be (states, actions, states)"
            )
        totals = self.transition.sum(axis=-1)
        if self.transition.min() < 0 or np.abs(totals - 1).max() > ROUNDING:
            raise BadValueError("the next states' probabilities must add up to 1")
        if not 0 <= self.start < states:
            raise BadValueError(f"start is {self.start}; it must be below {states}")

    @property
    def states(self) -> int:
        """S, the number of states."""
        return int(self.transition.shape[0])

    @property
    def actions(self) -> int:
        """A, the number of actions in every state."""
        return int(self.transition.shape[1])

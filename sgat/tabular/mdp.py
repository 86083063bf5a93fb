"""Finite Markov decision processes: the smallest worlds that can be grounded."""

from dataclasses import dataclass

import numpy as np

from groundwalk.arrays import BoolArray, FloatArray
from groundwalk.errors import BadValueError

ROUNDING = 1e-9


@dataclass(frozen=True, eq=False)
class FiniteMdp:
    """A finite world: S states, A actions, undiscounted episodes.

    Attributes:
      transition: (S, A, S) probability of each next state. Those of states that end
        an episode are never used.
      reward: (S,) what entering a state pays, any price of the step included. The
        paper's R(a, s') without its first argument, which its tables do not need.
      ends: (S,) whether an episode ends in a state.
      start: the state in which episodes begin.
    """

    transition: FloatArray
    reward: FloatArray
    ends: BoolArray
    start: int = 0

    def __post_init__(self) -> None:
        """Refuse tables that do not fit together, and what are no probabilities."""
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
        """How many states there are."""
        return int(self.transition.shape[0])

    @property
    def actions(self) -> int:
        """How many actions there are in every state."""
        return int(self.transition.shape[1])

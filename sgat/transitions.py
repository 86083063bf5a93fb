"""What was seen of a world's dynamics: states, actions, and what they led to."""

from dataclasses import dataclass
from typing import Self

import numpy as np

from groundwalk.arrays import BoolArray, FloatArray, IntArray
from groundwalk.errors import BadValueError


@dataclass(frozen=True, eq=False)
class Transitions:
    """N transitions (s, a, s') of one or more episodes.

    A next state may be narrower than a state. Its p columns are then the state's
    first p columns one tick later, and the state's further columns are context:
    histories that the models look at but need not predict.

    Attributes:
      state: (N, s).
      action: (N, a).
      next_state: (N, p) with p <= s, what the action led to. At an episode's end it is
        the true last state, never the next episode's first.
      episode: (N,) which episode; the rows of one are consecutive in time.
    """

    state: FloatArray
    action: FloatArray
    next_state: FloatArray
    episode: IntArray

    def __post_init__(self) -> None:
        """Refuse arrays that do not fit each other, and numbers that are none."""
        for name in ("state", "action", "next_state"):
            array = np.asarray(getattr(self, name), dtype=np.float64)
            if array.ndim != 2 or array.shape[0] == 0 or array.shape[1] == 0:
                raise BadValueError(
                    f"{name} has the shape {array.shape}; it must be (N, columns)"
                )
            if not np.isfinite(array).all():
                raise BadValueError(f"{name} holds numbers that are not finite")
            object.__setattr__(self, name, array)
        object.__setattr__(self, "episode", np.asarray(self.episode, dtype=np.intp))
        lengths = {len(self.action), len(self.next_state), self.n}
        if self.episode.shape != (self.n,) or lengths != {self.n}:
            raise BadValueError("states, actions and episodes differ in length")
        if self.outcomes > self.state.shape[1]:
            raise BadValueError("a next state must not be wider than a state")
        runs = 1 + np.count_nonzero(np.diff(self.episode))
        if runs != len(np.unique(self.episode)):
            raise BadValueError("the rows of one episode must be consecutive")

    @property
    def n(self) -> int:
        """How many transitions."""
        return len(self.state)

    @property
    def outcomes(self) -> int:
        """How many columns a next state has."""
        return int(self.next_state.shape[1])

    @property
    def change(self) -> FloatArray:
        """(N, p) how the predicted part of the state changed."""
        return self.next_state - self.state[:, : self.outcomes]

    def joined(self, other: Self) -> "Transitions":
        """These and then the others, whose episodes get new numbers."""
        theirs = other.episode - other.episode.min() + self.episode.max() + 1
        return Transitions(
            np.concatenate([self.state, other.state]),
            np.concatenate([self.action, other.action]),
            np.concatenate([self.next_state, other.next_state]),
            np.concatenate([self.episode, theirs]),
        )

    def subset(self, mask: BoolArray) -> "Transitions":
        """Those of the (N,) mask; what is left of an episode counts as consecutive."""
        return Transitions(
            self.state[mask],
            self.action[mask],
            self.next_state[mask],
            self.episode[mask],
        )

    def split(
        self, share: float, rng: np.random.Generator
    ) -> tuple["Transitions", "Transitions"]:
        """Most of the episodes, and about this share of them held out."""
        held_out = held_out_rows(self.episode, share, rng)
        return self.subset(~held_out), self.subset(held_out)


def held_out_rows(
    episode: IntArray, share: float, rng: np.random.Generator
) -> BoolArray:
    """(N,) rows of a random share of the episodes: at least one, never all.

    Rows of one episode are too alike to be divided.
    """
    names = np.unique(episode)
    if not 0 < share < 1:
        raise BadValueError(f"a share of {share} cannot be held out; give 0 to 1")
    if len(names) < 2:
        raise BadValueError("holding out episodes takes at least two of them")
    count = min(max(round(share * len(names)), 1), len(names) - 1)
    chosen = rng.choice(names, size=count, replace=False)
    return np.isin(episode, chosen)

"""Transitions of a world: states, actions, and the states that they led to."""

from dataclasses import dataclass, replace
from typing import Self

import numpy as np

from groundwalk.arrays import BoolArray, FloatArray, IntArray
from groundwalk.errors import BadValueError


@dataclass(frozen=True, eq=False)
class Transitions:
    """N transitions (s, a, s') of one or more episodes.

    A next state may have fewer columns than a state. Its p columns are then the state's
    first p columns one tick later. The state's other columns are context, such as
    histories, which models see but need not predict.

    Attributes:
      state: (N, s) states before the actions.
      action: (N, a) actions.
      next_state: (N, p) with p <= s, the state after the action. At an episode's end it
        is the true last state, never the first state of the next episode.
      episode: (N,) number of the episode; its rows are consecutive in time.

    Example:
      >>> Transitions(np.zeros((9, 3)), np.zeros((9, 1)), np.ones((9, 3)), [0] * 9).n
      9
    """

    state: FloatArray
    action: FloatArray
    next_state: FloatArray
    episode: IntArray

    def __post_init__(self) -> None:
        """Refuse arrays that do not fit together, and numbers that are not finite."""
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
        """Number of transitions."""
        return len(self.state)

    @property
    def outcomes(self) -> int:
        """p, the number of columns of a next state."""
        return int(self.next_state.shape[1])

    @property
    def change(self) -> FloatArray:
        """(N, p) change of the state's first p columns in one tick."""
        return self.next_state - self.state[:, : self.outcomes]

    def joined(self, other: Self) -> Self:
        """All transitions: these, then those of `other` with new episode numbers."""
        theirs = other.episode - other.episode.min() + self.episode.max() + 1
        other = replace(other, episode=theirs)
        pairs = zip(vars(self).values(), vars(other).values(), strict=True)
        return type(self)(*map(np.concatenate, pairs))

    def subset(self, mask: BoolArray) -> Self:
        """The transitions that a mask (N,) selects, in the same order."""
        return type(self)(*(array[mask] for array in vars(self).values()))

    def split(self, share: float, rng: np.random.Generator) -> tuple[Self, Self]:
        """Transitions to learn from, and those of a random share of episodes, held out.

        The share is between 0 and 1; at least one episode is on either side.
        """
        held_out = held_out_rows(self.episode, share, rng)
        return self.subset(~held_out), self.subset(held_out)


def held_out_rows(
    episode: IntArray, share: float, rng: np.random.Generator
) -> BoolArray:
    """(N,) mask of the rows of a random share of episodes: at least one, never all.

    Whole episodes (their numbers: (N,)) are held out, because rows of the same episode
    are too similar to separate what is learned from what is tested.
    """
    names = np.unique(episode)
    if not 0 < share < 1:
        raise BadValueError(f"a share of {share} cannot be held out; give 0 to 1")
    if len(names) < 2:
        raise BadValueError("holding out episodes takes at least two of them")
    count = min(max(round(share * len(names)), 1), len(names) - 1)
    chosen = rng.choice(names, size=count, replace=False)
    return np.isin(episode, chosen)

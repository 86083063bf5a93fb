"""Finite Markov decision processes, the smallest worlds that can be grounded."""

from dataclasses import dataclass

import numpy as np

from groundwalk.arrays import BoolArray, FloatArray, IntArray
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


STEP_LIMIT = 1000
"""Steps after which an episode is cut, since a policy may never end."""


@dataclass(frozen=True, eq=False)
class TabularRollouts:
    """Results of n episodes in a finite world with S states and A actions.

    Attributes:
      returns: (n,) sum of rewards of each episode.
      cut: number of episodes that were cut at the step limit.
      counts: (S, A, S) number of times that each transition was seen.
    """

    returns: FloatArray
    cut: int
    counts: IntArray

    @property
    def mean(self) -> float:
        """Mean return of the episodes."""
        return float(self.returns.mean())

    @property
    def standard_error(self) -> float:
        """Standard error of the mean return."""
        return float(self.returns.std(ddof=1) / np.sqrt(len(self.returns)))


def roll_out(
    mdp: FiniteMdp,
    policy: IntArray,
    episodes: int,
    generator: np.random.Generator,
    exploration: float = 0.0,
    step_limit: int = STEP_LIMIT,
) -> TabularRollouts:
    """Play episodes of a policy (S,) side by side.

    Two policies whose generators are in the same state share their random numbers: step
    k of episode i uses the same ones whatever happened before, so equal probabilities
    of next states lead to equal next states. `exploration` is the probability, at each
    step, of a random action; episodes are cut after `step_limit` steps.

    Example:
      >>> roll_out(mdp, policy, 100, np.random.default_rng(1)).mean
    """
    chances = mdp.transition.cumsum(axis=-1)
    chances /= chances[..., -1:]  # exactly 1 at the end, above any number drawn
    counts = np.zeros(mdp.transition.size, np.intp)
    returns = np.zeros(episodes)
    playing, state = np.arange(episodes), np.full(episodes, mdp.start)
    for _ in range(step_limit):
        luck = generator.random(episodes)[playing]
        action = policy[state]
        if exploration:
            explores = generator.random(episodes)[playing] < exploration
            other = generator.integers(mdp.actions, size=episodes)[playing]
            action = np.where(explores, other, action)
        after = (chances[state, action] <= luck[:, np.newaxis]).sum(axis=-1)
        seen = np.ravel_multi_index((state, action, after), mdp.transition.shape)
        counts += np.bincount(seen, minlength=counts.size)
        returns[playing] += mdp.reward[after]
        goes_on = ~mdp.ends[after]
        playing, state = playing[goes_on], after[goes_on]
        if not len(playing):
            break
    return TabularRollouts(returns, len(playing), counts.reshape(mdp.transition.shape))

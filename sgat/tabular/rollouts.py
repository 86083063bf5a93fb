"""Many episodes in a finite world at once: their returns and their transitions."""

from dataclasses import dataclass

import numpy as np

from groundwalk.arrays import FloatArray, IntArray
from sgat.tabular.mdp import FiniteMdp

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

"""Finite Markov decision processes: episodes, and planning by policy iteration.

A policy is an array (S,) of actions.
"""

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
      counts: (S, A, S) how often each transition was seen.
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

    Step k of episode i uses the same random numbers whatever happened before, so that
    policies can be compared. `exploration` is the probability of a random action, at
    each step; episodes are cut after `step_limit` steps.
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


GOES_ON = 1 - 1e-7
"""Probability that an episode continues after a step, while planning, so that policies
that never end have a finite value. A return of 100 after 20 steps changes by 2e-4."""

TIE = 1e-8
"""Actions are equally good if their values differ by less than this share of the best
value (or of 1, if that is less than 1)."""


def policy_iteration(mdp: FiniteMdp, policy: IntArray | None = None) -> IntArray:
    """(S,) actions of an optimal policy, by Howard's policy iteration.

    An action changes only if another one is better by more than rounding. Of equally
    good actions the first is taken. Steps should cost something; else never ending can
    be as good as reaching a goal. The result does not depend on the first `policy`.
    """
    if policy is None:
        policy = np.zeros(mdp.states, np.intp)
    while True:
        values = action_values(mdp, policy_values(mdp, policy))
        best = values.max(axis=1)
        slack = TIE * np.maximum(1, np.abs(best))
        stays = values[np.arange(mdp.states), policy] >= best - slack
        if stays.all():
            good = values >= (best - slack)[:, np.newaxis]
            first: IntArray = good.argmax(axis=1)
            return first
        policy = np.where(stays, policy, values.argmax(axis=1))


def policy_values(mdp: FiniteMdp, policy: IntArray) -> FloatArray:
    """(S,) expected sum of rewards from each state on; 0 where episodes end.

    Solves v = P (r + g v): P holds the transition probabilities of the policy's actions
    (S,), r the rewards, and g is `GOES_ON`.
    """
    steps = _steps(mdp, policy)
    system = np.eye(mdp.states) - GOES_ON * steps
    return np.asarray(np.linalg.solve(system, steps @ mdp.reward), np.float64)


def action_values(mdp: FiniteMdp, values: FloatArray) -> FloatArray:
    """(S, A) expected sum of rewards after an action, from the states' values (S,)."""
    after: FloatArray = mdp.transition @ (mdp.reward + GOES_ON * values)
    after[mdp.ends] = 0
    return after


def expected_return(mdp: FiniteMdp, policy: IntArray, step_limit: int) -> float:
    """Exact mean sum of rewards of a policy (S,) in episodes of `step_limit` steps."""
    steps = _steps(mdp, policy)
    now = steps @ mdp.reward
    values = np.zeros(mdp.states)
    for _ in range(step_limit):
        values = now + steps @ values
    return float(values[mdp.start])


def _steps(mdp: FiniteMdp, policy: IntArray) -> FloatArray:
    """(S, S) a policy's transition probabilities; rows of ending states are 0."""
    steps = mdp.transition[np.arange(mdp.states), policy]
    return np.where(mdp.ends[:, np.newaxis], 0, steps)

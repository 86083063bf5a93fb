"""Planning in finite worlds: policy iteration, and the exact value of a policy.

A policy is an array (S,) of actions.
"""

import numpy as np

from groundwalk.arrays import FloatArray, IntArray
from sgat.tabular.mdp import FiniteMdp

GOES_ON = 1 - 1e-7
"""Chance that an episode goes on after any step, while planning.

There is no discounting, so a policy that never ends has no finite value where steps
cost something. This gives it one, of ten million steps: hopeless, yet finite. Policies
that end are hardly touched: a return of 100 after 20 steps changes by 2e-4.
"""

TIE = 1e-8
"""Actions whose values differ by a smaller part than this are equally good."""


def policy_iteration(mdp: FiniteMdp, policy: IntArray | None = None) -> IntArray:
    """An optimal policy (S,), by Howard's policy iteration with exact solves.

    An action changes only where another one is better by more than rounding, so each
    round improves the policy and the search ends. Of equally good actions the first
    counts; steps should cost something, or the first may be to stay forever.

    Args:
      mdp: the world to plan in.
      policy: (S,) where to begin; the first action everywhere by default. The answer
        does not depend on it.
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

    Solves v = P (r + g v), the rows of P being those of the policy's actions.
    """
    steps = _steps(mdp, policy)
    system = np.eye(mdp.states) - GOES_ON * steps
    return np.asarray(np.linalg.solve(system, steps @ mdp.reward), np.float64)


def action_values(mdp: FiniteMdp, values: FloatArray) -> FloatArray:
    """(S, A) value of an action now and values (S,) as they are afterwards."""
    after: FloatArray = mdp.transition @ (mdp.reward + GOES_ON * values)
    after[mdp.ends] = 0
    return after


def expected_return(mdp: FiniteMdp, policy: IntArray, step_limit: int) -> float:
    """Exact expected sum of rewards of an episode from the start, undiscounted.

    Args:
      mdp: the world.
      policy: (S,) actions.
      step_limit: episodes that have not ended are cut after so many steps, which
        makes the sum finite for policies that never end.
    """
    steps = _steps(mdp, policy)
    now = steps @ mdp.reward
    values = np.zeros(mdp.states)
    for _ in range(step_limit):
        values = now + steps @ values
    return float(values[mdp.start])


def _steps(mdp: FiniteMdp, policy: IntArray) -> FloatArray:
    """(S, S) next states under a policy; none from where episodes end."""
    steps = mdp.transition[np.arange(mdp.states), policy]
    return np.where(mdp.ends[:, np.newaxis], 0, steps)

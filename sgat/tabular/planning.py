"""Planning in finite worlds: policy iteration, and the exact value of a policy.

A policy is an array (S,) of actions.
"""

import numpy as np

from groundwalk.arrays import FloatArray, IntArray
from sgat.tabular.mdp import FiniteMdp

GOES_ON = 1 - 1e-7
"""Probability that an episode continues after a step, while planning.

Without discounting, a policy that never ends has no finite value where steps cost
something. With this probability it has one, of ten million steps on average: very
low, but finite. Policies that end are hardly affected: a return of 100 after 20
steps changes by 2e-4."""

TIE = 1e-8
"""Actions are equally good if their values differ by less than this share of the best
value (or of 1, if that is less than 1)."""


def policy_iteration(mdp: FiniteMdp, policy: IntArray | None = None) -> IntArray:
    """(S,) actions of an optimal policy, by Howard's policy iteration.

    An action changes only if another one is better by more than rounding, so each round
    improves the policy and the search ends. Of equally good actions the first is taken.
    Steps should cost something; else never ending can be as good as reaching a goal.
    The result does not depend on the `policy` to start from.

    Example:
      >>> policy_iteration(stay_or_go)
      array([1, 0])
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
    """Exact expected sum of rewards of an episode from the start, undiscounted.

    The policy holds the action in each state (S,). Episodes are cut after `step_limit`
    steps, so that the sum is finite for policies that never end.
    """
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

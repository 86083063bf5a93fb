"""Algorithm 1 of the SGAT paper, with any policy and any way to improve it."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from typing import Generic, TypeVar

import numpy as np

from groundwalk.errors import BadValueError
from sgat.transformers.action_transformer import Transformer
from sgat.transitions import Transitions

P = TypeVar("P")
"""A policy: whatever the caller's functions understand."""


@dataclass(frozen=True)
class GroundingTools(Generic[P]):
    """What a grounding step is made of; every function is given its own seed.

    Attributes:
      evaluate_real: mean return of a policy on real.
      collect_real: transitions of the real world under a policy.
      collect_sim: transitions of the sim under a policy.
      fit: a transformer from all real and all sim transitions so far.
      optimise: a better policy for the sim grounded by the transformer, starting
        from the policy given.
    """

    evaluate_real: Callable[[P, np.random.SeedSequence], float]
    collect_real: Callable[[P, np.random.SeedSequence], Transitions]
    collect_sim: Callable[[P, np.random.SeedSequence], Transitions]
    fit: Callable[[Transitions, Transitions, np.random.SeedSequence], Transformer]
    optimise: Callable[[Transformer, P, np.random.SeedSequence], P]


@dataclass(frozen=True, eq=False)
class GroundingState(Generic[P]):
    """Everything that the loop knows after a step; give it back to go on.

    Attributes:
      step: grounding steps done.
      policy: the newest.
      real_return: of the newest policy.
      best_policy: with the highest return on real so far.
      best_return: of the best policy.
      improves: whether the newest step has raised the best return enough to go on.
      real: all transitions of the real world so far.
      sim: all transitions of the sim so far.
    """

    step: int
    policy: P
    real_return: float
    best_policy: P
    best_return: float
    improves: bool = True
    real: Transitions | None = None
    sim: Transitions | None = None


def start(
    policy: P, tools: GroundingTools[P], seed: np.random.SeedSequence
) -> GroundingState[P]:
    """The state before the first step: a policy and its return on real."""
    value = tools.evaluate_real(policy, _child(seed, 0, 0))
    return GroundingState(0, policy, value, policy, value)


def ground(
    state: GroundingState[P],
    tools: GroundingTools[P],
    seed: np.random.SeedSequence,
    max_steps: int,
    min_gain: float = 0.0,
) -> Iterator[GroundingState[P]]:
    """Grounding steps until the policy no longer improves on real.

    A step's random numbers depend on the seed and the step's number only: going on
    from a state gives the same bits as never having stopped.

    Args:
      state: of `start`, or the last one that this has yielded.
      tools: see there.
      seed: the same as for `start`.
      max_steps: grounding steps in all.
      min_gain: by which a step must raise the best return on real, or it is the last;
        minus infinity takes all steps whatever comes of them.

    Yields:
      The state after each step.
    """
    if max_steps < 1:
        raise BadValueError(f"max_steps is {max_steps}; it must be at least 1")
    while state.step < max_steps and state.improves:
        state = _step(state, tools, seed, min_gain)
        yield state


def _step(
    state: GroundingState[P],
    tools: GroundingTools[P],
    seed: np.random.SeedSequence,
    min_gain: float,
) -> GroundingState[P]:
    seeds = [_child(seed, state.step + 1, k) for k in range(5)]
    real = _joined(state.real, tools.collect_real(state.policy, seeds[0]))
    sim = _joined(state.sim, tools.collect_sim(state.policy, seeds[1]))
    transformer = tools.fit(real, sim, seeds[2])
    policy = tools.optimise(transformer, state.policy, seeds[3])
    value = tools.evaluate_real(policy, seeds[4])
    after = GroundingState(
        state.step + 1,
        policy,
        value,
        state.best_policy,
        state.best_return,
        value > state.best_return + min_gain,
        real,
        sim,
    )
    if value > state.best_return:
        after = replace(after, best_policy=policy, best_return=value)
    return after


def _joined(before: Transitions | None, new: Transitions) -> Transitions:
    return new if before is None else before.joined(new)


def _child(seed: np.random.SeedSequence, *key: int) -> np.random.SeedSequence:
    """A seed of its own, without counting up in the parent as `spawn` does."""
    return np.random.SeedSequence(seed.entropy, spawn_key=(*seed.spawn_key, *key))

"""One grounding step on a Gymnasium environment: data, models, transformers."""

from collections.abc import Callable
from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from experiments.transfer.gym_studies.environments import Domain, Environment
from groundwalk.arrays import FloatArray
from sgat.gym import collect
from sgat.models.transition_models import InverseModel
from sgat.transformers.action_transformer import ActionTransformer
from sgat.transformers.catalogue import KeptTransformer, Transformer, grounding
from sgat.transformers.grounding_base import GroundingData
from sgat.transitions import Transitions

if TYPE_CHECKING:
    from sb3_contrib import TRPO

REAL_EXPLORATION, SIM_EXPLORATION = 0.1, 0.5
"""Shares of random actions while data are collected, in the real world and in the sim,
whose inverse model needs varied actions."""

LOOKED_AT = 500
"""Largest number of real transitions on which transformed actions are measured."""

HELD_OUT = 0.2
"""Share of the data that models do not learn from, but are measured on."""

STRETCH = 50
"""Number of consecutive steps that are held out together."""


def ground(
    model: "TRPO",
    domain: Domain,
    real: tuple[str, float],
    steps: tuple[int, int],
    name: str,
    seed: np.random.SeedSequence,
) -> tuple[Callable[[], KeptTransformer], dict[str, float]]:
    """Collect data in both worlds with a policy of the sim, and fit the models.

    Args:
      model: the policy.
      domain: the environment.
      real: setting and noise of the real world; see `Domain.real`.
      steps: numbers of transitions to collect in the real world and in the sim.
      name: name of a grounding in `sgat.transformers`.
      seed: seed of everything except the policy's own random actions.

    Returns:
      A function that makes a new action transformer from the fitted models, and numbers
      on how good models and transformed actions are, on real data that were held out.
    """
    low, high = domain.bounds()
    of_real, of_sim, of_forward, of_inverse, of_look, of_more = seed.spawn(6)
    seen, held_out = _collect(
        model, domain.real(*real), steps[0], REAL_EXPLORATION, of_real
    )
    tried, spare = _collect(model, domain.sim(), steps[1], SIM_EXPLORATION, of_sim)
    data = GroundingData(seen, tried, low, high, of_inverse, of_forward, of_more)
    transformer = partial(grounding(name).transformer, data)
    one, inverse = transformer(), data.inverse()
    measures = {}
    if isinstance(one, ActionTransformer):
        measures["forward_log_likelihood"] = one.forward.score(held_out)
        measures["inverse_r_squared"] = float(inverse.score(spare).mean())
    measures |= _actions(one, held_out, of_look)
    if isinstance(one, ActionTransformer) and one.noise is not None:
        measures["noise_ratio"] = noise_ratio(one, inverse, held_out, of_look)
    return transformer, measures


def _collect(
    model: "TRPO",
    env: Environment,
    steps: int,
    exploration: float,
    seed: np.random.SeedSequence,
) -> tuple[Transitions, Transitions]:
    """Run a policy; give transitions to learn from, and transitions that are held out.

    A share of its actions, `exploration`, is replaced by uniformly random ones.
    """
    rng = np.random.default_rng(seed)
    env.action_space.seed(int(rng.integers(2**31)))

    def act(observation: FloatArray) -> FloatArray:
        if rng.random() < exploration:
            return np.asarray(env.action_space.sample(), float)
        return np.asarray(model.predict(observation)[0], float)

    return in_stretches(collect(env, act, steps, rng)).split(HELD_OUT, rng)


def in_stretches(transitions: Transitions) -> Transitions:
    """Cut each episode into several of at most `STRETCH` steps.

    Whole episodes are held out, and a cheetah's never end early: without the cuts there
    would be too few of them.
    """
    cut = np.diff(transitions.episode, prepend=transitions.episode[0]) != 0
    rows = np.arange(transitions.n)
    since = rows - np.maximum.accumulate(np.where(cut, rows, 0))
    cut |= since % STRETCH == 0
    return replace(transitions, episode=np.cumsum(cut))


def _actions(
    transformer: Transformer, real: Transitions, seed: np.random.SeedSequence
) -> dict[str, float]:
    """Mean and standard deviation of what a transformer adds, in the action's unit."""
    n = min(LOOKED_AT, real.n)
    transformer.reset(seed.spawn(n))
    asked = real.action[:n]
    less = transformer(real.state[:n], asked) - asked
    return {"action_bias": float(less.mean()), "action_spread": float(less.std())}


def noise_ratio(
    transformer: ActionTransformer,
    inverse: InverseModel,
    real: Transitions,
    seed: np.random.SeedSequence,
) -> float:
    """Noise that a transformer adds to actions, relative to the real world's noise.

    Both are root mean squares. The real world's noise is expressed as actions of the
    sim: the action that leads to the real next state, minus the one that leads to the
    predicted mean. Below 1, the grounded sim is less noisy than the real world. That
    happens if one noise moves several dimensions, but the model samples each dimension
    independently: the inverse model then averages the differences out. The models have
    not seen the transitions; the seed is that of the transformer's noise.
    """
    n = min(LOOKED_AT, real.n)
    state, asked = real.state[:n], real.action[:n]
    transformer.reset(seed.spawn(n))
    meant = transformer.forward.predict(state, asked)
    calm, did = (
        np.clip(inverse.predict(state, there), *transformer.bounds)
        for there in (meant, real.next_state[:n])
    )
    noise = transformer(state, asked) - calm
    return float(np.linalg.norm(noise) / np.linalg.norm(did - calm))

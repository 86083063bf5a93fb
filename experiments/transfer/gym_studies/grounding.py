"""One grounding step on a Gymnasium environment: data, models, transformers."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from experiments.transfer.gym_studies.environments import Domain, Environment
from experiments.transfer.gym_studies.training import exploring
from sgat.gym.collect import collect
from sgat.models.forward_config import ForwardConfig, HeadName
from sgat.models.forward_model import ForwardModel
from sgat.models.inverse_model import InverseModel
from sgat.noise import WhiteNoise
from sgat.transformers.action_transformer import ActionTransformer
from sgat.transitions import Transitions

if TYPE_CHECKING:
    from sb3_contrib import TRPO

REAL_EXPLORATION, SIM_EXPLORATION = 0.1, 0.5
"""Shares of random actions while collecting: the inverse model needs varied ones."""
LOOKED_AT = 500
"""Real transitions on which the transformed actions are measured."""
HELD_OUT = 0.2
STRETCH = 50
"""Steps of an episode that stay together when data are held out."""


@dataclass(frozen=True)
class GroundingConfig:
    """How much data.

    Attributes:
      real_steps: transitions of the real world.
      sim_steps: transitions of the sim.
    """

    real_steps: int
    sim_steps: int


@dataclass(frozen=True, eq=False)
class Grounding:
    """Models of both worlds, and how good they are.

    Attributes:
      transformer: makes a new action transformer.
      measures: of the models, and of the actions that a transformer makes of those in
        real data.
    """

    transformer: Callable[[], ActionTransformer]
    measures: dict[str, float]


def ground(
    model: "TRPO",
    domain: Domain,
    real: tuple[str, float],
    config: GroundingConfig,
    head: HeadName | None,
    seed: np.random.SeedSequence,
) -> Grounding:
    """Collect data in both worlds with a policy, and fit the models.

    Args:
      model: the policy that the sim has taught so far.
      domain: the environment.
      real: setting and noise of the real world.
      config: of the grounding.
      head: the distribution from which SGAT samples the next state; None for GAT,
        which takes the mean of the Gaussian one.
      seed: of everything, but for the policy's own luck.
    """
    low, high = domain.bounds()
    of_real, of_sim, of_forward, of_inverse, of_look = seed.spawn(5)
    seen, held_out = _collect(
        model, domain.real(*real), config.real_steps, REAL_EXPLORATION, of_real
    )
    tried, spare = _collect(
        model, domain.sim(), config.sim_steps, SIM_EXPLORATION, of_sim
    )
    forward = ForwardModel(ForwardConfig(head=head or "gaussian")).fit(seen, of_forward)
    inverse = InverseModel().fit(tried, of_inverse)
    noise = WhiteNoise(forward.outcomes) if head else None

    def transformer() -> ActionTransformer:
        return ActionTransformer(forward, inverse, low, high, noise)

    measures = {
        "forward_log_likelihood": forward.score(held_out),
        "inverse_r_squared": float(inverse.score(spare).mean()),
        **_actions(transformer(), held_out, of_look),
    }
    if head:
        measures["noise_ratio"] = noise_ratio(transformer(), inverse, held_out, of_look)
    return Grounding(transformer, measures)


def _collect(
    model: "TRPO",
    env: Environment,
    steps: int,
    exploration: float,
    seed: np.random.SeedSequence,
) -> tuple[Transitions, Transitions]:
    """Transitions to learn from, and some that are held out."""
    rng = np.random.default_rng(seed)
    policy = exploring(model, env.action_space, exploration, rng)
    return in_stretches(collect(env, policy, steps, rng)).split(HELD_OUT, rng)


def in_stretches(transitions: Transitions) -> Transitions:
    """The same with each episode cut into several of at most `STRETCH` steps.

    A cheetah never falls: it would leave too few episodes to hold some out.
    """
    cut = np.diff(transitions.episode, prepend=transitions.episode[0]) != 0
    rows = np.arange(transitions.n)
    since = rows - np.maximum.accumulate(np.where(cut, rows, 0))
    cut |= since % STRETCH == 0
    return replace(transitions, episode=np.cumsum(cut))


def _actions(
    transformer: ActionTransformer, real: Transitions, seed: np.random.SeedSequence
) -> dict[str, float]:
    """Bias and spread of transformed less asked actions, in the action's units."""
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
    """Noise on a transformer's actions over the noise that real data show, both rms.

    Real's noise is seen as the sim's actions: the one that would have led to what real
    did, less the one for the mean of it. Below 1 the grounded sim is calmer than real.
    A distribution with independent dimensions comes below 1 where one noise moves
    several of them: what they disagree on, the inverse model averages away.

    Args:
      transformer: with noise.
      inverse: its inverse model.
      real: data that the models have not seen.
      seed: of the noise.
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

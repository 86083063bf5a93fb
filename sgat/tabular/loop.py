"""Algorithm 1 of the paper in finite worlds: ground, plan, and again."""

from dataclasses import dataclass

import numpy as np

from groundwalk.arrays import IntArray
from groundwalk.errors import BadValueError
from sgat.tabular.grounding import grounded_sim
from sgat.tabular.mdp import FiniteMdp
from sgat.tabular.models import counted_forward_model
from sgat.tabular.planning import policy_iteration, policy_values
from sgat.tabular.rollouts import roll_out


@dataclass(frozen=True)
class TabularLoop:
    """How the loop of grounding and planning runs.

    Attributes:
      episodes: in the real world at each grounding step; all data is kept.
      exploration: chance of a random action at each of their steps.
      known_after: real transitions of a state and action before they are believed;
        see `counted_forward_model`.
      gain: in the newly grounded sim a policy improves if its return rises by more.
      calm_steps: grounding steps in a row without such a gain end the loop.
      most_steps: grounding steps after which it ends in any case.
    """

    episodes: int = 10_000
    exploration: float = 0.1
    known_after: int = 100
    gain: float = 0.01
    calm_steps: int = 3
    most_steps: int = 100

    def __post_init__(self) -> None:
        """Refuse loops that cannot run."""
        for name in ("episodes", "known_after", "calm_steps", "most_steps"):
            if getattr(self, name) < 1:
                raise BadValueError(
                    f"{name} is {getattr(self, name)}; it must be positive"
                )
        if not 0 <= self.exploration <= 1:
            raise BadValueError(
                f"exploration is {self.exploration}; it must be from 0 to 1"
            )


@dataclass(frozen=True, eq=False)
class Settled:
    """Where the loop came to rest.

    Attributes:
      policy: (S,) the last policy.
      steps: grounding steps that it took.
      transitions: in the real world, of all steps.
      calm: whether it came to rest by itself.
    """

    policy: IntArray
    steps: int
    transitions: int
    calm: bool


def ground_until_calm(
    sim: FiniteMdp,
    real: FiniteMdp,
    samples: bool,
    loop: TabularLoop,
    generator: np.random.Generator,
) -> Settled:
    """Ground the sim with real data and plan in it, until that gains nothing more.

    The inverse model needs no data: one look at each action of a deterministic sim
    shows all of it.

    Args:
      sim: a deterministic simulator; its optimum is the first policy.
      real: the world that episodes are played in; nothing else of it is used.
      samples: SGAT, or GAT; see `grounded_sim`.
      loop: how much data, and when to stop.
      generator: of the real world's luck.
    """
    policy = policy_iteration(sim)
    counts = np.zeros(sim.transition.shape, np.intp)
    calm = step = 0
    while calm < loop.calm_steps and step < loop.most_steps:
        step += 1
        counts += roll_out(
            real, policy, loop.episodes, generator, loop.exploration
        ).counts
        forward = counted_forward_model(counts, sim, loop.known_after)
        grounded = grounded_sim(sim, forward, samples)
        before, policy = policy, policy_iteration(grounded, policy)
        gain = policy_values(grounded, policy) - policy_values(grounded, before)
        calm = 0 if gain[sim.start] > loop.gain else calm + 1
    return Settled(policy, step, int(counts.sum()), calm >= loop.calm_steps)

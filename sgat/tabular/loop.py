"""Algorithm 1 of the SGAT paper in finite worlds: ground, plan, and repeat."""

from dataclasses import dataclass

import numpy as np

from groundwalk.arrays import IntArray
from groundwalk.errors import BadValueError
from sgat.tabular.grounding import counted_forward_model, grounded_sim
from sgat.tabular.mdp import FiniteMdp, roll_out
from sgat.tabular.planning import policy_iteration, policy_values


@dataclass(frozen=True)
class TabularLoop:
    """Settings of the loop of grounding and planning.

    Attributes:
      episodes: real episodes in each grounding step; the data of all steps are kept.
      exploration: probability of a random action at each step of these episodes.
      known_after: least number of real transitions of a state and action with which
        their counted probabilities are used, instead of the sim's.
      gain: a new policy is an improvement if its return in the grounded sim is larger
        by more than this.
      calm_steps: the loop ends after this number of grounding steps in a row without an
        improvement.
      most_steps: the loop ends after this number of grounding steps in any case.
    """

    episodes: int = 10_000
    exploration: float = 0.1
    known_after: int = 100
    gain: float = 0.01
    calm_steps: int = 3
    most_steps: int = 100

    def __post_init__(self) -> None:
        """Refuse counts below 1, and an exploration that is no probability."""
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
    """Result of `ground_until_calm`.

    Attributes:
      policy: (S,) action of the last policy in each of the S states.
      steps: number of grounding steps.
      transitions: number of real transitions in all steps.
      calm: whether the loop ended because nothing improved any more.
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
    """Ground the sim with real data and plan in it, until policies stop improving.

    The inverse model needs no data: a deterministic sim's table contains it.

    Args:
      sim: a deterministic simulator; the loop begins with its optimal policy.
      real: the world in which episodes are played; its table is not used otherwise.
      samples: True for SGAT, False for GAT.
      loop: how much data is collected, and when to stop.
      generator: draws the real world's outcomes.

    Example:
      >>> ground_until_calm(sim, real, True, TabularLoop(), rng).policy
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

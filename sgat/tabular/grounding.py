"""Grounding in finite worlds: models are tables; Algorithm 1 of the SGAT paper."""

import dataclasses
from dataclasses import dataclass

import numpy as np

from groundwalk.arrays import FloatArray, IntArray
from groundwalk.errors import BadValueError
from sgat.tabular.mdp import FiniteMdp, policy_iteration, policy_values, roll_out

NONE = -1
"""Entry of an inverse model's table if no action leads to the next state."""


def counted_forward_model(
    counts: IntArray, sim: FiniteMdp, known_after: int = 1
) -> FloatArray:
    """(S, A, S) probabilities of real next states, from their counts (S, A, S).

    If fewer than `known_after` transitions of a state and action were seen, the sim's
    probabilities are used, which leaves the action as it is (like the known states of
    R-max: Brafman and Tennenholtz 2002).
    """
    seen = counts.sum(axis=-1, keepdims=True)
    shares: FloatArray = np.where(
        seen >= known_after, counts / np.maximum(seen, 1), sim.transition
    )
    return shares


def inverse_model(sim: FiniteMdp) -> IntArray:
    """(S, S) a deterministic sim's action from one state (row) to another (column).

    It is the first one if several lead there, and `NONE` (-1) if none does.
    """
    if not np.isin(sim.transition, (0, 1)).all():
        raise BadValueError("only a deterministic sim has an inverse model")
    leads = sim.transition.astype(bool).transpose(0, 2, 1)
    return np.where(leads.any(axis=-1), leads.argmax(axis=-1), NONE)


def grounded_sim(sim: FiniteMdp, forward: FloatArray, samples: bool) -> FiniteMdp:
    """The simulator behind an action transformer, as a finite world of its own.

    `sim` is deterministic; else BadValueError. `forward` (S, A, S) holds probabilities
    of the real next states, which the transformer samples (SGAT), or of which it takes
    the most likely one (GAT).

    Example:
      >>> sgat = grounded_sim(sim, real.transition, samples=True)
    """
    transformer = action_transformer(sim, forward, samples)
    transition = np.einsum("sab,sbn->san", transformer, sim.transition)
    return dataclasses.replace(sim, transition=transition)


def action_transformer(
    sim: FiniteMdp, forward: FloatArray, samples: bool
) -> FloatArray:
    """(S, A, A) probability that, in a state, an action is replaced by each action.

    The transformer is g(s, a) = f_inv(s, f_real(s, a)), with the real world's forward
    model (`forward`) and the sim's inverse model. If `samples` is False (GAT), f_real
    takes the most likely next state, the first of equally likely ones. Next states that
    no action of the sim leads to cannot be imitated: the probabilities of the other
    ones are scaled up. If none is left, the action stays as it is.
    """
    inverse = inverse_model(sim)
    wanted = np.where((inverse != NONE)[:, np.newaxis], forward, 0)
    if not samples:
        likeliest = wanted.argmax(axis=-1, keepdims=True)
        others = np.arange(sim.states) != likeliest
        wanted = np.where(others, 0, wanted)
    transformer = np.zeros((sim.states, sim.actions, sim.actions))
    state, action, after = np.nonzero(wanted)
    taken = inverse[state, after]
    np.add.at(transformer, (state, action, taken), wanted[state, action, after])
    total = transformer.sum(axis=-1, keepdims=True)
    unchanged = np.eye(sim.actions)
    return np.where(total > 0, transformer / np.where(total > 0, total, 1), unchanged)


@dataclass(frozen=True)
class TabularLoop:
    """Settings of the loop of grounding and planning.

    Attributes:
      episodes: real episodes in each grounding step; the data of all steps are kept.
      exploration: probability of a random action at each step of these episodes.
      known_after: least number of real transitions of a state and action with which
        their counted probabilities are used, instead of the sim's.
      gain: least improvement of the return in the grounded sim that counts as one.
      calm_steps: grounding steps in a row without an improvement that end the loop.
      most_steps: largest number of grounding steps.
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
            value = getattr(self, name)
            if value < 1:
                raise BadValueError(f"{name} is {value}; it must be positive")
        if not 0 <= self.exploration <= 1:
            raise BadValueError(
                f"exploration is {self.exploration}; it must be from 0 to 1"
            )


@dataclass(frozen=True, eq=False)
class Settled:
    """Result of `ground_until_calm`.

    Attributes:
      policy: (S,) action of the last policy in each state.
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
    """Ground a deterministic sim and plan in it, until policies stop improving.

    This is Algorithm 1 of the SGAT paper (GAT's, if `samples` is False). It begins with
    the sim's optimal policy; `real` serves only to play episodes.
    """
    policy = policy_iteration(sim)
    counts = np.zeros(sim.transition.shape, np.intp)
    calm = step = 0
    while calm < loop.calm_steps and step < loop.most_steps:
        step += 1
        played = roll_out(real, policy, loop.episodes, generator, loop.exploration)
        counts += played.counts
        forward = counted_forward_model(counts, sim, loop.known_after)
        grounded = grounded_sim(sim, forward, samples)
        before, policy = policy, policy_iteration(grounded, policy)
        gain = policy_values(grounded, policy) - policy_values(grounded, before)
        calm = 0 if gain[sim.start] > loop.gain else calm + 1
    return Settled(policy, step, int(counts.sum()), calm >= loop.calm_steps)

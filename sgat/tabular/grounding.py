"""Grounding in finite worlds: models, and grounded simulators, are tables."""

import dataclasses

import numpy as np

from groundwalk.arrays import FloatArray, IntArray
from groundwalk.errors import BadValueError
from sgat.tabular.mdp import FiniteMdp

NONE = -1
"""Entry of an inverse model's table if no action leads to the next state."""


def counted_forward_model(
    counts: IntArray, sim: FiniteMdp, known_after: int = 1
) -> FloatArray:
    """(S, A, S) probabilities of real next states, from their counts (S, A, S).

    The shares maximise the likelihood. If fewer than `known_after` transitions of a
    state and action were seen, the sim's probabilities are used, which leaves the
    action as it is. Where the sim is too optimistic, policies planned in it go to these
    states and collect the missing data (like the known states of R-max: Brafman and
    Tennenholtz 2002).
    """
    seen = counts.sum(axis=-1, keepdims=True)
    shares: FloatArray = np.where(
        seen >= known_after, counts / np.maximum(seen, 1), sim.transition
    )
    return shares


def inverse_model(sim: FiniteMdp) -> IntArray:
    """(S, S) the sim's action that leads from a state (row) to another one (column).

    It is the first one if several do, and `NONE` (-1) if none does; BadValueError if
    the sim is not deterministic.
    """
    if not np.isin(sim.transition, (0, 1)).all():
        raise BadValueError("only a deterministic sim has an inverse model")
    leads = sim.transition.astype(bool).transpose(0, 2, 1)
    return np.where(leads.any(axis=-1), leads.argmax(axis=-1), NONE)


def grounded_sim(sim: FiniteMdp, forward: FloatArray, samples: bool) -> FiniteMdp:
    """The simulator behind an action transformer, as a finite world of its own.

    Args:
      sim: a deterministic simulator with S states and A actions; else BadValueError.
      forward: (S, A, S) forward model: probabilities of the real next states.
      samples: whether the transformer samples next states (SGAT) or takes the most
        likely one (GAT).

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
    takes the most likely next state, the first of equally likely ones, since a mean of
    states has no meaning. Next states that no action of the sim leads to cannot be
    imitated: the probabilities of the other ones are scaled up. If none is left, the
    action stays as it is.
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

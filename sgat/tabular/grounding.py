"""GAT and SGAT in finite worlds, where a grounded simulator is a transition table."""

import dataclasses

import numpy as np

from groundwalk.arrays import FloatArray
from sgat.tabular.mdp import FiniteMdp
from sgat.tabular.models import NONE, inverse_model


def grounded_sim(sim: FiniteMdp, forward: FloatArray, samples: bool) -> FiniteMdp:
    """The simulator behind an action transformer, as a finite world of its own.

    Args:
      sim: a deterministic simulator with S states and A actions.
      forward: (S, A, S) forward model: probabilities of the real next states.
      samples: whether the transformer samples next states (SGAT) or takes the most
        likely one (GAT).

    Raises:
      BadValueError: the sim is not deterministic.

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

"""Models in finite worlds: forward of the real world, inverse of the sim."""

import numpy as np

from groundwalk.arrays import FloatArray, IntArray
from groundwalk.errors import BadValueError
from sgat.tabular.mdp import FiniteMdp

NONE = -1
"""In an inverse model: no action leads to this state."""


def counted_forward_model(
    counts: IntArray, sim: FiniteMdp, known_after: int = 1
) -> FloatArray:
    """(S, A, S) probabilities of the real next states: the observed shares.

    This maximises the likelihood of a categorical distribution. Where too few
    transitions were seen, the sim's table is used, which means that actions are not
    transformed there. If the sim is too optimistic there, policies planned in it go to
    these states and collect the missing data (like the known states of R-max: Brafman
    and Tennenholtz 2002).

    Args:
      counts: (S, A, S) number of times that each transition was seen in the real world.
      sim: the simulator.
      known_after: number of transitions of a state and action from which the shares are
        used.
    """
    seen = counts.sum(axis=-1, keepdims=True)
    shares: FloatArray = np.where(
        seen >= known_after, counts / np.maximum(seen, 1), sim.transition
    )
    return shares


def inverse_model(sim: FiniteMdp) -> IntArray:
    """(S, S) the sim's action that leads from a state to another one.

    The first one if several do; `NONE` if none does.

    Raises:
      BadValueError: the sim is not deterministic.
    """
    if not np.isin(sim.transition, (0, 1)).all():
        raise BadValueError("only a deterministic sim has an inverse model")
    leads = sim.transition.astype(bool).transpose(0, 2, 1)
    return np.where(leads.any(axis=-1), leads.argmax(axis=-1), NONE)

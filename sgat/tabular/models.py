"""Models in finite worlds: forward of the real world, inverse of the sim."""

import numpy as np

from groundwalk.arrays import FloatArray, IntArray
from groundwalk.errors import BadValueError
from sgat.tabular.mdp import FiniteMdp

NONE = -1
"""Entry of an inverse model's table if no action leads to the next state."""


def counted_forward_model(
    counts: IntArray, sim: FiniteMdp, known_after: int = 1
) -> FloatArray:
    """(S, A, S) probabilities of the real next states, estimated by observed shares.

    The shares maximise the likelihood. If too few transitions of a state and action
    were seen, the sim's probabilities are used, which leaves the action as it is. Where
    the sim is too optimistic, policies planned in it go to these states and collect the
    missing data (like the known states of R-max: Brafman and Tennenholtz 2002).

    Args:
      counts: (S, A, S) number of times that each transition was seen in the real world.
      sim: the simulator, with S states and A actions.
      known_after: least number of transitions of a state and action with which their
        shares are used.
    """
    seen = counts.sum(axis=-1, keepdims=True)
    shares: FloatArray = np.where(
        seen >= known_after, counts / np.maximum(seen, 1), sim.transition
    )
    return shares


def inverse_model(sim: FiniteMdp) -> IntArray:
    """(S, S) the sim's action that leads from a state (row) to another one (column).

    It is the first one if several do, and `NONE` (-1) if none does.

    Raises:
      BadValueError: the sim is not deterministic.
    """
    if not np.isin(sim.transition, (0, 1)).all():
        raise BadValueError("only a deterministic sim has an inverse model")
    leads = sim.transition.astype(bool).transpose(0, 2, 1)
    return np.where(leads.any(axis=-1), leads.argmax(axis=-1), NONE)

"""The two models of a grounding in finite worlds: forward of real, inverse of sim."""

import numpy as np

from groundwalk.arrays import FloatArray, IntArray
from groundwalk.errors import BadValueError
from sgat.tabular.mdp import FiniteMdp

NONE = -1


def counted_forward_model(
    counts: IntArray, sim: FiniteMdp, known_after: int = 1
) -> FloatArray:
    """(S, A, S) probabilities of the real next states: the shares that were seen.

    The maximum of the likelihood for a categorical distribution. Where too little was
    seen the sim is believed, that is, actions are not transformed there. A sim that
    errs on the bright side then draws its policies to where real data is missing
    (known states of R-max: Brafman and Tennenholtz 2002).

    Args:
      counts: (S, A, S) how often each transition was seen in the real world.
      sim: the simulator.
      known_after: transitions that must have been seen of a state and action.
    """
    seen = counts.sum(axis=-1, keepdims=True)
    shares: FloatArray = np.where(
        seen >= known_after, counts / np.maximum(seen, 1), sim.transition
    )
    return shares


def inverse_model(sim: FiniteMdp) -> IntArray:
    """(S, S) the action that leads from a state to another one in the sim.

    Where several do, the first one; `NONE` where none does.

    Raises:
      BadValueError: the sim is not deterministic.
    """
    if not np.isin(sim.transition, (0, 1)).all():
        raise BadValueError("only a deterministic sim has an inverse model")
    leads = sim.transition.astype(bool).transpose(0, 2, 1)
    return np.where(leads.any(axis=-1), leads.argmax(axis=-1), NONE)

"""Inverse model: the action of the sim that leads from one state to another."""

from typing import Self

import numpy as np

from groundwalk.arrays import FloatArray
from sgat.measures import r_squared
from sgat.models.config import NetworkConfig
from sgat.models.scaled_network import NetworkModel, ScaledNetwork
from sgat.models.training import Stage, squared_error
from sgat.transitions import Transitions


class InverseModel(NetworkModel[NetworkConfig]):
    """a = f(s, s'): the action of a deterministic sim, fitted by least squares.

    The network sees the state and its change. If several actions lead to the same next
    state, or the sim is noisy, it predicts their mean, which may be too small an
    action: give it data with varied actions.

    Example:
      >>> inverse = InverseModel().fit(sim_transitions, seed)
      >>> action = inverse.predict(state, wanted_next_state)
    """

    kind = "inverse"
    config_type = NetworkConfig

    def fit(self, transitions: Transitions, seed: np.random.SeedSequence) -> Self:
        """Learn from at least two episodes of the sim; equal seeds give equal bits."""
        self._fitted = ScaledNetwork.fit(
            np.hstack([transitions.state, transitions.change]),
            transitions.action,
            transitions.episode,
            transitions.action.shape[1],
            [Stage(squared_error, squared_error, rate) for rate in (1.0, 0.1)],
            self.config,
            seed,
        )
        return self

    def predict(self, state: FloatArray, next_state: FloatArray) -> FloatArray:
        """(n, a) actions that lead from states (n, s) to next states (n, p)."""
        change = next_state - state[:, : next_state.shape[1]]
        member = np.zeros(len(state), np.intp)
        scaled = self._network.raw(np.hstack([state, change]), member)
        return self._network.targets.from_scaled(scaled)

    def score(self, transitions: Transitions) -> FloatArray:
        """(a,) share of the variance of the actions that is predicted, at most 1."""
        predicted = self.predict(transitions.state, transitions.next_state)
        return r_squared(predicted, transitions.action)

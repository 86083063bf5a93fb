"""Grounding in finite worlds, where models, policies and transformers are tables."""

from sgat.tabular.grounding import grounded_sim
from sgat.tabular.loop import Settled, TabularLoop, ground_until_calm
from sgat.tabular.mdp import FiniteMdp
from sgat.tabular.planning import policy_iteration
from sgat.tabular.rollouts import roll_out

__all__ = [
    "FiniteMdp",
    "Settled",
    "TabularLoop",
    "ground_until_calm",
    "grounded_sim",
    "policy_iteration",
    "roll_out",
]

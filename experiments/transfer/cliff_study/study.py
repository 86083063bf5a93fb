"""Cliff walking in one real world: each method's policy and its return there."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from experiments.transfer.cliff_study.grid import cliff_walking, intended_path
from groundwalk.arrays import IntArray
from groundwalk.errors import BadValueError
from sgat.tabular.loop import TabularLoop, ground_until_calm
from sgat.tabular.mdp import FiniteMdp
from sgat.tabular.planning import expected_return, policy_iteration
from sgat.tabular.rollouts import STEP_LIMIT, roll_out

UNGROUNDED, GAT, SGAT, OPTIMUM = METHODS = ("no grounding", "GAT", "SGAT", "optimum")
"""Methods: planning in the sim, in the sim grounded by GAT or by SGAT, and in the real
world itself."""

SAMPLES = {GAT: False, SGAT: True}
"""Whether a grounding samples next states, or takes the most likely one."""

Row = dict[str, Any]
"""Results in one real world: its `noise`, and the numbers of each method under
`methods`."""


@dataclass(frozen=True)
class CliffStudy:
    """Settings with which methods are compared in cliff walking.

    Attributes:
      rows: number of rows of the grid.
      columns: number of columns of the grid.
      episodes: number of real episodes in which each policy is tried.
      loop: settings of grounding and planning.
    """

    rows: int
    columns: int
    episodes: int
    loop: TabularLoop

    def __post_init__(self) -> None:
        """Refuse grids without a cliff, and too few episodes for a standard error."""
        cliff_walking(self.rows, self.columns)
        if self.episodes < 2:
            raise BadValueError(f"episodes is {self.episodes}; it must be at least 2")


def compare(study: CliffStudy, noise: float, seed: np.random.SeedSequence) -> Row:
    """Find each method's policy, and try it in the real world.

    Args:
      study: settings of the comparison.
      noise: probability of a random move in the real world.
      seed: seed of the real world's outcomes; all methods get the same random numbers,
        so that differences come from the methods.
    """
    of_data, of_trials = seed.spawn(2)
    sim = cliff_walking(study.rows, study.columns)
    real = cliff_walking(study.rows, study.columns, noise)
    settled = {
        name: ground_until_calm(
            sim, real, samples, study.loop, np.random.default_rng(of_data)
        )
        for name, samples in SAMPLES.items()
    }
    policies = {UNGROUNDED: policy_iteration(sim)}
    policies |= {name: found.policy for name, found in settled.items()}
    policies[OPTIMUM] = policy_iteration(real)
    methods = {}
    for name, policy in policies.items():
        generator = np.random.default_rng(of_trials)
        path = np.divmod(intended_path(sim, policy), study.columns)
        methods[name] = {
            **_returns(real, policy, study.episodes, generator),
            "path": np.transpose(path).tolist(),
        }
    for name, found in settled.items():
        methods[name] |= {
            "grounding_steps": found.steps,
            "real_transitions": found.transitions,
            "calm": found.calm,
        }
    return {"noise": noise, "methods": methods}


def _returns(
    real: FiniteMdp, policy: IntArray, episodes: int, generator: np.random.Generator
) -> dict[str, Any]:
    trials = roll_out(real, policy, episodes, generator)
    return {
        "mean": trials.mean,
        "standard_error": trials.standard_error,
        "exact": expected_return(real, policy, STEP_LIMIT),
        "cut": trials.cut,
    }

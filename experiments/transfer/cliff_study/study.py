"""Cliff walking in one real world: each method's policy and its return there."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from experiments.runs.options import RunOptions
from experiments.transfer.cliff_study.grid import cliff_walking, intended_path
from groundwalk.errors import BadValueError
from sgat.tabular.grounding import TabularLoop, ground_until_calm
from sgat.tabular.mdp import STEP_LIMIT, expected_return, policy_iteration, roll_out

UNGROUNDED, GAT, SGAT, OPTIMUM = METHODS = ("no grounding", "GAT", "SGAT", "optimum")
"""Methods: planning in the sim, in the sim grounded by GAT or by SGAT, and in the real
world itself."""

SAMPLES = {GAT: False, SGAT: True}
"""Whether a grounding samples next states, or takes the most likely one."""

Row = dict[str, Any]
"""Results in one real world: its `noise`, and the numbers of each method under
`methods`."""


@dataclass(frozen=True)
class TransferCliff(RunOptions):
    """Compare GAT, SGAT, no grounding and the optimum in cliff walking with noise.

    Attributes:
      rows: number of rows of the grid.
      columns: number of columns of the grid.
      noise: probabilities of a random move; each makes a real world of its own.
      episodes: number of real episodes in which each policy is tried.
      real_episodes: number of real episodes that each grounding step learns from.
    """

    rows: int = 4
    columns: int = 12
    noise: tuple[float, ...] = (0.0, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 1.0)
    episodes: int = 10_000
    real_episodes: int = 10_000

    def __post_init__(self) -> None:
        """Refuse options with which nothing can run, before anything is written."""
        TabularLoop(self.real_episodes)
        cliff_walking(self.rows, self.columns)
        if self.episodes < 2:
            raise BadValueError(f"episodes is {self.episodes}; it must be at least 2")
        if not self.noise or min(self.noise) < 0 or max(self.noise) > 1:
            raise BadValueError(f"noise is {self.noise}; give values from 0 to 1")
        super().__post_init__()


def compare(config: TransferCliff, noise: float, seed: np.random.SeedSequence) -> Row:
    """Find each method's policy, and try it in the real world with this noise.

    All methods get the same random numbers, so that differences come from the methods.
    """
    of_data, of_trials = seed.spawn(2)
    sim = cliff_walking(config.rows, config.columns)
    real = cliff_walking(config.rows, config.columns, noise)
    loop = TabularLoop(config.real_episodes)
    settled = {
        name: ground_until_calm(
            sim, real, samples, loop, np.random.default_rng(of_data)
        )
        for name, samples in SAMPLES.items()
    }
    policies = {UNGROUNDED: policy_iteration(sim)}
    policies |= {name: found.policy for name, found in settled.items()}
    policies[OPTIMUM] = policy_iteration(real)
    methods: dict[str, dict[str, Any]] = {}
    for name, policy in policies.items():
        trials = roll_out(
            real, policy, config.episodes, np.random.default_rng(of_trials)
        )
        path = np.divmod(intended_path(sim, policy), config.columns)
        methods[name] = {
            "mean": trials.mean,
            "standard_error": trials.standard_error,
            "exact": expected_return(real, policy, STEP_LIMIT),
            "cut": trials.cut,
            "path": np.transpose(path).tolist(),
        }
    for name, found in settled.items():
        methods[name] |= {
            "grounding_steps": found.steps,
            "real_transitions": found.transitions,
            "calm": found.calm,
        }
    return {"noise": noise, "methods": methods}

"""Cliff walking: the grid with its cliff, and each method's policy and return there."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from experiments.runs.options import RunOptions
from groundwalk.arrays import IntArray
from groundwalk.errors import BadValueError
from sgat.tabular.grounding import TabularLoop, ground_until_calm
from sgat.tabular.mdp import (
    STEP_LIMIT,
    FiniteMdp,
    expected_return,
    policy_iteration,
    roll_out,
)

MOVES = {"up": (-1, 0), "down": (1, 0), "left": (0, -1), "right": (0, 1)}
"""Change of (row, column) by each action, in the SGAT paper's order."""

GOAL, CLIFF, STEP = 100.0, -10.0, -0.1
"""Rewards of the SGAT paper: for the goal, for the cliff, and for every step, the last
one included."""


def cliff_walking(rows: int, columns: int, noise: float = 0.0) -> FiniteMdp:
    """The grid world in the SGAT paper's study of cliff walking.

    Cell (row, column) is state row * columns + column, with the first row on top.
    Episodes begin at the bottom left. They end at the goal, bottom right, or in the
    cliff: the cells of the bottom row in between. A move into a wall has no effect.

    `noise` is the probability, at each step, that the move is a random one of the four
    instead of the chosen one. Without noise this world is the simulator.

    Raises:
      BadValueError: there is no room for a cliff, or noise is no probability.
    """
    if rows < 2 or columns < 3:
        raise BadValueError(
            f"the grid is {rows} x {columns}; it must be at least 2 x 3"
        )
    if not 0 <= noise <= 1:
        raise BadValueError(f"noise is {noise}; it must be from 0 to 1")
    states = rows * columns
    row, column = np.divmod(np.arange(states), columns)
    chosen = np.zeros((states, len(MOVES), states))
    for action, (down, right) in enumerate(MOVES.values()):
        to_row = np.clip(row + down, 0, rows - 1)
        to_column = np.clip(column + right, 0, columns - 1)
        chosen[np.arange(states), action, to_row * columns + to_column] = 1
    transition = (1 - noise) * chosen + noise * chosen.mean(axis=1, keepdims=True)
    start, goal = states - columns, states - 1
    reward = np.full(states, STEP)
    reward[start + 1 : goal] += CLIFF
    reward[goal] += GOAL
    return FiniteMdp(transition, reward, np.arange(states) > start, start)


def intended_path(sim: FiniteMdp, policy: IntArray) -> list[int]:
    """The states that a policy (S,) visits in a deterministic world of S states.

    They lead from the start to an end, or to the first state that is visited twice.
    """
    path = [sim.start]
    while not sim.ends[path[-1]] and path[-1] not in path[:-1]:
        path.append(int(sim.transition[path[-1], policy[path[-1]]].argmax()))
    return path


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

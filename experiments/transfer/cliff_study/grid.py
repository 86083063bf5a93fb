"""Cliff walking: a grid with a goal, a cliff in between, and random moves."""

import numpy as np

from groundwalk.arrays import IntArray
from groundwalk.errors import BadValueError
from sgat.tabular.mdp import FiniteMdp

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

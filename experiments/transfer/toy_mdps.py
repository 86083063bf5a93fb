"""The SGAT paper's toy worlds: one choice between actions with random outcomes."""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from sgat.tabular.mdp import FiniteMdp


@dataclass(frozen=True, eq=False)
class Toy:
    """A simulator, a real world, and the SGAT paper's statements about them.

    Attributes:
      figures: the paper's figures of this toy, counted in its LaTeX source.
      sim: the simulator.
      real: the real world.
      best: the best action according to the paper, by "sim", "GAT", "SGAT" and "real":
        the world that is planned in.
    """

    figures: str
    sim: FiniteMdp
    real: FiniteMdp
    best: dict[str, str]


def choice(rewards: npt.ArrayLike, chances: npt.ArrayLike) -> FiniteMdp:
    """A world with a single step, from s0 into one of the states s1, s2, ...

    Args:
      rewards: (states,) reward for entering each of these states.
      chances: (actions, states) probability of each of these states.
    """
    reward = np.concatenate([[0.0], np.asarray(rewards, np.float64)])
    outcomes = np.asarray(chances, np.float64)
    transition = np.zeros((len(reward), len(outcomes), len(reward)))
    transition[0, :, 1:] = outcomes
    transition[1:] = np.eye(len(reward))[1:, np.newaxis]
    return FiniteMdp(transition, reward, np.arange(len(reward)) > 0)


TOYS = {
    "deterministic": Toy(
        "figure 3",
        sim=choice([1, -1], [[1, 0], [0, 1]]),
        real=choice([1, -1], [[0, 1], [1, 0]]),
        best={"sim": "a1", "GAT": "a2", "SGAT": "a2", "real": "a2"},
    ),
    "stochastic": Toy(
        "figures 4 and 5",
        sim=choice([1, -1, 10], np.eye(3)),
        real=choice([1, -1, 10], [[1.0, 0.0, 0.0], [0.0, 0.8, 0.2], [0.0, 1.0, 0.0]]),
        best={"sim": "a3", "GAT": "a1", "SGAT": "a2", "real": "a2"},
    ),
}
"""The toys, by whether their real world is deterministic or stochastic."""

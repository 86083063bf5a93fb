"""`groundwalk transfer toy`: the SGAT paper's toy worlds, solved exactly."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from experiments.command_line import run_verb
from experiments.reports.report import markdown_table
from experiments.runs.folder import RESULT, open_run
from experiments.runs.options import RunOptions, check_at_least
from experiments.runs.progress import progress
from experiments.transfer.claims import Claim, print_study, write_transfer_page
from groundwalk.arrays import FloatArray
from sgat.tabular.grounding import counted_forward_model, grounded_sim
from sgat.tabular.mdp import FiniteMdp, action_values, policy_iteration, roll_out

VERB = "transfer-toy"
TITLE = "Toy worlds: does planning in a grounded sim find the best action?"
COLUMNS = (
    "real world", "planned in", "values of a1, a2, ...", "best", "in the paper",
    "from counts", "worth on real",
)  # fmt: skip
NOTES = """\
Each world is one choice; the value of an action is the mean reward of what it leads to.
Values are exact: the forward models are the real world's own probabilities. Counted from
{episodes} random real transitions instead, they lead to the action under "from counts".\
"""  # noqa: E501
FIRST = 0
"""Number of the state in which the choice is made."""


@dataclass(frozen=True, eq=False)
class Toy:
    """A simulator, a real world, and the SGAT paper's statements about them.

    `figures` are those of the paper, counted in its LaTeX source; `best` is the best
    action according to it, by the world that is planned in.
    """

    figures: str
    sim: FiniteMdp
    real: FiniteMdp
    best: dict[str, str]


def choice(rewards: npt.ArrayLike, chances: npt.ArrayLike) -> FiniteMdp:
    """A world with a single step, from s0 into one of the states s1, s2, ...

    Each has a reward for entering it, and a chance in (actions, states).
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
"""The SGAT paper's toy worlds, by whether the real one is deterministic or random."""


@dataclass(frozen=True)
class TransferToy(RunOptions):
    """Find the best action in the SGAT paper's toy worlds, without and with grounding.

    Attributes:
      episodes: number of random real transitions that estimate the forward models.
    """

    episodes: int = 30_000

    def __post_init__(self) -> None:
        """Refuse options with which nothing can run, before anything is written."""
        check_at_least(self, episodes=1)
        super().__post_init__()


def main(config: TransferToy) -> None:
    """Solve the toy worlds, and write results and page."""
    folder, config = open_run(VERB, config)
    if not folder.has(RESULT):
        folder.write_json(RESULT, _solve_all(config))
    result = folder.read_json(RESULT)
    claims = [Claim(**claim) for claim in result["claims"]]
    rows = [
        _texts(name, planned)
        for name, toy in result["toys"].items()
        for planned in toy["planned"]
    ]
    notes = NOTES.format(episodes=config.episodes)
    body = [*markdown_table(COLUMNS, rows), "", notes]
    write_transfer_page(folder, TITLE, claims, body, [_answer(result["toys"])])
    print_study(config.json, folder, result, COLUMNS, rows)


def _answer(toys: Mapping[str, Any]) -> str:
    """A sentence on how often planning in each sim finds the best real action."""
    found = dict.fromkeys(("sim", "GAT", "SGAT"), 0)
    for toy in toys.values():
        best = {row["world"]: row["best"] for row in toy["planned"]}
        for world in found:
            found[world] += best[world] == best["real"]
    said = [f"in {count} when grounded by {name}" for name, count in found.items()]
    said[0] = f"in {found['sim']} without grounding"
    return (
        f"In {len(toys)} toy worlds, planning in the sim finds the action that is best "
        f"in the real world: {', '.join(said)}."
    )


def _solve_all(config: TransferToy) -> dict[str, Any]:
    solved, claims = {}, []
    generator = np.random.default_rng(config.seed)
    with progress("toy worlds", len(TOYS)) as bar:
        for name, toy in TOYS.items():
            rows = solve(toy, config.episodes, generator)
            solved[name] = {"figures": toy.figures, "planned": rows}
            found = {row["world"]: row["best"] for row in rows}
            claim = Claim(
                f"the best actions with a {name} real world are those of the paper "
                f"({toy.figures})",
                found == toy.best,
                ", ".join(f"{action} in {world}" for world, action in found.items()),
            )
            claims.append(vars(claim))
            bar.advance()
    return {"toys": solved, "claims": claims}


def solve(
    toy: Toy, episodes: int, generator: np.random.Generator
) -> list[dict[str, Any]]:
    """The best action in the sim, in both grounded sims and in the real world.

    Grounding uses the exact forward model, and for comparison one that is estimated
    from `episodes` random real transitions.
    """
    anything = np.zeros(toy.sim.states, np.intp)
    seen = roll_out(toy.real, anything, episodes, generator, exploration=1.0).counts
    exact = _planned_in(toy, toy.real.transition)
    counted = _planned_in(toy, counted_forward_model(seen, toy.sim))
    on_real = _first_values(toy.real)
    return [
        {
            "world": world,
            "values": _first_values(mdp).tolist(),
            "best": _best(mdp),
            "paper": toy.best[world],
            "from_counts": _best(counted[world]),
            "worth_on_real": float(on_real[policy_iteration(mdp)[FIRST]]),
        }
        for world, mdp in exact.items()
    ]


def _planned_in(toy: Toy, forward: FloatArray) -> dict[str, FiniteMdp]:
    return {
        "sim": toy.sim,
        "GAT": grounded_sim(toy.sim, forward, samples=False),
        "SGAT": grounded_sim(toy.sim, forward, samples=True),
        "real": toy.real,
    }


def _first_values(mdp: FiniteMdp) -> FloatArray:
    """(A,) expected reward of each action in the first state; then the episode ends."""
    values: FloatArray = action_values(mdp, np.zeros(mdp.states))[FIRST]
    return values


def _best(mdp: FiniteMdp) -> str:
    return f"a{policy_iteration(mdp)[FIRST] + 1}"


def _texts(toy: str, row: dict[str, Any]) -> list[str]:
    values = ", ".join(f"{value:.4g}" for value in row["values"])
    actions = [row[key] for key in ("best", "paper", "from_counts")]
    return [toy, row["world"], values, *actions, f"{row['worth_on_real']:.4g}"]


if __name__ == "__main__":
    run_verb(TransferToy, main)

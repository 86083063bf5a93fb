"""`groundwalk transfer cliff`: cliff walking, grounded by GAT and by SGAT."""

from dataclasses import dataclass

import numpy as np

from experiments.command_line import run_verb
from experiments.reports.figure_file import write_figure
from experiments.reports.tables import print_folder, print_json, print_table
from experiments.runs.extras import extra
from experiments.runs.folder import HISTORY, RESULT, RunFolder, open_run
from experiments.runs.options import RunOptions
from experiments.runs.progress import progress
from experiments.transfer.claims import claim_lines
from experiments.transfer.cliff_study.claims import check_claims
from experiments.transfer.cliff_study.figure import FIGURE, cliff_figure
from experiments.transfer.cliff_study.page import returns_table, write_cliff_page
from experiments.transfer.cliff_study.study import CliffStudy, Row, compare
from groundwalk.errors import BadValueError
from sgat.tabular.loop import TabularLoop

VERB = "transfer-cliff"


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
        self.study()
        if not self.noise or min(self.noise) < 0 or max(self.noise) > 1:
            raise BadValueError(f"noise is {self.noise}; give values from 0 to 1")
        super().__post_init__()

    def study(self) -> CliffStudy:
        """The study that these options describe."""
        loop = TabularLoop(episodes=self.real_episodes)
        return CliffStudy(self.rows, self.columns, self.episodes, loop)


def main(config: TransferCliff) -> None:
    """Compare the methods for every noise value, and write results and page."""
    folder, config = open_run(VERB, config)
    rows = _compare_all(config, folder)
    claims = check_claims(rows)
    result = {"rows": rows, "claims": [claim.to_json() for claim in claims]}
    folder.write_json(RESULT, result)
    with extra(FIGURE):
        write_figure(
            cliff_figure(rows, (config.rows, config.columns)), folder.path / FIGURE
        )
    write_cliff_page(folder, config.study(), rows, claims)
    if config.json:
        print_json(result)
    else:
        print_table(*returns_table(rows))
        print(*claim_lines(claims), sep="\n")
        print_folder(folder.path)


def _compare_all(config: TransferCliff, folder: RunFolder) -> list[Row]:
    """Results for all noise values; those that an earlier run has written are kept."""
    rows = folder.read_json(HISTORY)["rows"] if folder.has(HISTORY) else []
    seeds = np.random.SeedSequence(config.seed).spawn(len(config.noise))
    with progress("cliff walking", len(config.noise), done=len(rows)) as bar:
        for k in range(len(rows), len(config.noise)):
            rows.append(compare(config.study(), config.noise[k], seeds[k]))
            folder.write_json(HISTORY, {"rows": rows})
            bar.advance()
    return rows


if __name__ == "__main__":
    run_verb(TransferCliff, main)

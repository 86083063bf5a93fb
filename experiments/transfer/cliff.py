"""`groundwalk transfer cliff`: cliff walking, grounded by GAT and by SGAT."""

import numpy as np

from experiments.command_line import run_verb
from experiments.runs.folder import HISTORY, RESULT, RunFolder, open_run
from experiments.runs.progress import progress
from experiments.transfer.claims import print_study, write_picture
from experiments.transfer.cliff_study.page import (
    FIGURE,
    check_claims,
    cliff_figure,
    returns_table,
    write_cliff_page,
)
from experiments.transfer.cliff_study.study import Row, TransferCliff, compare

VERB = "transfer-cliff"


def main(config: TransferCliff) -> None:
    """Compare the methods for every noise value, and write results and page."""
    folder, config = open_run(VERB, config)
    rows = _compare_all(config, folder)
    claims = check_claims(rows)
    result = {"rows": rows, "claims": [vars(claim) for claim in claims]}
    folder.write_json(RESULT, result)
    write_picture(folder, FIGURE, cliff_figure, rows, (config.rows, config.columns))
    write_cliff_page(folder, config, rows, claims)
    print_study(config.json, folder, result, *returns_table(rows), claims)


def _compare_all(config: TransferCliff, folder: RunFolder) -> list[Row]:
    """Results for all noise values; those that an earlier run has written are kept."""
    rows = folder.read_json(HISTORY)["rows"] if folder.has(HISTORY) else []
    seeds = np.random.SeedSequence(config.seed).spawn(len(config.noise))
    with progress("cliff walking", len(config.noise), done=len(rows)) as bar:
        for k in range(len(rows), len(config.noise)):
            rows.append(compare(config, config.noise[k], seeds[k]))
            folder.write_json(HISTORY, {"rows": rows})
            bar.advance()
    return rows


if __name__ == "__main__":
    run_verb(TransferCliff, main)

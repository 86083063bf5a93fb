"""`groundwalk transfer nao`: tune gaits in grounded sims, try them on uneven ground."""

from collections.abc import Sequence

from experiments.command_line import run_verb
from experiments.runs.folder import RESULT, RunFolder, open_run
from experiments.runs.progress import progress
from experiments.transfer.claims import print_study, write_picture
from experiments.transfer.nao_studies.page import (
    CELLS,
    FIGURE,
    HEADINGS,
    Cell,
    cells_figure,
    table_of,
    write_nao_page,
)
from experiments.transfer.nao_studies.study import NaoStudy, TransferNao

VERB = "transfer-nao"


def main(config: TransferNao) -> None:
    """Find and try a gait by every method; results of an earlier run are kept."""
    folder, config = open_run(VERB, config)
    study = NaoStudy(folder, config)
    if study.cells:
        _write(folder, config, study.cells)
    with progress("ways to a gait", len(config.plan), done=len(study.cells)) as bar:
        for method, step in config.plan:
            if study.cell(method, step) is None:
                study.compute(method, step)
                bar.advance(f"{method}, step {step} done")
                _write(folder, config, study.cells)
    result, table = {CELLS: study.cells}, table_of(study.cells)
    print_study(config.json, folder, result, HEADINGS, table)


def _write(folder: RunFolder, config: TransferNao, cells: Sequence[Cell]) -> None:
    """Write the results so far, since a study takes hours."""
    folder.write_json(RESULT, {CELLS: cells})
    write_picture(folder, FIGURE, cells_figure, cells)
    planned, course = len(config.plan), config.places.real
    write_nao_page(folder, cells, planned, config.ratings, course)


if __name__ == "__main__":
    run_verb(TransferNao, main)

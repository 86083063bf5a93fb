import math

import numpy as np
import pytest

from experiments.run_folder import HISTORY, RunFolder
from experiments.transfer_nao import TransferNao, main
from experiments.transfer_nao_figure import cells_figure
from experiments.transfer_nao_page import claims_of, more_falls_p, table_of
from experiments.walk_data import FLAT_TICKS, on_lumps
from experiments.walk_groundings import GAT, SGAT, UNEVEN
from groundwalk.errors import BadValueError, UnknownNameError
from sgat.transitions import Transitions

SMOKE = {
    "methods": (SGAT,), "trials": 2, "population": 4, "generations": 1, "repeats": 1,
    "real_walks": 4, "more_real_walks": 2, "sim_walks": 4,
}  # fmt: skip


def cell(method, step, speed, falls, trials=40):
    return {
        "method": method, "step": step, "speed_mean": speed, "speed_std": 1.0,
        "falls": falls, "trials": trials, "real_walks": 96,
    }  # fmt: skip


@pytest.mark.slow
def test_a_small_study_runs_and_resumes_to_the_same_numbers(tmp_path):
    whole = RunFolder(tmp_path / "whole")
    main(TransferNao(**SMOKE, out=whole.path, json=True))
    cells = whole.read_json("result.json")["cells"]
    assert [(c["method"], c["step"]) for c in cells] == [
        ("start gait", 0), (SGAT, 1), (SGAT, 2),
    ]  # fmt: skip
    assert [c["real_walks"] for c in cells] == [0, 4, 6]
    kept = {path.name for path in whole.path.iterdir()}
    assert {"result.md", "transfer_nao.png", HISTORY} <= kept
    # as if killed after the first grounding step
    whole.write_json(HISTORY, {"cells": cells[:2]})
    (whole.path / "search_SGAT_2.pkl").unlink()
    main(TransferNao(resume=whole.path, json=True))
    assert whole.read_json("result.json")["cells"] == cells


def test_fishers_test_counts_tables():
    # all 3 of 3 against 0 of 3: one of the 20 ways to deal 3 falls to 6 trials
    often, seldom = cell(GAT, 2, 20, 3, 3), cell(SGAT, 2, 20, 0, 3)
    assert more_falls_p(often, seldom) == pytest.approx(1 / math.comb(6, 3))
    assert more_falls_p(seldom, often) == pytest.approx(1.0)


@pytest.mark.parametrize(
    ("cells", "hold"),
    [
        ([cell(SGAT, 2, 18.5, 3), cell(GAT, 2, 20, 15), cell(UNEVEN, 2, 20, 2)],
         [True, True, True, True]),
        ([cell(SGAT, 2, 17.5, 3), cell(GAT, 2, 20, 5), cell(UNEVEN, 2, 20, 20)],
         [False, False, False, False]),
        ([cell(SGAT, 2, 19, 5), cell(GAT, 2, 20, 20), cell(UNEVEN, 2, 19.1, 5)],
         [False, False, True, True]),
    ],
)  # fmt: skip
def test_claims_hold_or_do_not(cells, hold):
    assert [claim.holds for claim in claims_of(cells)] == hold


def test_without_the_methods_there_are_no_claims():
    assert claims_of([cell(SGAT, 2, 18.5, 3)]) == []


def test_table_and_figure_have_a_row_for_each_cell():
    cells = [cell(SGAT, 2, 18.5, 3), cell(GAT, 1, 20, 15)]
    table = table_of(cells)
    assert table[0][:4] == [GAT, "1", "20.0 ± 1.0", "15/40"]
    # Wilson 1927 for 15 of 40, by hand
    assert table[0][4] == "24% to 53%"
    speeds, _ = cells_figure(cells).axes
    labels = [text.get_text() for text in speeds.get_yticklabels()]
    assert labels == ["GAT, step 1", "SGAT, step 2"]


@pytest.mark.parametrize("change", [{"trials": 1}, {"seed": -1}, {"population": 2}])
def test_impossible_studies_are_refused(change):
    with pytest.raises(BadValueError):
        TransferNao(**change)


def test_unknown_methods_are_named():
    with pytest.raises(UnknownNameError, match="SGAT"):
        TransferNao(methods=("SGATT",))


def test_what_is_noted_on_the_flat_start_does_not_count():
    episode = np.repeat([0, 1, 2], [FLAT_TICKS + 2, 5, FLAT_TICKS + 1])
    tick = np.concatenate([np.arange(n) for n in (FLAT_TICKS + 2, 5, FLAT_TICKS + 1)])
    rows = np.stack([episode, tick], axis=1).astype(float)
    kept = on_lumps(Transitions(rows, rows, rows, episode))
    assert kept.state.tolist() == [
        [0, FLAT_TICKS],
        [0, FLAT_TICKS + 1],
        [2, FLAT_TICKS],
    ]

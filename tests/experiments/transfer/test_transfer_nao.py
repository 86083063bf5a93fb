import json
import math

import numpy as np
import pytest
import scipy.stats

import robots
from diagnosis.corrected.sim import CorrectedSim
from experiments.grounded_walks.courses import (
    LUMPS_M,
    Places,
    RealCourse,
    SimPlace,
    world_at,
)
from experiments.grounded_walks.models import GAT, NONE, SGAT, UNEVEN, GroundingStep
from experiments.grounded_walks.walks import FLAT_TICKS, RealWalks, on_lumps
from experiments.runs.folder import HISTORY, RunFolder
from experiments.transfer.nao import main
from experiments.transfer.nao_studies.page import (
    DIAGNOSED_SIM,
    cells_figure,
    claims_of,
    faster_p,
    more_falls_p,
    table_of,
    worth_cm_s,
)
from experiments.transfer.nao_studies.study import START, TransferNao
from groundwalk.errors import BadValueError, UnknownNameError
from sgat.transitions import Transitions
from sgat.walks.gait_cloud import GaitCloud
from walk_engine import gaits
from worlds.sim.world import SimWorld

SMOKE = {
    "methods": (SGAT,), "trials": 2, "course_m": 0.1, "population": 4,
    "generations": 1, "ratings": 1, "repeats": 1, "real_walks": 2,
    "more_real_walks": 2, "sim_walks": 2,
}  # fmt: skip


def cell(method, step, speed, falls, trials=40):
    return {
        "method": method, "step": step, "speed_mean": speed, "speed_std": 1.0,
        "falls": falls, "trials": trials, "real_walks": 96,
    }  # fmt: skip


@pytest.mark.slow
@pytest.mark.usefixtures("short_walks")
def test_a_small_study_runs_and_resumes_to_the_same_numbers(tmp_path):
    whole = RunFolder(tmp_path / "whole")
    main(TransferNao(**SMOKE, out=whole.path, json=True))
    cells = whole.read_json("result.json")["cells"]
    assert [(c["method"], c["step"]) for c in cells] == [
        ("start gait", 0), (SGAT, 1), (SGAT, 2),
    ]  # fmt: skip
    assert [c["real_walks"] for c in cells] == [0, 2, 4]
    kept = {path.name for path in whole.path.iterdir()}
    assert {"result.md", "transfer_nao.png", HISTORY} <= kept
    # as if killed after the first grounding step
    whole.write_json(HISTORY, {"cells": cells[:2]})
    (whole.path / "search_SGAT_2.json").unlink()
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


@pytest.mark.parametrize(
    "change", [{"trials": 1}, {"course_m": 5.0}, {"seed": -1}, {"population": 2}]
)
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


def late(folder):
    """What a diagnosis leaves behind that found latency."""
    effect = {
        "name": "command_latency",
        "place": "commands",
        "parameters": {"delay": 0.04},
    }
    model = {"format": 1, "robot": "nao", "base": "fixed", "native": [effect]}
    folder.mkdir()
    (folder / "corrected.json").write_text(json.dumps({**model, "per_tick": []}))
    return folder


@pytest.mark.parametrize(
    ("diagnosed", "kind"), [(True, CorrectedSim), (False, SimWorld)]
)
def test_a_diagnosis_corrects_every_sim_of_a_grounding(tmp_path, diagnosed, kind):
    places = Places(correction=late(tmp_path / "found") if diagnosed else None)
    for place in (places.sim(), places.sim(0.005), places.sim(LUMPS_M)):
        seeds = np.random.SeedSequence(1).spawn(2)
        world = world_at(place, robots.get("nao"), place.grounds(seeds), seeds)
        assert type(world) is kind
        assert (world.options.noise is None) == (place.lumps_m == 0)


def test_grounds_are_drawn_unless_they_are_flat():
    seeds = np.random.SeedSequence(1).spawn(2)
    for place in (RealCourse("flat"), SimPlace()):
        first, second = place.grounds(seeds)
        assert first is second
    for place in (RealCourse("lumps:amplitude_m=0.004"), SimPlace((0.004, 0.004))):
        first, second = place.grounds(seeds)
        assert np.ptp(first.heights_m) == pytest.approx(0.008, rel=0.5)
        assert not np.array_equal(first.heights_m, second.heights_m)


def test_groundings_of_one_gait_share_their_real_walks():
    seed, start = np.random.SeedSequence(1), gaits.get("start")
    plain = GroundingStep(start, GaitCloud(), (2, 2), seed)
    walked = RealWalks(None, np.zeros((2, 16)), np.zeros(2, bool))
    plain.__dict__["real"] = walked  # as if it had been walked
    beside = GroundingStep(start, GaitCloud(), (2, 2), seed, beside=plain)
    assert beside.real is walked


@pytest.mark.slow
@pytest.mark.usefixtures("short_walks")
def test_a_diagnosed_sim_is_tried(tmp_path):
    config = TransferNao(
        **SMOKE | {"methods": (DIAGNOSED_SIM,)},
        terrain="flat",
        hidden=("speed_limit@LKneePitch:speed=2",),
        sim=late(tmp_path / "found"),
        out=tmp_path / "run",
    )
    main(config)
    cells = RunFolder(config.out).read_json("result.json")["cells"]
    methods = [cell["method"] for cell in cells]
    assert methods == [START, DIAGNOSED_SIM]
    page = (config.out / "result.md").read_text()
    assert "courses of 0.1 m on flat ground" in page
    assert "speed_limit@LKneePitch:speed=2" in page


def test_an_uneven_sim_is_for_uneven_ground(tmp_path):
    found = late(tmp_path / "found")
    flat, lumps = (TransferNao(sim=found, terrain=on) for on in ("flat", "lumps"))
    assert SGAT in flat.compared
    assert UNEVEN not in flat.compared
    assert SGAT not in lumps.compared
    assert UNEVEN in lumps.compared
    for config in (flat, lumps):
        steps = [method for method, _ in config.plan]
        assert all(steps.count(method) for method in config.compared)


def test_a_faster_gait_is_faster_by_welchs_test():
    # t = 1 / sqrt(0.1) with 2 (n - 1) degrees of freedom, as the spreads are equal
    fast, slow = cell(NONE, 1, 21, 0, 20), cell(NONE, 1, 20, 0, 20)
    expected = scipy.stats.t.sf(1 / np.sqrt(2 / 20), 38)
    assert faster_p(fast, slow) == pytest.approx(expected)
    assert faster_p(slow, fast) == pytest.approx(1 - expected)


def test_diagnosed_sims_need_a_diagnosis():
    with pytest.raises(BadValueError, match="--sim"):
        TransferNao(methods=(DIAGNOSED_SIM,))


@pytest.mark.parametrize(
    ("nominal", "diagnosed", "holds"),
    [((20, 10), (19, 2), True), ((20, 2), (19, 2), False)],
)
def test_the_claim_of_a_diagnosed_sim_can_fail(nominal, diagnosed, holds):
    cells = [cell(NONE, 1, *nominal), cell(DIAGNOSED_SIM, 1, *diagnosed)]
    (claim,) = claims_of(cells)
    assert claim.holds is holds


def test_a_fall_costs_what_it_costs_in_the_paper():
    """15 cm/s, where a whole course is walked: 10 falls of 40 cost a quarter of it."""
    assert worth_cm_s(cell(NONE, 1, 20, 10, 40)) == pytest.approx(20 - 15 / 4)

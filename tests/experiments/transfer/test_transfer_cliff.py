import copy
import json

import numpy as np
import pytest
from matplotlib.image import imread

from experiments.transfer import cliff as transfer_cliff
from experiments.transfer.cliff import check_claims, cliff_figure, main
from experiments.transfer.cliff_study import (
    MOVES,
    TransferCliff,
    cliff_walking,
    intended_path,
)
from groundwalk.errors import BadValueError
from sgat.tabular.mdp import expected_return, policy_iteration

SMALL = {
    "rows": 3,
    "columns": 5,
    "noise": (0.0, 0.2, 0.6, 1.0),
    "episodes": 2000,
    "real_episodes": 2000,
}


def run(folder, **settings):
    main(TransferCliff(out=folder, **SMALL | settings))
    return json.loads((folder / "result.json").read_text())


@pytest.fixture(scope="module")
def small(tmp_path_factory):
    """A run on a small grid: its folder and its result."""
    folder = tmp_path_factory.mktemp("cliff") / "run"
    return folder, run(folder)


def toward(mdp, state, move):
    """Where a move leads, with certainty."""
    (after,) = np.flatnonzero(mdp.transition[state, list(MOVES).index(move)])
    return after


# The grid


def test_moves_and_walls():
    sim = cliff_walking(3, 4)
    # 0 1 2 3 / 4 5 6 7 / start 8, cliff 9 and 10, goal 11
    assert [toward(sim, 5, move) for move in MOVES] == [1, 9, 4, 6]
    assert [toward(sim, 0, move) for move in MOVES] == [0, 4, 0, 1]
    assert [toward(sim, 7, move) for move in MOVES] == [3, 11, 6, 7]
    assert [toward(sim, 8, move) for move in MOVES] == [4, 8, 8, 9]
    assert sim.start == 8
    assert list(np.flatnonzero(sim.ends)) == [9, 10, 11]
    np.testing.assert_allclose(sim.reward[7:], [-0.1, -0.1, -10.1, -10.1, 99.9])


def test_noise_is_a_chance_of_any_of_the_four_moves():
    real = cliff_walking(3, 4, noise=0.4)
    up = real.transition[5, list(MOVES).index("up")]
    np.testing.assert_allclose(up[[1, 9, 4, 6]], [0.7, 0.1, 0.1, 0.1])
    corner = real.transition[8, list(MOVES).index("up")]
    np.testing.assert_allclose(corner[[4, 8, 9]], [0.7, 0.2, 0.1])


@pytest.mark.parametrize(("rows", "columns"), [(2, 3), (4, 12)])
def test_without_noise_the_shortest_way_is_best(rows, columns):
    sim = cliff_walking(rows, columns)
    policy = policy_iteration(sim)
    path = np.array(intended_path(sim, policy))
    assert len(path) == columns + 2  # up, along the cliff, down
    assert set(path[1:-1] // columns) == {rows - 2}
    best = 100 - 0.1 * (columns + 1)
    assert expected_return(sim, policy, 100) == pytest.approx(best)


def test_nothing_but_noise_returns_what_follows_by_hand():
    # On 2 x 3 cells: the goal is reached with probability 1/11, after 64/11 steps.
    by_hand = 100 / 11 - 10 * 10 / 11 - 0.1 * 64 / 11
    for policy in np.zeros(6, int), np.full(6, 3):
        found = expected_return(cliff_walking(2, 3, noise=1), policy, 1000)
        assert found == pytest.approx(by_hand, abs=1e-9)


def test_a_way_that_leads_nowhere_ends():
    sim = cliff_walking(2, 3)
    assert intended_path(sim, np.zeros(6, int)) == [3, 0, 0]


# The study


def test_the_papers_claims_hold_on_a_small_grid(small):
    _, result = small
    assert len(result["claims"]) == 3
    assert all(claim["holds"] for claim in result["claims"])
    for row in result["rows"]:
        gat, sgat, best = (row["methods"][m] for m in ("GAT", "SGAT", "optimum"))
        assert best["exact"] - sgat["exact"] <= sgat["standard_error"] + 1e-9
        if row["noise"] in (0, 1):
            assert gat["mean"] == sgat["mean"]
            assert gat["exact"] == sgat["exact"]
        else:
            assert sgat["exact"] > gat["exact"] + 5
            assert sgat["mean"] > gat["mean"] + 5


def test_means_are_estimates_of_the_exact_returns(small):
    _, result = small
    for row in result["rows"]:
        for score in row["methods"].values():
            error = 4 * score["standard_error"] + 1e-9
            assert score["mean"] == pytest.approx(score["exact"], abs=error)
            assert score["cut"] == 0


def test_the_optimum_is_that_of_a_linear_program(small):
    from scipy.optimize import linprog

    _, result = small
    for row in result["rows"]:
        real = cliff_walking(SMALL["rows"], SMALL["columns"], row["noise"])
        inner = np.flatnonzero(~real.ends)
        # the least v with v >= P (r + v) for every state and action
        steps = real.transition[inner]
        bounds = np.eye(len(inner))[:, None] - steps[:, :, inner]
        found = linprog(
            np.ones(len(inner)),
            A_ub=-bounds.reshape(-1, len(inner)),
            b_ub=-(steps @ real.reward).ravel(),
            bounds=(None, None),
        )
        best = found.x[list(inner).index(real.start)]
        assert row["methods"]["optimum"]["exact"] == pytest.approx(best, abs=1e-6)


def test_gat_walks_along_the_cliff_and_sgat_keeps_off(small):
    _, result = small
    methods = result["rows"][1]["methods"]
    assert {row for row, _ in methods["GAT"]["path"]} == {1, 2}
    assert {row for row, _ in methods["SGAT"]["path"]} == {0, 1, 2}


def test_the_run_folder_holds_page_and_picture(small):
    folder, result = small
    page = (folder / "result.md").read_text()
    assert page.count("**holds**") == 3
    assert "3 x 5 cells" in page
    score = result["rows"][1]["methods"]["SGAT"]
    assert f"{score['mean']:.2f} ± {score['standard_error']:.2f}" in page
    rows, columns, _ = imread(folder / "transfer_cliff.png").shape
    assert rows < columns < 2400


def test_the_picture_shows_the_returns(small):
    _, result = small
    above, below = cliff_figure(result["rows"], (3, 5)).axes
    drawn = {c.get_label(): c.lines[0].get_xydata() for c in above.containers}
    for name, points in drawn.items():
        assert list(points[:, 0]) == list(SMALL["noise"])
        means = [row["methods"][name]["mean"] for row in result["rows"]]
        assert list(points[:, 1]) == means
    assert set(drawn) == {"no grounding", "GAT", "SGAT", "optimum"}
    assert "noise 0.6" in below.get_title()  # where SGAT is ahead most


@pytest.mark.parametrize(
    ("row", "method", "value", "change", "broken"),
    [
        (0, "GAT", "mean", 1e-3, 0),
        (-1, "GAT", "exact", 1e-3, 0),
        (1, "GAT", "mean", 200, 1),
        (2, "GAT", "exact", 200, 1),
        (1, "optimum", "exact", 50, 2),
    ],
)
def test_claims_can_fail(small, row, method, value, change, broken):
    rows = copy.deepcopy(small[1]["rows"])
    rows[row]["methods"][method][value] += change
    verdicts = [claim.holds for claim in check_claims(rows)]
    assert verdicts == [k != broken for k in range(3)]


def test_claims_are_made_only_of_what_was_tried(small):
    rows = small[1]["rows"]
    assert len(check_claims(rows[:1])) == 2
    assert len(check_claims(rows[1:3])) == 2


def test_a_killed_run_resumes_to_the_same_bits(small, tmp_path, monkeypatch):
    def killed(*_):
        raise KeyboardInterrupt

    whole, _ = small
    cut = tmp_path / "cut"
    monkeypatch.setattr(transfer_cliff, "check_claims", killed)
    with pytest.raises(KeyboardInterrupt):
        run(cut)
    history = json.loads((cut / "history.json").read_text())
    history["rows"] = history["rows"][:2]
    (cut / "history.json").write_text(json.dumps(history))
    monkeypatch.undo()
    main(TransferCliff(resume=cut))
    assert (cut / "result.json").read_bytes() == (whole / "result.json").read_bytes()


def test_another_seed_gives_other_returns(small, tmp_path):
    other = run(tmp_path / "run", seed=2, noise=(0.2,))
    mean = other["rows"][0]["methods"]["SGAT"]["mean"]
    assert mean != small[1]["rows"][1]["methods"]["SGAT"]["mean"]


@pytest.mark.parametrize(
    ("settings", "message"),
    [
        ({"rows": 1}, "the grid is 1 x 12"),
        ({"columns": 2}, "the grid is 4 x 2"),
        ({"noise": ()}, "noise is"),
        ({"noise": (0.5, 1.2)}, "noise is"),
        ({"episodes": 1}, "episodes is 1"),
        ({"real_episodes": 0}, "episodes is 0"),
        ({"seed": -1}, "seed is -1"),
    ],
)
def test_what_no_run_can_do_is_refused(settings, message):
    with pytest.raises(BadValueError, match=message):
        TransferCliff(**settings)

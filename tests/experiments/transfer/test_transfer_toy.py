import dataclasses
import json

import numpy as np
import pytest

from experiments.transfer import toy as transfer_toy
from experiments.transfer.toy import TOYS, TransferToy, choice, main, solve
from groundwalk.errors import BadValueError, GroundwalkError

# Values by hand from the paper's figures: 0.8 * -1 + 0.2 * 10 = 1.2.
BY_HAND = {
    "deterministic": {
        "sim": ([1, -1], "a1", -1),
        "GAT": ([-1, 1], "a2", 1),
        "SGAT": ([-1, 1], "a2", 1),
        "real": ([-1, 1], "a2", 1),
    },
    "stochastic": {
        "sim": ([1, -1, 10], "a3", -1),
        "GAT": ([1, -1, -1], "a1", 1),
        "SGAT": ([1, 1.2, -1], "a2", 1.2),
        "real": ([1, 1.2, -1], "a2", 1.2),
    },
}


def run(tmp_path, name="run", **settings):
    main(TransferToy(out=tmp_path / name, **settings))
    return json.loads((tmp_path / name / "result.json").read_text())


@pytest.mark.parametrize("name", TOYS)
def test_the_best_actions_are_those_of_the_paper_exactly(name):
    rows = solve(TOYS[name], 30_000, np.random.default_rng(1))
    assert [row["world"] for row in rows] == list(BY_HAND[name])
    for row in rows:
        values, best, worth = BY_HAND[name][row["world"]]
        np.testing.assert_allclose(row["values"], values, rtol=1e-12)
        assert row["best"] == row["paper"] == row["from_counts"] == best
        assert row["worth_on_real"] == pytest.approx(worth)


def test_the_run_folder_holds_what_was_found(tmp_path):
    result = run(tmp_path)
    assert [claim["holds"] for claim in result["claims"]] == [True, True]
    page = (tmp_path / "run" / "result.md").read_text()
    assert page.count("**holds**") == 2
    assert "| stochastic | SGAT | 1, 1.2, -1 | a2 | a2 | a2 | 1.2 |" in page


def test_what_the_paper_does_not_say_does_not_hold(tmp_path, monkeypatch):
    toy = TOYS["stochastic"]
    wrong = dataclasses.replace(toy, best=toy.best | {"GAT": "a2"})
    monkeypatch.setattr(transfer_toy, "TOYS", {"stochastic": wrong})
    assert [claim["holds"] for claim in run(tmp_path)["claims"]] == [False]
    assert "**does not hold**" in (tmp_path / "run" / "result.md").read_text()


def test_without_noise_in_the_real_world_gat_finds_its_optimum():
    toy = TOYS["stochastic"]
    real = choice([1, -1, 10], [[1, 0, 0], [0, 0, 1], [0, 1, 0]])
    calm = dataclasses.replace(toy, real=real)
    rows = solve(calm, 100, np.random.default_rng(1))
    assert [row["best"] for row in rows] == ["a3", "a2", "a2", "a2"]


def test_a_resumed_run_keeps_its_result(tmp_path, capsys):
    result = run(tmp_path)
    capsys.readouterr()
    main(TransferToy(resume=tmp_path / "run", json=True))
    assert json.loads(capsys.readouterr().out) == result
    with pytest.raises(GroundwalkError, match="seed cannot change"):
        main(TransferToy(resume=tmp_path / "run", seed=2))


@pytest.mark.parametrize("settings", [{"episodes": 0}, {"seed": -1}])
def test_what_no_run_can_do_is_refused(settings):
    with pytest.raises(BadValueError, match=next(iter(settings))):
        TransferToy(**settings)

import copy
import dataclasses
import json
import shutil

import pytest
from made_once import made_once
from matplotlib.image import imread

from experiments.transfer import gym_domains
from experiments.transfer.gym_domains import (
    TransferHalfCheetah,
    TransferInvertedPendulum,
)
from experiments.transfer.gym_studies.page import check_claims, returns_figure, rows_of
from experiments.transfer.gym_studies.study import METHODS
from groundwalk.errors import BadValueError, UnknownNameError


@pytest.fixture(scope="module")
def pendulum(tmp_path_factory):
    """A smoke run with every method: its folder."""

    def run(folder):
        gym_domains.main(TransferInvertedPendulum(size="smoke", out=folder / "run"))

    return made_once(tmp_path_factory, "pendulum", run) / "run"


def result_of(folder):
    return json.loads((folder / "result.json").read_text())


def made_up_cells(**returns):
    """Cells of one world; a method's returns by seed."""
    return [
        {"setting": "noisy-real", "noise": 0.5, "method": name, "seed": seed}
        | {way: {"mean": value, "std": 0.0} for way in ("deterministic", "stochastic")}
        | {"real_steps": 10 * seed}
        for name, values in returns.items()
        for seed, value in enumerate(values)
    ]


@pytest.mark.slow
def test_a_smoke_run_tries_every_method(pendulum):
    (row,) = result_of(pendulum)["rows"]
    assert (row["setting"], row["noise"]) == ("noisy-real", 0.5)
    assert tuple(row["methods"]) == METHODS
    for method in row["methods"].values():
        assert method["seeds"] == 2
        for way in ("deterministic", "stochastic"):
            assert 0 < method[way]["mean"] <= 1000
    assert row["methods"]["none"]["real_steps"] == 0
    assert row["methods"]["gat"]["real_steps"] == 200
    assert row["methods"]["ane"]["real_steps"] > 0
    assert row["methods"]["sgat"]["inverse_r_squared"] > 0.5
    assert imread(pendulum / "transfer_inverted_pendulum.png").ndim == 3
    page = (pendulum / "result.md").read_text()
    assert "The grid is smoke: 2 seeds" in page


@pytest.mark.slow
def test_resuming_computes_only_what_is_missing(pendulum, tmp_path, in_this_process):
    pendulum = shutil.copytree(pendulum, tmp_path / "run")
    before = result_of(pendulum)
    lost, kept = (
        pendulum / f"cells/noisy-real_{m}_0.5_s1.json" for m in ("sgat", "gat")
    )
    lost.unlink()
    marked = json.loads(kept.read_text()) | {"kept": True}
    kept.write_text(json.dumps(marked))
    gym_domains.main(TransferInvertedPendulum(resume=pendulum))
    after = result_of(pendulum)
    assert sum(cell.pop("kept", False) for cell in after["cells"]) == 1
    # the lost cell came out the same, in another process
    assert after == before


@pytest.mark.slow
def test_the_cheetah_has_both_settings(tmp_path, capsys, in_this_process):
    options = TransferHalfCheetah(
        size="smoke",
        episodes=2,
        methods=("sgat",),
        out=tmp_path / "run",
        json=True,
    )
    gym_domains.main(options)
    result = json.loads(capsys.readouterr().out)
    assert [row["setting"] for row in result["rows"]] == ["noisy-sim", "noisy-real"]
    assert not (tmp_path / "run" / "policies" / "ane_0.2_s0.zip").exists()


def test_returns_are_means_over_seeds_with_their_standard_errors():
    (row,) = rows_of(made_up_cells(gat=[1.0, 2.0, 6.0]))
    gat = row["methods"]["gat"]
    assert gat["deterministic"]["mean"] == pytest.approx(3)
    assert gat["deterministic"]["standard_error"] == pytest.approx((7 / 3) ** 0.5)
    assert gat["real_steps"] == pytest.approx(10)


def test_the_claim_can_fail():
    for sgat, holds in (([4.0, 6.0], True), ([1.0, 2.0], False)):
        (claim,) = check_claims(rows_of(made_up_cells(gat=[2.0, 3.0], sgat=sgat)))
        assert claim.holds is holds
    # 1 - 2 and 2 - 3: the same for both seeds
    assert claim.found.endswith("seed by seed -1.0 ± 0.0 more")
    assert check_claims(rows_of(made_up_cells(gat=[2.0, 3.0]))) == []


def test_it_is_told_whether_real_is_the_upper_line():
    for real, holds in (([9.0, 9.0], True), ([4.0, 5.0], False)):
        (claim,) = check_claims(rows_of(made_up_cells(gat=[5.0, 5.0], real=real)))
        assert claim.holds is holds
        assert f"best is {'real' if holds else 'gat'}" in claim.found


def test_the_claim_is_about_the_noisiest_world():
    calm = made_up_cells(gat=[2.0, 3.0], sgat=[4.0, 6.0])
    noisy = copy.deepcopy(calm)
    for cell in calm:
        cell["noise"] = 0.1
    for cell in noisy:
        cell["deterministic"]["mean"] *= -1
    (claim,) = check_claims(rows_of(calm + noisy))
    assert not claim.holds
    assert "noise 0.5" in claim.text


def test_the_figure_has_a_bar_for_each_method_and_a_line_for_real():
    cells = made_up_cells(gat=[2.0, 4.0], sgat=[5.0, 5.0], real=[9.0, 9.0])
    (axes,) = returns_figure(rows_of(cells)).axes
    assert [bar.get_height() for bar in axes.patches] == [3, 5]
    assert list(axes.get_lines()[-1].get_ydata()) == [9, 9]


@pytest.mark.parametrize(
    ("options", "error"),
    [
        ({"seeds": 1}, BadValueError),
        ({"episodes": 1}, BadValueError),
        ({"noises": (-0.1,)}, BadValueError),
        ({"noises": ()}, BadValueError),
        ({"methods": ("gatt",)}, UnknownNameError),
        ({"methods": ()}, BadValueError),
        ({"timesteps": 0}, BadValueError),
        ({"threads": 0}, BadValueError),
        ({"seed": -1}, BadValueError),
    ],
)
def test_what_no_run_can_do_is_refused(options, error):
    with pytest.raises(error):
        TransferInvertedPendulum(**options)


@pytest.mark.parametrize("size", ["full", "reduced", "smoke"])
def test_given_options_take_the_place_of_the_sizes(size):
    study = TransferHalfCheetah(size=size).study()
    assert TransferHalfCheetah(size=size, seeds=7).study() == dataclasses.replace(
        study, seeds=7
    )
    assert size != "full" or study.seeds == 10

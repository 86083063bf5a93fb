import json

import numpy as np
import pytest

from experiments.grounded_walks.models import GAT, NONE, SGAT, UNEVEN
from experiments.runs.folder import HISTORY, RunFolder
from experiments.transfer.nao_falls import TransferNaoFalls, main
from experiments.transfer.nao_studies.falls import (
    FIGURE,
    GROUNDINGS,
    MEASURES,
    MEASURES_FIGURE,
    correlation,
    correlation_interval,
    prediction_rows,
)
from groundwalk.errors import BadValueError
from sgat.walks.gait_cloud import GaitCloud
from walk_engine import gaits
from walk_engine.gait import NAMES

SMOKE = {"gaits": 2, "trials": 2, "rollouts": 2, "real_walks": 2, "sim_walks": 2}


def state_of(real, **predicted):
    speeds = [10.0, 20.0, 30.0]
    state = {"real": {"fall_rate": real, "speed_cm_s": speeds}}
    for name in GROUNDINGS:
        rates = predicted.get(name, [0.0, 0.0, 0.0])
        state[name] = {"fall_rate": rates, "speed_cm_s": speeds}
    return state


@pytest.mark.slow
@pytest.mark.usefixtures("short_walks")
def test_a_small_study_runs_and_resumes_to_the_same_numbers(tmp_path):
    whole = RunFolder(tmp_path / "whole")
    main(TransferNaoFalls(**SMOKE, out=whole.path, json=True))
    result = whole.read_json("result.json")
    assert [row["grounding"] for row in result["predictions"]] == list(GROUNDINGS)
    kept = {path.name for path in whole.path.iterdir()}
    assert {"result.md", FIGURE, MEASURES_FIGURE, HISTORY} <= kept
    # as if killed when half of the predictions were made
    history = whole.read_json(HISTORY)
    cut = {name: history[name] for name in ("real", MEASURES, NONE, SGAT)}
    whole.write_json(HISTORY, cut)
    main(TransferNaoFalls(resume=whole.path, json=True))
    assert whole.read_json("result.json") == result
    assert whole.read_json(HISTORY) == history


def test_predictions_are_held_against_real():
    exact, off = [0.0, 0.5, 1.0], [0.1, 0.6, 1.0]
    rows = prediction_rows(state_of(exact, **{SGAT: exact, GAT: off}))
    by_name = {row["grounding"]: row["fall_rate"] for row in rows}
    assert by_name[SGAT]["correlation"] == pytest.approx(1.0)
    assert by_name[SGAT]["rmse"] == 0.0
    assert by_name[GAT]["rmse"] == pytest.approx(np.sqrt(0.02 / 3))
    assert by_name[UNEVEN]["correlation"] is None
    assert by_name[UNEVEN]["predicted_mean"] == 0.0
    assert json.dumps(rows)


def test_a_constant_prediction_has_no_correlation():
    assert correlation(np.zeros(3), np.arange(3.0)) is None
    assert correlation(-np.arange(3.0), np.arange(3.0)) == pytest.approx(-1.0)


def test_the_interval_of_a_correlation():
    # textbook: r = 0.5 of 28 pairs; atanh(0.5) = 0.5493, 1.96 / 5 = 0.392
    low, high = correlation_interval(0.5, 28)
    assert low == pytest.approx(np.tanh(0.5493 - 0.392), abs=1e-3)
    assert high == pytest.approx(np.tanh(0.5493 + 0.392), abs=1e-3)
    assert correlation_interval(0.5, 3) == (-1.0, 1.0)


def test_a_cloud_of_gaits_lies_around_its_middle():
    start = gaits.get("start")
    cloud = GaitCloud(spread=0.05)
    vectors = cloud.draw(start, 400, np.random.SeedSequence(1))
    column = NAMES.index("step_period")
    assert vectors[:, column].mean() == pytest.approx(start["step_period"], abs=0.002)
    assert vectors[:, column].std() == pytest.approx(0.05 * 0.18, rel=0.15)
    speeds = vectors[:, NAMES.index("max_forward")]
    assert 0.12 <= speeds.min() < 0.14
    assert 0.38 < speeds.max() <= 0.40


def test_too_small_a_study_is_refused():
    with pytest.raises(BadValueError, match="gaits is 1"):
        TransferNaoFalls(gaits=1)

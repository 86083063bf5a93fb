import json

import numpy as np
import pytest
from made_up_runs import history
from rerun.chunk import RrdReader

from experiments.run_folder import RunFolder
from experiments.visualize_search import read_history, visualize_search
from groundwalk.errors import RunFolderError
from walk_engine import gaits
from walk_engine.gait import NAMES, PARAMETERS


@pytest.fixture
def folder(tmp_path):
    return RunFolder(tmp_path)


def noted(generations, **more):
    start = dict(gaits.get("start"))
    entries = history(generations)
    return [
        {**one, "mean_gait": start, "spread": [0.1] * 16, **more} for one in entries
    ]


def test_columns_are_what_the_search_noted():
    best = dict(gaits.get("walk2014"))
    found = read_history(noted(3, best_gait=best))
    np.testing.assert_array_equal(found.mean_reward, [0.5, 1.5, 2.5])
    np.testing.assert_array_equal(found.falls, [1, 1, 1])
    assert tuple(found.mean) == tuple(found.best) == NAMES
    period = PARAMETERS[0]
    np.testing.assert_allclose(
        found.spread["step_period"], 0.1 * (period.high - period.low)
    )
    assert found.best["step_period"].tolist() == [best["step_period"]] * 3
    assert found.units["step_period"] == "s"


def test_histories_of_earlier_versions_have_no_best_gait():
    assert read_history(noted(2)).best == {}
    found = read_history([*noted(1), *noted(1, best_gait=dict(gaits.get("start")))])
    assert np.isnan(found.best["hip_height"]).tolist() == [True, False]


def test_a_run_s_search_becomes_a_file(folder):
    folder.write_json("history.json", {"generations": history(2)})
    path = visualize_search(folder)
    assert path == folder.path / "search.rrd"
    first = {chunk.entity_path for chunk in RrdReader(path).stream().to_chunks()}
    assert "/search/reward/tried" in first


def test_no_history_is_no_search(folder):
    assert visualize_search(folder) is None


@pytest.mark.parametrize(
    "content",
    [
        {},
        {"generations": []},
        {"generations": [{"rewards": [1]}]},
        {"generations": [{**history(1)[0], "rewards": ["much"]}]},
    ],
)
def test_a_damaged_history_is_named(folder, content):
    folder.write_text("history.json", json.dumps(content))
    with pytest.raises(RunFolderError, match=r"history\.json"):
        visualize_search(folder)
    assert not (folder.path / "search.rrd").exists()

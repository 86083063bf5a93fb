import json
import shutil
from functools import partial

import numpy as np
import pytest
from made_once import made_once
from made_up_runs import history
from rerun.chunk import RrdReader
from short_walks import SEARCHED, shorten_searches

from experiments.optimize_gait import OptimizeGait
from experiments.runs.folder import RunFolder
from experiments.seeing.visualize_search import (
    read_history,
    search_plan,
    visualize_search,
    walk_again,
)
from experiments.walking.gait_search import SearchPlan, rate, search_gait
from groundwalk.errors import BadModelError, RunFolderError, UnknownNameError
from terrain import TerrainSpec
from walk_engine import Gait, gaits
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


def entities(path):
    return {chunk.entity_path for chunk in RrdReader(path).stream().to_chunks()}


def pages(path):
    """What is said of each generation."""
    stream = RrdReader(path).stream().filter(content="/search/gait")
    batches = [chunk.to_record_batch() for chunk in stream.to_chunks()]
    columns = [batch.column("TextDocument:text") for batch in batches]
    return [page for column in columns for page in column.flatten().to_pylist()]


def has_robot(path):
    return any(entity.startswith("/search/walk/robot/") for entity in entities(path))


def searched(folder, entries, **config):
    """The folder of a search with this history; of its config only what counts."""
    folder.write_json("config.json", {"verb": "optimize-gait", **config})
    folder.write_json("history.json", {"generations": entries})
    return folder


def late_sim(folder):
    """A folder with what a diagnosis could have found."""
    late = {
        "name": "command_latency",
        "place": "commands",
        "parameters": {"delay": 0.04},
    }
    found = {"format": 1, "robot": "nao", "base": "fixed", "native": [late]}
    folder.mkdir()
    (folder / "corrected.json").write_text(json.dumps({**found, "per_tick": []}))
    return folder


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
    assert "/search/reward/tried" in entities(path)


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


def run_search(path, **settings):
    """A small search on lumps, as `optimize-gait` runs it."""
    config = OptimizeGait(
        terrain="lumps:amplitude_m=0.008",
        population=4,
        generations=2,
        ratings=1,
        seed=3,
        threads=1,
        out=path,
        **settings,
    )
    folder = RunFolder.create("optimize-gait", config)
    search_gait(config.plan(), folder)
    return folder


@pytest.fixture(scope="module", autouse=True)
def short_walks():
    """Let searches, and walks of their gaits afterwards, be short."""
    with pytest.MonkeyPatch.context() as patch:
        shorten_searches(patch)
        again = partial(rate, rules=SEARCHED)
        patch.setattr("experiments.seeing.visualize_search.rate", again)
        yield


@pytest.fixture(scope="module")
def real_search(short_walks, tmp_path_factory):
    def run(folder):
        run_search(folder / "run")

    return RunFolder(made_once(tmp_path_factory, "search", run) / "run")


def walked(folder, **changes):
    """The best gaits of a run's search, walking again; the config may be another."""
    stored = folder.read_json("config.json") | changes
    entries = folder.read_json("history.json")["generations"]
    best = [Gait.from_mapping(entry["best_gait"]) for entry in entries]
    return entries, walk_again(search_plan(stored), best)


def test_the_walks_are_the_ones_that_were_rated(real_search):
    """To the last bit: grounds and rules are those of the search."""
    entries, walks = walked(real_search)
    best = [max(entry["rewards"]) for entry in entries]
    assert [walk.reward for walk in walks] == best
    for walk in walks:
        recording = walk.scene.recording
        made = TerrainSpec.from_json(recording.metadata.terrain).make()
        np.testing.assert_array_equal(walk.scene.ground.heights_m, made.heights_m)
        way_m = np.ptp(recording.vector("base.position")[:, 0])
        assert walk.distance_m == pytest.approx(way_m, abs=0.05)


@pytest.mark.parametrize("other", [{"terrain": "flat"}, {"seed": 4}])
def test_on_other_ground_they_are_not(real_search, other):
    entries, walks = walked(real_search, **other)
    best = [max(entry["rewards"]) for entry in entries]
    assert [walk.reward for walk in walks] != best


@pytest.mark.slow
def test_they_walk_in_the_sim_of_the_search_and_in_no_other(tmp_path):
    folder = run_search(tmp_path / "run", sim=late_sim(tmp_path / "found"))
    for sim, is_same in ((str(tmp_path / "found"), True), (None, False)):
        entries, walks = walked(folder, sim=sim)
        best = [max(entry["rewards"]) for entry in entries]
        assert ([walk.reward for walk in walks] == best) == is_same


def test_a_search_shows_its_best_gaits_walk(real_search, tmp_path):
    run = shutil.copytree(real_search.path, tmp_path / "run")
    path = visualize_search(RunFolder(run))
    assert has_robot(path)
    assert path.stat().st_size < 1_500_000
    for page in pages(path):
        assert "The best gait walked" in page
        assert "**" not in page


def test_a_history_without_best_gaits_has_no_robot(folder):
    path = visualize_search(searched(folder, noted(2)))
    assert not has_robot(path)
    assert not any("The best gait" in page for page in pages(path))


def test_nor_has_one_that_knows_only_some(folder):
    some = [*noted(1), *noted(1, best_gait=dict(gaits.get("start")))]
    assert not has_robot(visualize_search(searched(folder, some)))


@pytest.mark.parametrize(
    ("config", "words"),
    [
        ({"sim": "gone"}, "gone: no such folder or file"),
        ({"robot": "nano"}, "unknown robot 'nano'"),
        ({"verb": "transfer-nao"}, "'transfer-nao'"),
    ],
)
def test_a_search_that_cannot_walk_here_is_shown_without_robots(folder, config, words):
    entries = noted(1, best_gait=dict(gaits.get("start")))
    path = visualize_search(searched(folder, entries, **config))
    assert not has_robot(path)
    assert words in pages(path)[0]


def test_a_gait_that_is_none_is_named(folder):
    path = visualize_search(searched(folder, noted(1, best_gait={"hip": 1.0})))
    assert not has_robot(path)
    assert "unknown gait parameter 'hip'" in pages(path)[0]


def test_a_reward_that_has_changed_is_said(folder):
    entries = noted(1, best_gait=dict(gaits.get("start")))
    path = visualize_search(searched(folder, entries, terrain="flat"))
    assert has_robot(path)
    assert "the search found 3.0" in pages(path)[0]


@pytest.mark.parametrize(
    ("stored", "error"),
    [({"robot": "nano"}, UnknownNameError), ({"sim": "gone"}, BadModelError)],
)
def test_what_a_config_names_must_be_there(stored, error):
    with pytest.raises(error):
        search_plan(stored)


def test_a_config_of_an_earlier_version_says_less():
    assert search_plan({"seed": 5, "verb": "optimize-gait"}) == SearchPlan(seed=5)

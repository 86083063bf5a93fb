import json
import os

import numpy as np
import pytest
from made_up_runs import history, steady

from experiments.runs.folder import RunFolder
from experiments.seeing.run_pictures import picture_run, picture_search
from experiments.walking.evaluation import Study, evaluate
from experiments.walking.trials import TrialRules
from groundwalk.errors import RunFolderError
from walk_engine import gaits
from worlds import write_recording


@pytest.fixture
def folder(tmp_path):
    return RunFolder(tmp_path)


def test_a_run_gets_all_its_pictures(folder):
    folder.write_json("history.json", {"generations": history(2)})
    for name in ("sim_start", "real_start"):
        write_recording(steady(), folder.path / "recordings" / f"{name}.parquet")
    picture_run(folder)
    for name in ("search.png", "walk.png"):
        assert (folder.path / name).read_bytes().startswith(b"\x89PNG")
    assert (folder.path / "walk.rrd").read_bytes().startswith(b"RRF")


def test_what_the_sim_records_can_be_shown(folder, nao):
    study = Study("sim", "stairs", trials=1, rules=TrialRules(limit_s=0.3))
    walks = {"start": gaits.get("start")}
    outcomes = evaluate(study, nao, walks, np.random.SeedSequence(1))
    path = folder.path / "recordings" / "sim_start.parquet"
    write_recording(outcomes["start"].recording, path)
    picture_run(folder)
    assert (folder.path / "walk.png").is_file()
    assert (folder.path / "walk.rrd").is_file()


def test_a_run_without_search_or_recordings_gets_no_pictures(folder):
    folder.write_json("result.json", {})
    picture_run(folder)
    assert [path.name for path in folder.path.iterdir()] == ["result.json"]
    assert picture_search(folder) is None


def test_a_search_is_drawn_again_only_after_it_went_on(folder):
    folder.write_json("history.json", {"generations": history(2)})
    picture = picture_search(folder)
    picture.write_bytes(b"drawn before")
    assert picture_search(folder) == picture
    assert picture.read_bytes() == b"drawn before"
    later_s = picture.stat().st_mtime + 10
    os.utime(folder.path / "history.json", (later_s, later_s))
    picture_search(folder)
    assert picture.read_bytes().startswith(b"\x89PNG")


@pytest.mark.parametrize("content", ["{", json.dumps({}), '{"generations": []}'])
def test_a_damaged_history_is_named(folder, content):
    folder.write_text("history.json", content)
    with pytest.raises(RunFolderError, match=r"history\.json"):
        picture_search(folder)

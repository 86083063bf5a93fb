import json

import numpy as np
import pytest

from experiments.walking.search import GaitSearch, best_mean, run_search
from groundwalk.errors import RunFolderError
from walk_engine import gaits
from walk_engine.gait import PARAMETERS

START = gaits.get("start")
FASTER = [parameter.name for parameter in PARAMETERS].index("max_forward")


def begin():
    return GaitSearch(START, 8, 0.15, np.random.SeedSequence(2))


def faster_is_better(number, search):
    tried = search.ask()
    search.tell(tried[:, FASTER])
    return {"mean_reward": float(search.mean["max_forward"])}


def test_a_search_keeps_the_mean_gaits_from_its_start_to_its_last(tmp_path):
    noted = []
    means = run_search(tmp_path / "s.json", begin, faster_is_better, 3, noted.append)
    assert means.shape == (4, len(PARAMETERS))
    np.testing.assert_allclose(means[0], START.to_vector())
    kept = [entry["mean_gait"]["max_forward"] for entry in noted[-1]]
    np.testing.assert_array_equal(kept, means[:-1, FASTER])
    # A generation is told of after it: the next mean is the one that it came to.
    ends = [entry["mean_reward"] for entry in noted[-1]]
    np.testing.assert_array_equal(ends, means[1:, FASTER])


def test_a_search_that_goes_on_has_the_same_mean_gaits(tmp_path):
    whole = run_search(tmp_path / "whole.json", begin, faster_is_better, 4)
    run_search(tmp_path / "cut.json", begin, faster_is_better, 2)
    again = run_search(tmp_path / "cut.json", begin, faster_is_better, 4)
    np.testing.assert_array_equal(again, whole)


def test_a_checkpoint_of_an_earlier_version_is_refused_and_not_opened(tmp_path):
    path = tmp_path / "search.json"
    path.with_suffix(".pkl").write_bytes(b"a pickle")
    with pytest.raises(RunFolderError, match=r"search\.pkl is of an earlier version"):
        run_search(path, begin, faster_is_better, 2)
    assert not path.exists()


def test_a_checkpoint_of_another_search_is_refused(tmp_path):
    path = tmp_path / "search.json"
    run_search(path, begin, faster_is_better, 3)
    kept = path.read_bytes()
    others = {
        "another search": GaitSearch(START, 8, 0.15, np.random.SeedSequence(3)),
        "another size": GaitSearch(START, 9, 0.15, np.random.SeedSequence(2)),
    }
    for words, other in others.items():
        with pytest.raises(RunFolderError, match=words):
            run_search(path, lambda other=other: other, faster_is_better, 4)
    assert path.read_bytes() == kept


@pytest.mark.parametrize(
    "change",
    [
        {"rewards": []},
        {"history": [{"mean_reward": 1.0}]},
        {"rewards": "none"},
        {"history": 3},
    ],
)
def test_a_damaged_checkpoint_is_refused(tmp_path, change):
    path = tmp_path / "search.json"
    run_search(path, begin, faster_is_better, 1)
    path.write_text(json.dumps({**json.loads(path.read_text()), **change}))
    with pytest.raises(RunFolderError, match="is damaged"):
        run_search(path, begin, faster_is_better, 2)


@pytest.mark.parametrize(
    ("ratings", "best"),
    [
        ([[1.0, 3.0, 2.0]], 1),
        # One rating may be luck: the last is the best on average.
        ([[1.0, 3.0, 2.5], [1.0, -9.0, 2.5]], 2),
    ],
)
def test_the_best_mean_gait_is_so_on_average(ratings, best):
    means = np.array(
        [START.replace(max_forward=v).to_vector() for v in (0.1, 0.2, 0.3)]
    )
    found = best_mean(means, np.array(ratings))
    np.testing.assert_array_equal(found.to_vector(), means[best])

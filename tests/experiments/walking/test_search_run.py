import pickle

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
    means = run_search(tmp_path / "s.pkl", begin, faster_is_better, 3, noted.append)
    assert means.shape == (4, len(PARAMETERS))
    np.testing.assert_allclose(means[0], START.to_vector())
    kept = [entry["mean_gait"]["max_forward"] for entry in noted[-1]]
    np.testing.assert_array_equal(kept, means[:-1, FASTER])
    # A generation is told of after it: the next mean is the one that it came to.
    ends = [entry["mean_reward"] for entry in noted[-1]]
    np.testing.assert_array_equal(ends, means[1:, FASTER])


def test_a_search_that_goes_on_has_the_same_mean_gaits(tmp_path):
    whole = run_search(tmp_path / "whole.pkl", begin, faster_is_better, 4)
    run_search(tmp_path / "cut.pkl", begin, faster_is_better, 2)
    again = run_search(tmp_path / "cut.pkl", begin, faster_is_better, 4)
    np.testing.assert_array_equal(again, whole)


def test_a_checkpoint_without_mean_gaits_is_refused(tmp_path):
    old = {"search": begin().to_bytes(), "history": [{"mean_reward": 1.0}]}
    path = tmp_path / "search.pkl"
    path.write_bytes(pickle.dumps(old))
    with pytest.raises(RunFolderError, match=r"search\.pkl is of an earlier version"):
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

import numpy as np
import pytest

from experiments.walking.search import RATINGS, Budget, tune
from walk_engine import gaits
from walk_engine.gait import PARAMETERS

BUDGET = Budget(population=8, generations=6, sigma=0.15)
FASTER = [parameter.name for parameter in PARAMETERS].index("max_forward")


class Slope:
    """The faster the better; beyond a cliff all fall, but only means are seen there."""

    def __init__(self, cliff_m_s):
        self.cliff_m_s, self.rated, self.means = cliff_m_s, 0, None

    def __call__(self, vectors, seed):
        self.rated += len(vectors)
        speeds = vectors[:, FASTER].copy()
        if len(vectors) == BUDGET.population + 1:
            return speeds
        self.means = speeds.copy()
        return np.where(speeds > self.cliff_m_s, -1.0, speeds)


@pytest.mark.parametrize("cliff_m_s", [0.30, np.inf])
def test_a_mean_that_went_over_a_cliff_is_not_what_a_search_finds(tmp_path, cliff_m_s):
    rater, seed = Slope(cliff_m_s), np.random.SeedSequence(2)
    found = tune(tmp_path / "search.json", gaits.get("start"), BUDGET, rater, seed)
    assert rater.means[-1] > 0.30
    safe = rater.means[rater.means <= cliff_m_s]
    assert found["max_forward"] == pytest.approx(safe.max())


def test_a_finished_search_finds_the_same_again(tmp_path):
    def found(rater):
        seed = np.random.SeedSequence(2)
        return tune(tmp_path / "search.json", gaits.get("start"), BUDGET, rater, seed)

    assert dict(found(Slope(0.30))) == dict(found(again := Slope(0.30)))
    assert again.rated == RATINGS * (BUDGET.generations + 1)


def test_a_budget_counts_every_walk(tmp_path):
    rater, seed = Slope(np.inf), np.random.SeedSequence(2)
    tune(tmp_path / "search.json", gaits.get("start"), BUDGET, rater, seed)
    assert rater.rated == BUDGET.rated

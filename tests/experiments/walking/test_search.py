import numpy as np
import pytest

from experiments.walking.search import GaitSearch
from groundwalk.errors import BadValueError
from walk_engine import gaits
from walk_engine.gait import from_unit, to_unit

TARGET = np.linspace(0.2, 0.8, 16)


def bowl(vectors):
    """A reward whose only optimum is known: TARGET, in scaled parameters."""
    return -np.sum((to_unit(vectors) - TARGET) ** 2, axis=1)


def new_search(seed=1, population=20):
    start = gaits.get("start")
    return GaitSearch(start, population, 0.15, np.random.SeedSequence(seed))


def run(search, generations):
    told = []
    for _ in range(generations):
        vectors = search.ask()
        rewards = bowl(vectors)
        search.tell(rewards)
        told.append(rewards)
    return np.array(told)


def test_the_mean_finds_a_known_optimum():
    search = new_search()
    run(search, 150)
    np.testing.assert_allclose(to_unit(search.mean.to_vector()), TARGET, atol=0.02)
    worse = new_search()
    run(worse, 3)
    assert np.abs(to_unit(worse.mean.to_vector()) - TARGET).max() > 0.05


def test_candidates_stay_within_bounds():
    search = GaitSearch(gaits.get("start"), 50, 1.0, np.random.SeedSequence(1))
    unit = to_unit(search.ask())
    assert unit.min() >= 0
    assert unit.max() <= 1


def test_the_first_mean_is_the_start():
    start = gaits.get("start").to_vector()
    np.testing.assert_allclose(new_search().mean.to_vector(), start, rtol=1e-12)


def test_same_seed_same_bits_and_another_seed_others():
    np.testing.assert_array_equal(run(new_search(1), 5), run(new_search(1), 5))
    assert (run(new_search(1), 5) != run(new_search(2), 5)).any()


def test_the_same_rewards_bring_it_back_without_any_difference():
    search, again = new_search(), new_search()
    run(search, 4)
    for rewards in search.told:
        again.ask()
        again.tell(np.array(rewards))
    np.testing.assert_array_equal(run(search, 4), run(again, 4))


def test_numpys_global_generator_neither_matters_nor_moves():
    np.random.seed(1)
    before = np.random.get_state()[1].copy()
    first = run(new_search(), 3)
    np.testing.assert_array_equal(np.random.get_state()[1], before)
    np.random.seed(2)
    np.testing.assert_array_equal(run(new_search(), 3), first)


@pytest.mark.parametrize(("population", "sigma"), [(3, 0.1), (10, 0.0), (10, 1.5)])
def test_impossible_settings_are_refused(population, sigma):
    seed = np.random.SeedSequence(1)
    with pytest.raises(BadValueError):
        GaitSearch(gaits.get("start"), population, sigma, seed)


def test_scaling_is_the_identity_there_and_back():
    vector = gaits.get("walk2014").to_vector()
    np.testing.assert_allclose(from_unit(to_unit(vector)), vector, rtol=1e-12)

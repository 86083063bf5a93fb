import numpy as np
import pytest

from diagnosis.conclude.block_errors import block_variance

BLOCKS, ROWS = 128, 10
BLOCK = np.repeat(np.arange(BLOCKS), ROWS)


def means(blocks_alike, seed):
    """Errors that are the same for so many blocks, and their variance as a sum."""
    random = np.random.default_rng(seed)
    steps = random.standard_normal(BLOCKS // blocks_alike)
    return np.repeat(steps, blocks_alike * ROWS)[:, None]


@pytest.mark.parametrize("blocks_alike", [1, 4])
def test_errors_count_for_as_long_as_they_are_alike(blocks_alike):
    truth = BLOCKS * ROWS**2 * blocks_alike
    found = [block_variance(means(blocks_alike, seed), BLOCK) for seed in range(40)]
    assert np.mean(found) == pytest.approx(truth, rel=0.2)


def test_values_are_judged_each_on_its_own():
    pair = np.hstack([means(1, 3), means(8, 4)])
    both = block_variance(pair, BLOCK)
    assert both[0] == block_variance(pair[:, :1], BLOCK)[0]
    assert both[1] == block_variance(pair[:, 1:], BLOCK)[0]


def test_a_few_blocks_are_taken_as_they_are():
    error = np.ones((30, 1))
    assert block_variance(error, np.repeat([0, 1, 2], 10)) == pytest.approx(300.0)
    assert block_variance(0 * error, np.repeat([0, 1, 2], 10)) == pytest.approx(0.0)

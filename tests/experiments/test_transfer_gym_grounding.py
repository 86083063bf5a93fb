import numpy as np

from experiments.transfer_gym_grounding import STRETCH, in_stretches
from sgat.transitions import Transitions


def test_long_episodes_are_cut_into_stretches():
    lengths = (STRETCH + 7, 3, 2 * STRETCH)
    episode = np.repeat([4, 5, 9], lengths)
    numbers = np.arange(len(episode), dtype=float)[:, None]
    stretches = in_stretches(Transitions(numbers, numbers, numbers, episode))
    _, counts = np.unique(stretches.episode, return_counts=True)
    assert list(counts) == [STRETCH, 7, 3, STRETCH, STRETCH]
    assert (np.diff(stretches.episode) >= 0).all()
    np.testing.assert_array_equal(stretches.state, numbers)

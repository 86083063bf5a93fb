import numpy as np
import pytest

from groundwalk.errors import BadValueError
from sgat.realised_share import RealisedShare


class AskingTransformer:
    """Asks for known deviations from a mean of zero."""

    def __init__(self, noisy=True):
        self.wish = None
        self.forward = self
        self.noisy = noisy
        self.asked = None

    def reset(self, seeds):
        self.rng = np.random.default_rng(1)

    def __call__(self, state, action):
        self.asked = self.rng.normal(size=(len(state), 2))
        if self.noisy:
            self.wish = self.asked
        return action

    def predict(self, state, action):
        return np.zeros((len(state), 2))


def measured(share, ticks=400, noisy=True):
    """A sim that does `share` of what it is asked, plus noise of its own."""
    transformer = AskingTransformer(noisy)
    probe = RealisedShare(transformer)
    probe.reset([])
    rng = np.random.default_rng(2)
    state = rng.normal(size=(20, 3))
    for _ in range(ticks):
        probe(state, np.zeros((20, 1)))
        own = 0.3 * rng.normal(size=(20, 2))
        state = np.hstack([share * transformer.asked + own, rng.normal(size=(20, 1))])
    return probe.share()


@pytest.mark.parametrize("share", [1.0, 0.5, 0.0])
def test_the_share_is_found(share):
    np.testing.assert_allclose(measured(share), share, atol=0.02)


def test_falls_do_not_count():
    transformer = AskingTransformer()
    probe = RealisedShare(transformer)
    probe.reset([])
    rng = np.random.default_rng(2)
    state = rng.normal(size=(20, 2))
    for tick in range(200):
        probe(state, np.zeros((20, 1)))
        state = transformer.asked * (-300 if tick % 50 == 0 else 1) + 1e-9
    np.testing.assert_allclose(probe.share(), 1.0, atol=0.01)


def test_without_noise_there_is_nothing_to_measure():
    with pytest.raises(BadValueError, match="no noise"):
        measured(1.0, ticks=3, noisy=False)

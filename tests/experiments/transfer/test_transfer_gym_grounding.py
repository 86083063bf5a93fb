import numpy as np
import pytest

from experiments.transfer.gym_studies.grounding import (
    STRETCH,
    in_stretches,
    noise_ratio,
)
from sgat.models.config import ForwardConfig
from sgat.models.transition_models import ForwardModel, InverseModel
from sgat.noise import WhiteNoise
from sgat.transformers.action_transformer import ActionTransformer
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


def world_of_one_force(rng, noise):
    """Four speeds that one force changes, seen at random states, in 40 episodes."""
    n = 2000
    state = rng.normal(size=(n, 4))
    action = rng.uniform(-1, 1, (n, 1))
    force = action + noise * rng.normal(size=(n, 1))
    changed = state + 0.5 * force * [1.0, -1.0, 1.0, -1.0]
    return Transitions(state, action, changed, np.arange(n) // 50)


@pytest.mark.parametrize(
    ("head", "low", "high"), [("gaussian", 0.45, 0.85), ("full", 0.9, 1.1)]
)
def test_independent_samples_of_what_one_force_moves_are_too_calm(head, low, high):
    # Four witnesses of a force, each with noise of its own: the inverse model weighs
    # them with weights that sum to one, so that noise shrinks, at most to a half.
    of_real, of_sim, of_test = (np.random.default_rng(k) for k in range(3))
    seeds = np.random.SeedSequence(4).spawn(3)
    config = ForwardConfig(head=head)
    forward = ForwardModel(config).fit(world_of_one_force(of_real, 0.3), seeds[0])
    inverse = InverseModel().fit(world_of_one_force(of_sim, 0.0), seeds[1])
    bounds = np.full(1, -9.0), np.full(1, 9.0)
    noise = WhiteNoise(forward.outcomes)
    transformer = ActionTransformer(forward, inverse, *bounds, noise)
    held_out = world_of_one_force(of_test, 0.3)
    found = noise_ratio(transformer, inverse, held_out, seeds[2])
    assert low < found < high

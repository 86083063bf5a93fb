"""A transformer without an inverse model, on worlds whose ideal answer is known."""

import numpy as np
import pytest
from known_dynamics import HIGH, LIGHT, LOW, linear

from groundwalk.errors import BadModelError, BadValueError
from sgat.models.config import ForwardConfig, NetworkConfig
from sgat.models.transition_models import ForwardModel
from sgat.transformers.direct_transformer import DIRECT, DirectTransformer
from sgat.transitions import Transitions

OFF = 0.02
"""Standard deviation of what happens by chance."""


def walks(late, episodes, seed, context=True):
    """Episodes of a linear world whose actions may come a tick late.

    A state's last two columns are the action before.
    """
    rng = np.random.default_rng(seed)
    state, before = rng.normal(size=(episodes, 3)), np.zeros((episodes, 2))
    rows = []
    for _ in range(50):
        action = rng.uniform(-0.8, 0.8, (episodes, 2))
        after = linear(state, before if late else action)
        after = after + OFF * rng.normal(size=after.shape)
        seen = np.hstack([state, before]) if context else state
        rows.append((seen, action, after))
        state, before = after, action
    stacked = [
        np.stack(column, axis=1).reshape(episodes * 50, -1)
        for column in zip(*rows, strict=True)
    ]
    return Transitions(*stacked, np.repeat(np.arange(episodes), 50))


@pytest.fixture(scope="module")
def sim():
    tried = walks(late=False, episodes=60, seed=1, context=False)
    config = ForwardConfig(beta=1.0, **LIGHT)
    return ForwardModel(config).fit(tried, np.random.SeedSequence(2)), tried


def fitted(sim, real):
    transformer = DirectTransformer(LOW, HIGH, NetworkConfig(**LIGHT))
    return transformer.fit(real, *sim, np.random.SeedSequence(3))


@pytest.fixture(scope="module")
def of_late(sim):
    return fitted(sim, walks(late=True, episodes=60, seed=4))


def test_of_a_late_world_the_action_before_is_taken(of_late):
    unseen = walks(late=True, episodes=10, seed=5)
    found = of_late(unseen.state, unseen.action)
    before = unseen.state[:, 3:]
    assert np.abs(found - before).mean() < 0.05
    assert np.abs(found - unseen.action).mean() > 0.3


def test_where_nothing_differs_the_action_is_left_alone(sim):
    unseen = walks(late=False, episodes=10, seed=6)
    same = fitted(sim, walks(late=False, episodes=60, seed=7))
    found = same(unseen.state, unseen.action)
    assert np.abs(found - unseen.action).mean() < 0.05
    assert np.abs(found - unseen.state[:, 3:]).mean() > 0.3


def test_actions_stay_within_their_bounds(of_late):
    transformer = of_late
    far = np.hstack([np.zeros((1, 3)), [[50.0, -50.0]]])
    found = transformer(far, np.zeros((1, 2)))
    assert (found >= LOW).all()
    assert (found <= HIGH).all()


def test_saving_and_loading_gives_the_same_bits(of_late, tmp_path):
    unseen = walks(late=True, episodes=2, seed=8)
    header = of_late.save(tmp_path)
    again = DirectTransformer.load(tmp_path, header, LOW, HIGH)
    assert (
        again(unseen.state, unseen.action) == of_late(unseen.state, unseen.action)
    ).all()


def test_a_model_of_another_kind_is_refused(sim, tmp_path):
    sim[0].save(tmp_path / DIRECT)
    with pytest.raises(BadModelError, match="direct transformer"):
        DirectTransformer.load(tmp_path, {}, LOW, HIGH)


def test_nothing_is_answered_before_it_is_fitted():
    with pytest.raises(BadValueError, match="not been fitted"):
        DirectTransformer(LOW, HIGH)(np.zeros((1, 5)), np.zeros((1, 2)))

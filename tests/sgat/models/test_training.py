"""Training: early stopping, independence of members, and nothing global."""

import contextlib

import numpy as np
import pytest
import torch

from groundwalk.errors import BadValueError
from sgat.models.config import NetworkConfig
from sgat.models.training import Examples, Stage, one_thread, squared_error, train

RNG = np.random.default_rng(0)
X = RNG.normal(size=(300, 2))
Y = np.column_stack([np.sin(X[:, 0]), X[:, 0] * X[:, 1]]) + RNG.normal(0, 0.3, (300, 2))
EXAMPLES, HELD_OUT = Examples.of(X[:200], Y[:200]), Examples.of(X[200:], Y[200:])
SMALL = NetworkConfig(hidden=(16, 8), epochs=30, batch=32, patience=5)


def fit(weights=1, score=squared_error, seed=1, config=SMALL):
    if isinstance(weights, int):
        weights = np.ones((weights, 200))
    stages = [Stage(squared_error, score), Stage(squared_error, score, 0.1)]
    generator = torch.Generator().manual_seed(seed)
    return train(2, stages, EXAMPLES, weights, HELD_OUT, config, generator)


def held_out_error(network, member=0):
    found = network.member(member, X[200:])
    return ((found - Y[200:]) ** 2).sum(axis=1).mean()


def test_a_network_is_the_chain_that_torch_would_make():
    network = fit()
    layers = []
    for weight, bias in zip(network.weights, network.biases, strict=True):
        layer = torch.nn.Linear(*weight.shape[1:])
        layer.weight.data = torch.tensor(weight[0].T)
        layer.bias.data = torch.tensor(bias[0, 0])
        layers += [layer, torch.nn.Tanh()]
    chain = torch.nn.Sequential(*layers[:-1])
    expected = chain(torch.tensor(X, dtype=torch.float32)).detach()
    np.testing.assert_allclose(network.member(0, X), expected, atol=1e-5)
    assert (network.inputs, network.outputs, network.members) == (2, 2, 1)


def test_the_best_weights_are_kept():
    seen = []

    def score(raw, y):
        losses = squared_error(raw, y)
        seen.append(losses.mean().item())
        return losses

    eager = NetworkConfig(hidden=(64,), epochs=100, batch=32, learning_rate=0.02)
    network = fit(score=score, config=eager)
    assert seen[-1] > min(seen)  # it went on for a while in vain
    assert held_out_error(network) == pytest.approx(min(seen), rel=1e-4)


def test_patience_ends_training():
    epochs = []

    def never_better(raw, y):
        epochs.append(1)
        return torch.zeros(len(raw), len(y))

    fit(score=never_better)
    assert len(epochs) == 2 * (1 + 5)  # each stage looks where it stands, then waits


def test_something_is_learned():
    untrained = fit(config=NetworkConfig(hidden=(16, 8), epochs=1, batch=200))
    noise = 2 * 0.3**2
    assert held_out_error(fit()) < 0.7 * held_out_error(untrained)
    assert held_out_error(fit()) > 0.5 * noise


def test_members_do_not_know_of_each_other():
    few, many = np.ones((2, 200)), np.ones((2, 200))
    many[1, 100:] = 0
    patient = NetworkConfig(hidden=(16, 8), epochs=20, batch=32, patience=20)
    one, other = fit(few, config=patient), fit(many, config=patient)
    np.testing.assert_allclose(one.member(0, X), other.member(0, X), atol=1e-5)
    assert np.abs(one.member(1, X) - other.member(1, X)).max() > 0.05
    assert np.abs(one.member(0, X) - one.member(1, X)).max() > 0.05


def test_each_row_by_its_member():
    network, member = fit(3), np.arange(300) % 3
    mixed = network.mixed(X, member)
    for which in range(3):
        rows = member == which
        own = network.member(which, X)[rows]
        np.testing.assert_allclose(mixed[rows], own, atol=1e-6)


def test_the_same_seed_gives_the_same_bits():
    one, again, other = fit(seed=1), fit(seed=1), fit(seed=2)
    for a, b, c in zip(one.weights, again.weights, other.weights, strict=True):
        np.testing.assert_array_equal(a, b)
        assert (a != c).any()


def test_neither_global_generator_nor_threads_are_touched():
    torch.manual_seed(4)
    np.random.seed(4)
    before = torch.get_rng_state(), np.random.get_state()[1].copy()
    fit()
    assert torch.equal(torch.get_rng_state(), before[0])
    np.testing.assert_array_equal(np.random.get_state()[1], before[1])
    torch.rand(1)
    assert not torch.equal(torch.get_rng_state(), before[0])


def test_threads_are_given_back():
    before, inside = torch.get_num_threads(), []
    with contextlib.suppress(ZeroDivisionError), one_thread():
        inside.append(torch.get_num_threads())
        raise ZeroDivisionError
    assert inside == [1]
    assert torch.get_num_threads() == before


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("hidden", ()),
        ("hidden", (64, 0)),
        ("epochs", 0),
        ("batch", 0),
        ("patience", 0),
        ("learning_rate", 0.0),
        ("learning_rate", float("nan")),
        ("weight_decay", -0.1),
        ("validation_share", 1.0),
    ],
)
def test_what_cannot_train_is_refused(name, value):
    with pytest.raises(BadValueError, match=name):
        NetworkConfig(**{name: value})

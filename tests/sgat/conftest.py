"""Models of known worlds, fitted once."""

import numpy as np
import pytest
from known_dynamics import LIGHT, bent, linear, noisy_actions, roll

from sgat.models.config import ForwardConfig, NetworkConfig
from sgat.models.transition_models import ForwardModel, InverseModel

NOISE = 0.3


@pytest.fixture(scope="session")
def noisy_real():
    """(fitted to, held out) transitions of the linear world with noisy actions."""
    step = noisy_actions(linear, NOISE)
    return roll(step, 60, 50, seed=1), roll(step, 100, 50, seed=2)


@pytest.fixture(scope="session")
def forward(noisy_real):
    """The paper's forward model of `noisy_real`."""
    return ForwardModel(ForwardConfig(**LIGHT)).fit(
        noisy_real[0], np.random.SeedSequence(3)
    )


@pytest.fixture(scope="session")
def inverse():
    """Inverse model of the linear world."""
    sim = roll(linear, 60, 50, seed=4)
    return InverseModel(NetworkConfig(**LIGHT)).fit(sim, np.random.SeedSequence(5))


@pytest.fixture(scope="session")
def bent_inverse():
    """Inverse model of the nonlinear world."""
    sim = roll(bent, 100, 50, seed=6)
    return InverseModel(NetworkConfig(**LIGHT)).fit(sim, np.random.SeedSequence(7))

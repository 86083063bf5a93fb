"""Fits of small mismatch that begin where the simulation blew up."""

import numpy as np
import pytest
from made_up_traces import arm

from diagnosis.effects.parts import PlacedEffect
from diagnosis.residuals.small_mismatch.nuisance import Nuisance
from diagnosis.residuals.small_mismatch.nuisance_fit import NuisanceFit

ROWS = 300
GAIN = (PlacedEffect("servo_gain", "elbow", (1.0,)),)


@pytest.mark.parametrize("size", [1.0, 1e9])
def test_a_simulation_that_blew_up_ends_a_fit(size):
    """Beside squares of 1e20 the two nats that a step must gain are lost."""
    wild = size * np.sign(np.random.default_rng(0).standard_normal(ROWS))

    def ask(models):
        return np.repeat(wild[None], len(models), axis=0)

    fit = NuisanceFit(ask, lambda model: None, GAIN)
    found, model = fit.settled_with_values(Nuisance.of(arm(), (), ROWS))
    assert not found.sizes.any()
    assert model == GAIN

"""Steps of replays: as long as they are exact enough."""

from dataclasses import replace

import numpy as np
import pytest
from joint_rigs import ARM, plant_of
from made_up_traces import recorded

from diagnosis.effects.parts import PlacedEffect
from diagnosis.residuals.channels import shared_channels
from diagnosis.residuals.data_sets import DataSets


@pytest.mark.slow
@pytest.mark.parametrize(
    ("kp", "kd", "wanted_s"), [(8.0, 0.4, 0.004), (2000.0, 1.0, 0.001)]
)
def test_stiff_joints_take_short_steps(kp, kd, wanted_s):
    plant = plant_of(ARM, kp=kp, kd=kd)
    traces = [
        recorded(plant, noise_rad=1e-4, seed=seed, duration_s=2.0) for seed in range(4)
    ]
    data = DataSets.of(plant, traces, shared_channels(plant, traces), None, 1)
    assert set(data.learned.steps_s) == set(data.test.steps_s) == {wanted_s}
    both, test = data.calibrated(())
    assert set(both.steps_s) == set(test.steps_s) == {wanted_s}


@pytest.mark.slow
def test_recordings_keep_their_weights():
    """In all parts, and where a model is taken whose steps are measured anew."""
    plant = plant_of(ARM, kp=8.0, kd=0.4)
    traces = [
        replace(recorded(plant, seed=seed, duration_s=2.0), name=str(seed))
        for seed in range(4)
    ]
    channels = shared_channels(plant, traces)
    trust = {name: np.array([0.5, 1.0]) for name in "0123"}
    data = DataSets.of(plant, traces, channels, None, 1, trust=trust)
    model = (PlacedEffect("viscous_friction", "elbow", (0.1,)),)
    for part in (data.fit, data.select, data.test, *data.calibrated(model)):
        wanted = np.tile([0.5, 1.0], (len(part.scored) // 2, 1))
        np.testing.assert_array_equal(part._doubts.trust, wanted)

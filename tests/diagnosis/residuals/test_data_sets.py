"""Steps of replays: as long as they are exact enough."""

import pytest
from joint_rigs import ARM, plant_of
from made_up_traces import recorded

from diagnosis.residuals.channels import shared_channels
from diagnosis.residuals.data_sets import DataSets


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

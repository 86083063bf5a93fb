"""What sensors add to the truth: how much, and out of which randomness."""

from dataclasses import replace

import numpy as np
import pytest

from groundwalk.errors import BadValueError
from worlds import Observation, SensorNoise
from worlds.sensor_noise import NoisySensors

ROBOTS, TICKS, TICK_S = 60, 200, 0.01
QUANTUM_RAD = 2 * np.pi / 4096  # 12 bit a turn
SILENT = SensorNoise(
    gyroscope_rad_s=(0.0, 0.0, 0.0),
    gyroscope_bias_rad_s=0.0,
    accelerometer_m_s2=(0.0, 0.0, 0.0),
    joint_quantum_rad=0.0,
    foot_force_n=0.0,
)


def seeds(n):
    return [np.random.SeedSequence([9, i]) for i in range(n)]


def clean(tick, n=ROBOTS):
    """Joints that move at 0.4 rad/s, and numbers that are easy to tell apart."""
    return Observation(
        time_s=np.full(n, tick * TICK_S),
        position_rad=np.full((n, 5), 0.004 * tick) + np.arange(5),
        velocity_rad_s=np.full((n, 5), 0.4),
        gyroscope_rad_s=np.tile([0.1, 0.2, 0.3], (n, 1)),
        accelerometer_m_s2=np.tile([0.0, 1.0, 9.81], (n, 1)),
        foot_force_n=np.tile(np.arange(8.0) * 3, (n, 1)),
    )


def measured(noise, n=ROBOTS, ticks=TICKS, chosen=None):
    """Arrays (ticks, n, ...) by field."""
    sensors = NoisySensors(noise, seeds(n) if chosen is None else chosen)
    seen = [sensors(clean(tick, n), TICK_S) for tick in range(ticks)]
    return {name: np.stack([getattr(o, name) for o in seen]) for name in vars(seen[0])}


@pytest.fixture(scope="module")
def seen():
    return measured(SensorNoise())


def assert_spread(samples, expected, axis):
    """Standard deviations within five standard errors, s / sqrt(2 n)."""
    spread = samples.std(axis=axis)
    count = samples.size / spread.size
    np.testing.assert_allclose(spread, expected, rtol=5 / np.sqrt(2 * count))


def test_white_noise_is_as_wide_as_it_says(seen):
    within = seen["gyroscope_rad_s"] - seen["gyroscope_rad_s"].mean(axis=0)
    assert_spread(within, (0.0039, 0.0055, 0.0024), (0, 1))
    assert_spread(seen["accelerometer_m_s2"], (0.063, 0.030, 0.088), (0, 1))
    assert_spread(seen["foot_force_n"][:, :, 2:], 0.4, (0, 1))


def test_white_noise_has_no_mean_and_no_memory(seen):
    noise = seen["accelerometer_m_s2"] - [0.0, 1.0, 9.81]
    error = np.array([0.063, 0.030, 0.088]) / np.sqrt(ROBOTS * TICKS)
    assert (np.abs(noise.mean(axis=(0, 1))) < 5 * error).all()
    unit = noise / [0.063, 0.030, 0.088]
    following = (unit[1:] * unit[:-1]).mean(axis=(0, 1))
    across = (unit[:, 1:] * unit[:, :-1]).mean(axis=(0, 1))
    for correlation in (following, across):
        assert np.abs(correlation).max() < 5 / np.sqrt(ROBOTS * TICKS)


def test_gyroscope_bias_stays_through_a_rollout():
    noise = replace(SILENT, gyroscope_bias_rad_s=0.01)
    bias = measured(noise, n=400, ticks=3)["gyroscope_rad_s"] - [0.1, 0.2, 0.3]
    np.testing.assert_array_equal(bias[1:], bias[:-1])
    assert_spread(bias[0], 0.01, 0)
    assert len(np.unique(bias[0])) == 1200


def test_joints_are_counted_in_steps(seen):
    steps = seen["position_rad"] / QUANTUM_RAD
    np.testing.assert_allclose(steps, np.round(steps), atol=1e-9)
    true = np.stack([clean(tick).position_rad for tick in range(TICKS)])
    error = np.abs(seen["position_rad"] - true)
    assert 0.9 * QUANTUM_RAD / 2 < error.max() <= QUANTUM_RAD / 2 * (1 + 1e-9)


def test_velocity_is_the_difference_of_counts(seen):
    position, velocity = seen["position_rad"], seen["velocity_rad_s"]
    np.testing.assert_array_equal(velocity[0], 0)
    np.testing.assert_allclose(
        velocity[1:], np.diff(position, axis=0) / TICK_S, atol=1e-12
    )
    assert np.abs(velocity[1:] - 0.4).max() <= QUANTUM_RAD / TICK_S * (1 + 1e-9)
    assert velocity[1:].mean() == pytest.approx(0.4, rel=2e-3)


def test_feet_do_not_pull(seen):
    assert seen["foot_force_n"].min() == 0.0
    unloaded = seen["foot_force_n"][:, :, 0]
    assert np.mean(unloaded == 0) == pytest.approx(0.5, abs=0.03)


def test_without_noise_only_the_velocity_is_measured_anew():
    seen = measured(SILENT, n=2, ticks=4)
    for tick in range(4):
        truth = clean(tick, 2)
        for name in vars(truth):
            if name != "velocity_rad_s":
                np.testing.assert_array_equal(seen[name][tick], getattr(truth, name))
    np.testing.assert_allclose(seen["velocity_rad_s"][1:], 0.4, atol=1e-9)


def test_the_clock_is_right(seen):
    np.testing.assert_array_equal(seen["time_s"][7], clean(7).time_s)


def test_same_seed_same_noise(seen):
    again = measured(SensorNoise())
    for name in seen:
        np.testing.assert_array_equal(again[name], seen[name])


def test_a_robot_has_noise_of_its_own(seen):
    """Whatever its neighbours are, and however many."""
    alone = measured(SensorNoise(), n=1, chosen=seeds(ROBOTS)[17:18])
    for name in seen:
        np.testing.assert_array_equal(alone[name][:, 0], seen[name][:, 17])
    for name in ("gyroscope_rad_s", "accelerometer_m_s2", "foot_force_n"):
        assert not np.array_equal(seen[name][:, 16], seen[name][:, 17])


@pytest.mark.parametrize(
    "bad",
    [
        {"gyroscope_rad_s": (0.1, -0.1, 0.1)},
        {"gyroscope_bias_rad_s": -0.01},
        {"accelerometer_m_s2": (0.1, 0.1, float("nan"))},
        {"joint_quantum_rad": float("inf")},
        {"foot_force_n": -1.0},
    ],
)
def test_noise_that_cannot_be(bad):
    with pytest.raises(BadValueError, match=next(iter(bad))):
        SensorNoise(**bad)

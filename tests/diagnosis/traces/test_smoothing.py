import numpy as np
import pytest

from diagnosis.traces.noise import noise_of, quantum_of
from diagnosis.traces.smoothing import smooth, smooth_below

HZ, SECONDS = 100, 40


@pytest.fixture
def times():
    """Uneven: ticks vary by a twentieth."""
    rng = np.random.default_rng(1)
    return np.cumsum(rng.normal(1 / HZ, 0.05 / HZ, HZ * SECONDS))


def sine(times, hz=0.8, size=0.3):
    w = 2 * np.pi * hz
    return (
        size * np.sin(w * times),
        size * w * np.cos(w * times),
        -size * w**2 * np.sin(w * times),
    )


@pytest.mark.parametrize("std", [1e-4, 1e-3, 1e-2])
@pytest.mark.parametrize("hz", [0.2, 3.0])
def test_white_noise_is_measured_in_motion(times, std, hz):
    noisy = sine(times, hz)[0] + std * np.random.default_rng(2).normal(size=len(times))
    noise = noise_of(times, noisy)
    quick = 3e-5 if hz == 3.0 else 0.0  # what fifth differences leave of the motion
    assert noise.std == pytest.approx(std, rel=0.1, abs=quick)
    assert noise.quantum is None


def test_no_noise_is_none(times):
    noise = noise_of(times, sine(times)[0])
    assert noise.std < 1e-5
    assert noise.quantum is None
    assert noise_of(times, np.ones_like(times)).total < 1e-12


@pytest.mark.parametrize("quantum", [1.534e-3, 2 * np.pi / 2**14])
def test_quantum_is_found_and_not_counted_as_noise(times, quantum):
    rounded = np.round((sine(times)[0] + 0.1234) / quantum) * quantum
    noise = noise_of(times, rounded)
    assert noise.quantum == pytest.approx(quantum, rel=1e-6)
    assert noise.std < 0.3 * quantum
    assert noise.total > 0.999 * quantum / np.sqrt(12)


def test_quantum_with_noise_offset_and_outliers(times):
    rng = np.random.default_rng(3)
    quantum, std = 1.5e-3, 5e-4
    noisy = sine(times)[0] + std * rng.normal(size=len(times))
    rounded = np.round(noisy / quantum) * quantum + 0.0007
    rounded[::100] += rng.uniform(-0.01, 0.01, len(rounded[::100]))
    assert quantum_of(rounded) == pytest.approx(quantum, rel=1e-3)
    rounded = np.round(noisy / quantum) * quantum
    assert noise_of(times, rounded).std == pytest.approx(std, rel=0.25)


def test_continuous_values_have_no_quantum():
    rng = np.random.default_rng(4)
    for count in (50, 500, 20000):
        assert quantum_of(rng.normal(size=count)) is None


def test_noise_ignores_what_is_missing_and_gaps():
    rng = np.random.default_rng(5)
    times = np.arange(4000) * 0.01
    times[2000:] += 5.0
    noisy = 0.5 * times + 1e-3 * rng.normal(size=len(times))
    noisy[rng.random(len(times)) < 0.1] = np.nan
    assert noise_of(times, noisy).std == pytest.approx(1e-3, rel=0.1)


def test_smoothing_recovers_position_speed_and_acceleration(times):
    value, rate, acceleration = sine(times)
    std = 1e-3
    noisy = value + std * np.random.default_rng(6).normal(size=len(times))
    smoothed = smooth(times, noisy)
    inner = slice(50, -50)

    def error(found, true):
        return np.std((found - true)[inner]) / np.std(true[inner])

    assert np.std((smoothed.value - value)[inner]) < 0.5 * std
    assert error(smoothed.rate, rate) < 0.02
    assert error(smoothed.acceleration, acceleration) < 0.12
    # plain differences are far worse
    assert error(np.gradient(noisy, times), rate) > 0.05


def test_smoothing_follows_where_there_is_no_noise(times):
    value, rate, acceleration = sine(times, hz=4.0)
    smoothed = smooth(times, value, 0.0)
    np.testing.assert_allclose(smoothed.value, value, atol=1e-5)
    limit = 2e-3 * np.abs(rate).max()
    np.testing.assert_allclose(smoothed.rate[20:-20], rate[20:-20], atol=limit)
    limit = 0.02 * np.abs(acceleration).max()
    np.testing.assert_allclose(
        smoothed.acceleration[20:-20], acceleration[20:-20], atol=limit
    )


def test_a_parabola_passes_any_smoothing():
    times = np.linspace(0, 3, 200)
    parabola = 2 + 3 * times - 0.7 * times**2
    smoothed = smooth(times, parabola, noise_std=1.0)
    np.testing.assert_allclose(smoothed.value, parabola, atol=1e-4)
    np.testing.assert_allclose(smoothed.acceleration, -1.4, atol=1e-3)


def test_more_noise_smooths_more(times):
    noisy = sine(times)[0] + 1e-2 * np.random.default_rng(7).normal(size=len(times))
    rough = [np.std(smooth(times, noisy, std).acceleration) for std in (1e-3, 1e-1)]
    assert rough[0] > 2 * rough[1]


def test_missing_values_are_bridged(times):
    value = sine(times)[0]
    noisy = value + 1e-3 * np.random.default_rng(8).normal(size=len(times))
    noisy[1000:1015] = np.nan
    noisy[::7] = np.nan
    smoothed = smooth(times, noisy)
    assert np.abs(smoothed.value - value)[50:-50].max() < 2e-3
    nothing = smooth(times, np.full(len(times), np.nan))
    assert np.isnan(nothing.value).all()


def test_no_row_is_beyond_the_last_knot():
    """Times whose span is no whole number of ticks in floating point."""
    for rows in range(40, 60):
        for tick_s in (0.01, 0.02, 0.1 / 3, 0.007):
            time_s = 0.1 + tick_s * np.arange(rows)
            found = smooth(time_s, np.sin(time_s))
            assert np.isfinite(found.value).all()


@pytest.mark.parametrize(("share", "kept"), [(0.25, 1.0), (1.0, 0.5), (4.0, 0.0)])
def test_a_cut_off_halves_a_sine(share, kept):
    """Far below the sampling rate 1 / (1 + (w / w0)^6) of a sine is kept."""
    time_s = np.arange(2000) * 0.005
    wave = np.sin(2 * np.pi * share * 3.0 * time_s)
    wave[900:905] = np.nan
    smooth = smooth_below(time_s, wave, 3.0)
    rows = slice(300, 800)
    size = np.sum(smooth.value[rows] * wave[rows]) / np.sum(wave[rows] ** 2)
    assert size == pytest.approx(kept, abs=0.01)
    rate = np.gradient(smooth.value, time_s)
    np.testing.assert_allclose(smooth.rate[rows], rate[rows], atol=0.02)
    assert np.isfinite(smooth.acceleration).all()


def test_too_few_values_are_not_smoothed_below_a_frequency():
    assert np.isnan(smooth_below(np.arange(5.0), np.ones(5), 0.1).value).all()

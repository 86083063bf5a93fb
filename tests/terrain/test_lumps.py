import numpy as np
import pytest

import terrain

WIDE = {
    "x_range_m": (-10.0, 10.0),
    "y_range_m": (-10.0, 10.0),
    "start_radius_m": 0.0,
    "blend_m": 0.01,
}


@pytest.fixture(scope="module", params=[0.25, 0.5])
def lumps(request):
    return request.param, terrain.make(
        "lumps", 5, amplitude_m=0.02, wavelength_m=request.param, **WIDE
    )


def test_heights_are_gaussian_with_99_percent_within_the_amplitude(lumps):
    height_m = lumps[1].heights_m
    rms_m = np.sqrt(np.mean(height_m**2))
    assert rms_m == pytest.approx(0.02 / 2.5758, rel=0.03)
    assert np.mean(np.abs(height_m) <= 0.02) == pytest.approx(0.99, abs=0.003)
    assert np.mean(height_m) == pytest.approx(0.0, abs=2e-4)
    assert np.mean(height_m**3) / rms_m**3 == pytest.approx(0.0, abs=0.1)
    assert np.mean(height_m**4) / rms_m**4 == pytest.approx(3.0, abs=0.15)


def spectrum(field):
    """Wave numbers kx and ky [cycles/m] of the grid, and the power at each."""
    rows, columns = field.heights_m.shape
    window = np.outer(np.hanning(rows), np.hanning(columns))
    power = np.abs(np.fft.fft2(field.heights_m * window)) ** 2
    kx = np.fft.fftfreq(columns, field.spacing_m)[np.newaxis, :]
    ky = np.fft.fftfreq(rows, field.spacing_m)[:, np.newaxis]
    return kx, ky, power / power.sum()


def test_wavelengths_span_an_octave_around_the_given_one(lumps):
    wavelength_m, field = lumps
    kx, ky, power = spectrum(field)
    relative = np.hypot(kx, ky) * wavelength_m
    leak = 1.1  # the window widens the band
    inside = (relative > np.sqrt(0.5) / leak) & (relative < np.sqrt(2.0) * leak)
    assert power[inside].sum() > 0.99
    positive = relative > 0.0
    middle = np.exp(np.sum(power[positive] * np.log(relative[positive])))
    assert middle == pytest.approx(1.0, abs=0.06)
    below = power[relative < 1.0].sum()
    assert below == pytest.approx(0.5, abs=0.15)  # half of the octave, not one peak


def test_no_direction_is_special(lumps):
    kx, ky, power = spectrum(lumps[1])
    energy = np.sum(power * (kx**2 + ky**2))
    assert np.sum(power * kx**2) / energy == pytest.approx(0.5, abs=0.1)
    assert np.sum(power * kx * ky) / energy == pytest.approx(0.0, abs=0.1)


def test_the_grid_does_not_change_the_lumps():
    coarse = terrain.make("lumps", 8, spacing_m=0.05)
    fine = terrain.make("lumps", 8, x_range_m=(-0.5, 2.0), y_range_m=(-1.0, 1.0))
    shared_m = coarse.heights_m[20:61, 10:61]
    np.testing.assert_allclose(fine.heights_m[::2, ::2], shared_m, atol=1e-12)


def test_heights_scale_with_the_amplitude():
    low, high = (terrain.make("lumps", 8, amplitude_m=a) for a in (0.01, 0.03))
    np.testing.assert_allclose(high.heights_m, 3.0 * low.heights_m, atol=1e-12)


def test_lumps_without_height_are_flat():
    assert terrain.make("lumps", 8, amplitude_m=0.0).is_flat

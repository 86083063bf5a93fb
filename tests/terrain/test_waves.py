import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import terrain


@given(
    amplitude_m=st.floats(0.001, 0.1),
    wavelength_m=st.floats(0.3, 2.0),
    heading_rad=st.floats(-math.pi, math.pi),
    column=st.integers(70, 240),
    row=st.integers(0, 160),
)
def test_samples_lie_on_the_sine(amplitude_m, wavelength_m, heading_rad, column, row):
    field = terrain.make(
        "waves",
        0,
        amplitude_m=amplitude_m,
        wavelength_m=wavelength_m,
        heading_rad=heading_rad,
    )
    x_m, y_m = -1.0 + 0.025 * column, -2.0 + 0.025 * row
    along_m = math.cos(heading_rad) * x_m + math.sin(heading_rad) * y_m
    expected = amplitude_m * math.sin(2.0 * math.pi * along_m / wavelength_m)
    assert field.heights_m[row, column] == pytest.approx(expected, abs=1e-9)


def test_amplitude_and_period():
    field = terrain.make("waves", 0, amplitude_m=0.02, wavelength_m=0.5)
    line_m = field.heights_m[80, 80:]  # from x = 1 m on, 20 samples a period
    assert line_m.max() == pytest.approx(0.02)
    assert line_m.min() == pytest.approx(-0.02)
    np.testing.assert_allclose(line_m[20:], line_m[:-20], atol=1e-12)
    np.testing.assert_allclose(line_m[10:], -line_m[:-10], atol=1e-12)


@pytest.mark.parametrize(("heading_rad", "axis"), [(0.0, 0), (math.pi / 2, 1)])
def test_crests_lie_across_the_heading(heading_rad, axis):
    field = terrain.make("waves", 0, heading_rad=heading_rad)
    beyond_m = field.heights_m[:, 70:]
    assert np.ptp(beyond_m, axis=axis).max() < 1e-12
    assert np.ptp(beyond_m, axis=1 - axis).max() > 0.019

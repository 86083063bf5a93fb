import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import terrain


@given(
    angle_rad=st.floats(0.0, 0.7),
    heading_rad=st.floats(-math.pi, math.pi),
    x_m=st.floats(0.6, 5.0),
    y_m=st.floats(-2.0, 2.0),
)
def test_height_is_tangent_times_distance(angle_rad, heading_rad, x_m, y_m):
    field = terrain.make("slope", 0, angle_rad=angle_rad, heading_rad=heading_rad)
    forward_m = x_m - 0.35 - 0.125  # the blend costs half of its width
    expected = math.tan(angle_rad) * (
        math.cos(heading_rad) * forward_m + math.sin(heading_rad) * y_m
    )
    assert field.height_at(x_m, y_m) == pytest.approx(expected, abs=1e-9)


@pytest.mark.parametrize(
    ("heading_rad", "ahead", "left"),
    [(0.0, 1.0, 0.0), (math.pi, -1.0, 0.0), (math.pi / 2, 0.0, 1.0)],
)
def test_up_down_and_across(heading_rad, ahead, left):
    field = terrain.make("slope", 0, angle_rad=0.1, heading_rad=heading_rad)
    here = field.height_at(2.0, 0.5)
    assert field.height_at(3.0, 0.5) - here == pytest.approx(ahead * math.tan(0.1))
    assert field.height_at(2.0, 1.5) - here == pytest.approx(left * math.tan(0.1))


@pytest.mark.parametrize("heading_rad", [0.0, 2.5, math.pi / 2])
def test_ground_behind_the_edge_is_flat_and_the_edge_is_round(heading_rad):
    field = terrain.make("slope", 0, heading_rad=heading_rad)
    behind = field.vertices_m[:, 0] <= 0.35
    assert not field.heights_m.ravel()[behind].any()
    kinks = np.abs(np.diff(field.heights_m, n=2, axis=1)) / 0.025
    # Steepest change of gradient: 1 / blend uphill, 6 / blend^2 * 2 m across.
    bound = (abs(math.cos(heading_rad)) + 48.0 * abs(math.sin(heading_rad))) / 0.25
    assert kinks.max() <= 1.01 * math.tan(math.radians(5.0)) * bound * 0.025

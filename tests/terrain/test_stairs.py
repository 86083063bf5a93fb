import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import terrain


@pytest.mark.parametrize("step_m", [0.02, -0.015])
def test_treads_are_level_and_steps_equal(step_m):
    field = terrain.make("stairs", 0, step_m=step_m, tread_m=0.4, steps=3)
    # Edges at 0.35, 0.75 and 1.15 m; each riser ends one sample of 25 mm later.
    ends_m = [-1.0, 0.35, 0.375, 0.75, 0.775, 1.15, 1.175, 5.0]
    levels = [0, 0, 1, 1, 2, 2, 3, 3]
    for y_m in (-2.0, 0.0, 1.234):
        np.testing.assert_allclose(
            field.height_at(ends_m, y_m), step_m * np.array(levels), atol=1e-12
        )
    assert field.height_at(0.35 + 0.0125, 0.0) == pytest.approx(step_m / 2.0)


@given(
    step_m=st.floats(0.001, 0.2),
    tread_m=st.floats(0.05, 0.5),
    steps=st.integers(1, 8),
    spacing_m=st.sampled_from([0.01, 0.02, 0.025]),
)
def test_every_riser_takes_one_cell(step_m, tread_m, steps, spacing_m):
    field = terrain.make(
        "stairs",
        0,
        step_m=step_m,
        tread_m=tread_m,
        steps=steps,
        spacing_m=spacing_m,
        y_range_m=(-0.1, 0.1),
    )
    rises_m = np.diff(field.heights_m[0])
    risers = np.flatnonzero(rises_m > 1e-12)
    assert risers.size == steps
    np.testing.assert_allclose(rises_m[risers], step_m)
    starts_m = -1.0 + spacing_m * risers
    edges_m = 0.35 + tread_m * np.arange(steps)
    assert np.all(np.abs(starts_m - edges_m) < 1.001 * spacing_m)
    assert field.heights_m[0, -1] == pytest.approx(steps * step_m)
    assert (field.heights_m == field.heights_m[0]).all()

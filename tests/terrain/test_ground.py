import dataclasses
import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import terrain
from groundwalk.errors import BadValueError
from terrain import families

RANDOM = ("bumps", "lumps")


@pytest.mark.parametrize("name", terrain.names())
def test_robots_start_on_flat_ground_of_height_zero(name):
    field = terrain.make(name, 3)
    radius_m = np.hypot(field.vertices_m[:, 0], field.vertices_m[:, 1])
    height_m = field.heights_m.ravel()
    assert not height_m[radius_m <= 0.35].any()
    assert height_m[radius_m > 0.6].any() == (name != "flat")


@pytest.mark.parametrize("name", ["bumps", "lumps", "waves"])
def test_terrain_fades_in(name):
    whole = terrain.make(name, 3, start_radius_m=0.0, blend_m=0.01)
    faded = terrain.make(name, 3, start_radius_m=0.4, blend_m=0.2)
    radius_m = np.hypot(*whole.vertices_m[:, :2].T)
    beyond, half = radius_m > 0.61, np.abs(radius_m - 0.5) < 1e-9
    whole_m, faded_m = whole.heights_m.ravel(), faded.heights_m.ravel()
    np.testing.assert_array_equal(faded_m[beyond], whole_m[beyond])
    assert half.sum() >= 8
    np.testing.assert_allclose(faded_m[half], whole_m[half] / 2.0, atol=1e-12)


def test_the_fade_has_no_kink():
    ground = terrain.Flat(start_radius_m=1.0, blend_m=0.5)
    shown = ground.past_start(np.linspace(0.9, 1.6, 701))
    steepness = np.diff(shown) / 0.001
    assert shown[0] == 0.0
    assert shown[-1] == 1.0
    assert steepness.min() >= 0.0
    assert steepness.max() == pytest.approx(1.5 / 0.5, rel=1e-3)  # of 3 t^2 - 2 t^3
    assert np.abs(np.diff(steepness)).max() < 0.03  # 6 / 0.5^2 * 0.001 = 0.024


@pytest.mark.parametrize("name", terrain.names())
def test_one_seed_is_one_ground(name):
    first, again = terrain.make(name, 11), terrain.make(name, 11)
    assert first.heights_m.tobytes() == again.heights_m.tobytes()


@pytest.mark.parametrize("name", RANDOM)
def test_another_seed_is_another_ground(name):
    first, other = terrain.make(name, 11), terrain.make(name, 12)
    assert not np.array_equal(first.heights_m, other.heights_m)


@pytest.mark.parametrize("name", RANDOM)
def test_a_seed_sequence_is_used_and_not_used_up(name):
    sequence = np.random.SeedSequence(11)
    first, again = terrain.make(name, sequence), terrain.make(name, sequence)
    child = terrain.make(name, sequence.spawn(1)[0])
    expected = terrain.make(name, 11)
    assert first.heights_m.tobytes() == again.heights_m.tobytes()
    assert first.heights_m.tobytes() == expected.heights_m.tobytes()
    assert not np.array_equal(child.heights_m, first.heights_m)


@pytest.mark.parametrize("name", RANDOM)
def test_numpys_global_generator_plays_no_part(name):
    state = np.random.get_state()
    terrain.make(name, 11)
    assert np.array_equal(state[1], np.random.get_state()[1])


@pytest.mark.parametrize("seed", [-1, 1.0, True, None, "7", math.nan])
def test_what_is_no_seed_is_refused(seed):
    with pytest.raises(BadValueError, match="seed"):
        terrain.make("flat", seed)


@given(
    low_m=st.floats(-3.0, 0.0),
    high_m=st.floats(0.1, 3.0),
    spacing_m=st.floats(0.02, 0.5),
)
def test_the_grid_covers_its_ranges_and_little_more(low_m, high_m, spacing_m):
    field = terrain.make(
        "flat", 0, x_range_m=(low_m, high_m), y_range_m=(-1, 1), spacing_m=spacing_m
    )
    for found, wanted in (
        (field.x_range_m, (low_m, high_m)),
        (field.y_range_m, (-1.0, 1.0)),
    ):
        assert found[0] == wanted[0]
        assert wanted[1] - 1e-5 * spacing_m < found[1] < wanted[1] + 1.001 * spacing_m


def test_the_default_grid():
    field = terrain.make("flat", 0)
    assert field.heights_m.shape == (161, 241)
    assert field.x_range_m == pytest.approx((-1.0, 5.0))
    assert field.y_range_m == pytest.approx((-2.0, 2.0))


@pytest.mark.parametrize("name", terrain.names())
def test_numbers_out_of_bounds_are_refused(name):
    for field in dataclasses.fields(terrain.configuration(name)):
        low, high = field.metadata["bounds"]
        pair = isinstance(field.default, tuple)
        for wrong in (low - 1, high + 1, math.nan, math.inf, True, "0.1", None):
            parameters = {field.name: (wrong, 1.0) if pair else wrong}
            with pytest.raises(BadValueError, match=rf"^{field.name} must be [^\n]*$"):
                terrain.configuration(name, **parameters)


@pytest.mark.parametrize(
    "wrong", [(1.0, -1.0), (0.0, 0.0), (-1.0, 0.0, 1.0), (), 3.0, "ab", None]
)
def test_what_is_no_range_is_refused(wrong):
    with pytest.raises(BadValueError, match="x_range_m must be two increasing numbers"):
        terrain.Flat(x_range_m=wrong)


@pytest.mark.parametrize(
    ("name", "parameters", "message"),
    [
        ("flat", {"x_range_m": (0.1, 5.0)}, "must hold 0"),
        ("flat", {"y_range_m": (-2.0, -1.0)}, "must hold 0"),
        ("flat", {"x_range_m": (-900.0, 900.0)}, "samples are too many"),
        ("lumps", {"wavelength_m": 0.09}, "at least 4 spacings = 0.1, not 0.09"),
        ("waves", {"wavelength_m": 0.4, "spacing_m": 0.2}, "at least 4 spacings"),
        ("bumps", {"radius_m": 0.04}, "at least 2 spacings"),
        ("stairs", {"tread_m": 0.04}, "at least 2 spacings"),
        ("stairs", {"steps": 2.0}, "whole number"),
    ],
)
def test_grounds_that_make_no_sense_are_refused(name, parameters, message):
    with pytest.raises(BadValueError, match=message):
        terrain.configuration(name, **parameters)


def test_configurations_hold_plain_numbers_and_can_be_compared():
    ground = families.Stairs(step_m=np.float64(0.02), steps=np.int64(3), tread_m=1)
    assert ground == families.Stairs(step_m=0.02, steps=3, tread_m=1.0)
    assert ground != families.Stairs(step_m=0.02, steps=4, tread_m=1.0)
    types = [type(value) for value in (ground.step_m, ground.steps, ground.tread_m)]
    assert types == [float, int, float]
    with pytest.raises(dataclasses.FrozenInstanceError):
        ground.steps = 5

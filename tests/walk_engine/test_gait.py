import json
import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from groundwalk.errors import BadValueError, UnknownNameError
from walk_engine import gaits
from walk_engine.gait import NAMES, PARAMETERS, Gait, from_unit, stack, to_unit

WALK2014 = gaits.get("walk2014")


def test_sixteen_parameters_with_distinct_names():
    assert len(set(NAMES)) == 16


@pytest.mark.parametrize("parameter", PARAMETERS, ids=NAMES)
def test_defaults_lie_within_bounds(parameter):
    assert parameter.low <= parameter.default <= parameter.high
    assert parameter.low < parameter.high


@pytest.mark.parametrize(
    ("name", "value"),
    [("step_period", 0.23), ("hip_height", 0.23), ("gyro_sagittal", 1 / 25)],
)
def test_walk2014_has_the_published_constants(name, value):
    assert WALK2014[name] == value


def test_start_is_walk2014_at_twenty_three_centimetres_per_second():
    assert gaits.get("start") == WALK2014.replace(max_forward=0.23)
    assert gaits.get("start") != WALK2014


def test_catalog_knows_its_names_and_no_others():
    assert [gaits.get(name)["step_period"] for name in gaits.names()] == [0.23, 0.23]
    with pytest.raises(UnknownNameError, match="did you mean 'walk2014'"):
        gaits.get("walk2041")


def test_a_gait_is_a_mapping_in_the_order_of_the_table():
    assert list(WALK2014) == list(NAMES)
    assert tuple(WALK2014.values()) == WALK2014.vector
    assert "no_such" not in WALK2014
    with pytest.raises(KeyError):
        WALK2014["no_such"]


def test_vector_round_trip():
    gait = WALK2014.replace(torso_pitch=0.05, step_period=0.3)
    assert Gait.from_vector(gait.to_vector()) == gait


@given(st.lists(st.floats(0, 1), min_size=16, max_size=16))
def test_every_scaled_vector_is_a_gait_and_scales_back(unit):
    vector = from_unit(unit)
    assert np.allclose(to_unit(Gait.from_vector(vector).to_vector()), unit, atol=1e-12)


def test_bounds_scale_to_zero_and_one_exactly():
    low = [parameter.low for parameter in PARAMETERS]
    high = [parameter.high for parameter in PARAMETERS]
    assert (to_unit([low, high]) == [[0.0] * 16, [1.0] * 16]).all()
    assert (from_unit([[0.0] * 16, [1.0] * 16]) == [low, high]).all()


@pytest.mark.parametrize("bad", [-0.01, 1.01, math.nan])
def test_values_that_are_not_scaled_are_refused(bad):
    with pytest.raises(BadValueError, match="between 0 and 1"):
        from_unit([0.5] * 15 + [bad])


@pytest.mark.parametrize(
    "value", [0.159, 0.341, math.nan, math.inf, -math.inf, "fast", None, True]
)
def test_bad_values_are_refused_by_name_and_bounds(value):
    with pytest.raises(BadValueError, match=r"step_period .* between 0.16 and 0.34 s"):
        WALK2014.replace(step_period=value)


@pytest.mark.parametrize("value", [0.16, 0.34])
def test_the_bounds_themselves_are_allowed(value):
    assert WALK2014.replace(step_period=value)["step_period"] == value


def test_missing_parameters_are_named():
    values = dict(WALK2014)
    del values["hip_height"], values["arm_swing"]
    with pytest.raises(BadValueError, match="lacks hip_height, arm_swing"):
        Gait.from_mapping(values)


def test_unknown_parameters_are_named():
    with pytest.raises(UnknownNameError, match="did you mean 'hip_height'"):
        Gait.from_mapping({**WALK2014, "hip_heigth": 0.2})


@pytest.mark.parametrize("vector", [[], [0.2] * 15, [0.2] * 17, [[0.2] * 16]])
def test_vectors_of_another_shape_are_refused(vector):
    with pytest.raises(BadValueError):
        Gait.from_vector(vector)


def test_json_round_trip_is_exact(tmp_path):
    gait = Gait.from_vector(from_unit(np.random.default_rng(1).random(16)))
    path = tmp_path / "gait.json"
    gait.save(path)
    assert Gait.load(path) == gait
    assert set(json.loads(path.read_text())) == {"gait"}


def test_plain_json_mapping_is_read(tmp_path):
    path = tmp_path / "gait.json"
    path.write_text(json.dumps(dict(WALK2014)))
    assert Gait.load(path) == WALK2014


@pytest.mark.parametrize("text", ["", "[1, 2]", '{"gait": 3}', "{"])
def test_files_that_hold_no_gait_are_refused_by_name(tmp_path, text):
    path = tmp_path / "gait.json"
    path.write_text(text)
    with pytest.raises(BadValueError, match=r"gait\.json is no gait file"):
        Gait.load(path)


@pytest.mark.parametrize("change", [{"arm_swing": 10**400}, {"arm_swng": 6.0}])
def test_files_that_hold_a_bad_gait_are_refused_by_name(tmp_path, change):
    path = tmp_path / "gait.json"
    path.write_text(json.dumps({"gait": {**WALK2014, **change}}))
    with pytest.raises(BadValueError, match=r"gait\.json: .*arm_swing"):
        Gait.load(path)


def test_missing_files_are_refused_by_name(tmp_path):
    with pytest.raises(BadValueError, match=r"none\.json is no gait file"):
        Gait.load(tmp_path / "none.json")


def test_stack_takes_gaits_and_arrays():
    two = [WALK2014, gaits.get("start")]
    array = stack(two)
    assert array.shape == (2, 16)
    assert (stack(array) == array).all()


def test_stack_refuses_no_gaits_and_bad_rows():
    with pytest.raises(BadValueError, match="at least one"):
        stack([])
    with pytest.raises(BadValueError, match="step_period"):
        stack(np.zeros((2, 16)))

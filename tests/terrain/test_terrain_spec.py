import json
import pickle

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import terrain
from groundwalk.errors import BadValueError, UnknownNameError
from terrain import TerrainSpec, families


@given(
    amplitude_m=st.floats(0.0, 0.5), x_high_m=st.floats(0.5, 2.0), seed=st.integers(0)
)
def test_json_makes_the_same_ground_again(amplitude_m, x_high_m, seed):
    parameters = {
        "amplitude_m": amplitude_m,
        "x_range_m": (-0.5, x_high_m),
        "y_range_m": (-0.5, 0.5),
    }
    spec = TerrainSpec("lumps", parameters, seed)
    again = TerrainSpec.from_json(json.loads(json.dumps(spec.to_json())))
    assert again == spec
    assert hash(again) == hash(spec)
    assert again.make().heights_m.tobytes() == spec.make().heights_m.tobytes()


@pytest.mark.parametrize("name", terrain.names())
def test_a_spec_makes_what_the_catalog_makes(name):
    made = TerrainSpec(name, {"spacing_m": 0.04}, 9).make()
    expected = terrain.make(name, 9, spacing_m=0.04)
    assert made.heights_m.tobytes() == expected.heights_m.tobytes()


def test_defaults_are_written_down():
    data = TerrainSpec("waves", {"amplitude_m": 0.02}, 1).to_json()
    assert data == {
        "name": "waves",
        "parameters": {
            "x_range_m": [-1.0, 5.0],
            "y_range_m": [-2.0, 2.0],
            "spacing_m": 0.025,
            "start_radius_m": 0.35,
            "blend_m": 0.25,
            "amplitude_m": 0.02,
            "wavelength_m": families.Waves().wavelength_m,
            "heading_rad": 0.0,
        },
        "seed": 1,
    }


def test_specs_differ_by_name_parameter_and_seed():
    specs = {
        TerrainSpec("lumps"),
        TerrainSpec("lumps", {"amplitude_m": 0.1}),
        TerrainSpec("lumps", seed=1),
        TerrainSpec("waves"),
        TerrainSpec("lumps", {}, np.int64(0)),
    }
    assert len(specs) == 4


def test_a_spec_travels_to_other_processes():
    spec = TerrainSpec("bumps", {"height_m": 0.02}, 4)
    assert pickle.loads(pickle.dumps(spec)) == spec


def test_a_spec_keeps_its_own_parameters():
    parameters = {"height_m": 0.02}
    spec = TerrainSpec("bumps", parameters)
    parameters["height_m"] = 0.5
    assert spec.parameters["height_m"] == 0.02


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"seed": -1}, "seed"),
        ({"seed": 1.5}, "seed"),
        ({"seed": True}, "seed"),
        ({"name": 3}, "must be text"),
        ({"parameters": [1]}, "must be an object"),
        ({"parameters": {"height_m": "high"}}, "height_m must be a number"),
        ({"extra": 1}, "unknown key 'extra'"),
    ],
)
def test_json_with_wrong_values_is_refused(change, message):
    data = TerrainSpec("bumps").to_json()
    assert TerrainSpec.from_json(data) == TerrainSpec("bumps")
    with pytest.raises(BadValueError, match=message):
        TerrainSpec.from_json(data | change)


@pytest.mark.parametrize("data", [None, [], "lumps", {}, {"name": "lumps"}])
def test_json_of_another_shape_is_refused(data):
    message = "terrain (must be an object|has no '(name|parameters)')"
    with pytest.raises(BadValueError, match=message):
        TerrainSpec.from_json(data)


@pytest.mark.parametrize(
    "change", [{"name": "lump"}, {"parameters": {"heigth_m": 0.1}}]
)
def test_json_with_unknown_names_is_refused(change):
    with pytest.raises(UnknownNameError, match="did you mean"):
        TerrainSpec.from_json(TerrainSpec("bumps").to_json() | change)

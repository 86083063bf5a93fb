import pytest
from hypothesis import given
from hypothesis import strategies as st

import terrain
from groundwalk.errors import BadValueError, GroundwalkError, UnknownNameError


@pytest.mark.parametrize(
    ("text", "name", "parameters"),
    [
        ("flat", "flat", {}),
        (
            "lumps:amplitude_m=0.012,wavelength_m=0.3",
            "lumps",
            {"amplitude_m": 0.012, "wavelength_m": 0.3},
        ),
        ("stairs:steps=4,step_m=-1e-2", "stairs", {"steps": 4, "step_m": -0.01}),
        ("waves:x_range_m=-1:8.5", "waves", {"x_range_m": (-1.0, 8.5)}),
        ("slope:heading_rad=+1", "slope", {"heading_rad": 1}),
    ],
)
def test_texts(text, name, parameters):
    assert terrain.parse(text) == (name, parameters)
    terrain.TerrainSpec(name, parameters).make()


@given(st.floats(0.0, 0.5), st.floats(0.1, 100.0))
def test_numbers_arrive_unchanged(amplitude_m, wavelength_m):
    text = f"lumps:amplitude_m={amplitude_m!r},wavelength_m={wavelength_m!r}"
    assert terrain.parse(text)[1] == {
        "amplitude_m": amplitude_m,
        "wavelength_m": wavelength_m,
    }


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("lumps:", "parameter=value"),
        ("lumps:amplitude_m", "parameter=value"),
        ("lumps:amplitude_m=", "amplitude_m must be a number"),
        ("lumps:amplitude_m=high", "amplitude_m must be a number"),
        ("lumps:amplitude_m=nan", "amplitude_m must be a number"),
        ("lumps:amplitude_m=0.1=0.2", "amplitude_m must be a number"),
        ("lumps:amplitude_m=0.1,,", "parameter=value"),
        ("lumps:amplitude_m=0.1,amplitude_m=0.2", "given twice"),
        ("lumps:amplitude_m=7", "from 0 to 0.5, not 7"),
        ("lumps:x_range_m=1:2:3", "x_range_m"),
        ("lumps:x_range_m=2:1", "x_range_m"),
        ("stairs:steps=4.0", "whole number"),
    ],
)
def test_wrong_texts_are_told_in_one_line(text, message):
    with pytest.raises(BadValueError, match=message) as caught:
        terrain.parse(text)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    ("text", "nearest"), [("lmps", "lumps"), ("lumps:amplitude=1", "amplitude_m")]
)
def test_unknown_names_suggest_the_nearest_one(text, nearest):
    with pytest.raises(UnknownNameError, match=f"did you mean '{nearest}'"):
        terrain.parse(text)


@given(st.text())
def test_any_text_is_read_or_refused(text):
    for attempt in (text, f"lumps:{text}", f"lumps:amplitude_m={text}"):
        try:
            name, parameters = terrain.parse(attempt)
        except GroundwalkError:
            continue
        terrain.configuration(name, **parameters)

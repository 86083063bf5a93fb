import dataclasses

import pytest

import terrain
from groundwalk.errors import BadValueError, UnknownNameError
from terrain import ground
from terrain.catalog import FAMILIES


def test_names():
    assert list(terrain.names()) == sorted(terrain.names())
    known = {"bumps", "flat", "lumps", "slope", "stairs", "waves"}
    assert known <= set(terrain.names())


def test_ladders_give_ground_of_their_own_family():
    for name, family in FAMILIES.items():
        for ladder in family.ladders.values():
            mildest, *_, hardest = ladder.severities(5, 0.25)
            for severity in (mildest, hardest):
                parameters = ladder.parameters(severity, 0.25)
                assert type(terrain.configuration(name, **parameters)) is family


def test_a_name_and_parameters_give_the_family():
    ground = terrain.configuration("lumps", amplitude_m=0.02, spacing_m=0.05)
    assert ground == terrain.Lumps(amplitude_m=0.02, spacing_m=0.05)
    assert ground.wavelength_m == terrain.Lumps().wavelength_m


@pytest.mark.parametrize("name", terrain.names())
def test_make_is_the_family_at_work(name):
    made = terrain.make(name, 7, spacing_m=0.04)
    expected = terrain.configuration(name, spacing_m=0.04).make(7)
    assert made.heights_m.tobytes() == expected.heights_m.tobytes()
    assert made.spacing_m == 0.04


@pytest.mark.parametrize(
    ("name", "nearest"), [("lump", "lumps"), ("Stairs", "stairs"), ("wave", "waves")]
)
def test_unknown_names_suggest_the_nearest(name, nearest):
    with pytest.raises(UnknownNameError, match=f"did you mean '{nearest}'"):
        terrain.configuration(name)


@pytest.mark.parametrize("parameter", ["amplitude", "amplitud_m", "amplitude_cm"])
def test_unknown_parameters_suggest_the_nearest(parameter):
    with pytest.raises(UnknownNameError, match=r"terrain 'lumps'.*'amplitude_m'"):
        terrain.make("lumps", 0, **{parameter: 0.1})


def test_parameters_of_another_family_are_unknown():
    with pytest.raises(UnknownNameError, match="steps"):
        terrain.make("lumps", 0, steps=3)


def test_bad_values_are_named():
    with pytest.raises(BadValueError, match="amplitude_m must be a number from 0 to"):
        terrain.make("lumps", 0, amplitude_m=-0.1)


@pytest.mark.parametrize("name", terrain.names())
def test_every_parameter_is_documented(name):
    family = type(terrain.configuration(name))
    told = (family.__doc__ or "") + (ground.Ground.__doc__ or "")
    for field in dataclasses.fields(family):
        assert f"{field.name}:" in told

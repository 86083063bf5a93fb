import pytest

import robots
from groundwalk.errors import GroundwalkError, UnknownNameError


def test_nao_is_there():
    assert "nao" in robots.names()
    assert robots.get("nao").name == "nao"
    assert robots.get("nao") is robots.get("nao")


def test_every_name_can_be_had():
    for name in robots.names():
        assert robots.get(name).name == name


@pytest.mark.parametrize("name", ["nau", "NAO", "noa"])
def test_misspelt_name_brings_the_nearest(name):
    with pytest.raises(UnknownNameError, match="did you mean 'nao'"):
        robots.get(name)


@pytest.mark.parametrize("name", ["atlas-3000", "", "../robots/nao"])
def test_other_names_bring_what_there_is(name):
    with pytest.raises(GroundwalkError, match=r"unknown robot .*nao"):
        robots.get(name)

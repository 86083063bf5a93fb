"""Units of joints that turn, and of those that slide."""

import re

import pytest
from joint_rigs import ARM, SLED, plant_of

from diagnosis.effects.library import all_effects
from diagnosis.residuals.channels import channel_unit


@pytest.mark.parametrize(
    ("unit", "sliding"),
    [
        ("rad", "m"),
        ("rad/s", "m/s"),
        ("N m", "N"),
        ("N m/rad", "N/m"),
        ("N m s/rad", "N s/m"),
        ("N m s^2/rad^2", "N s^2/m^2"),
        ("kg m^2", "kg"),
        ("s", "s"),
        ("1/s", "1/s"),
        ("1", "1"),
    ],
)
def test_what_slides_is_in_metres(unit, sliding):
    assert plant_of(SLED).unit(unit, "slide") == sliding
    assert plant_of(SLED).unit(unit, "sled") == unit
    assert plant_of(ARM).unit(unit, "elbow") == unit


def test_channels_know_what_slides():
    sled, arm = plant_of(SLED), plant_of(ARM)
    assert channel_unit(sled, "position.slide") == "m"
    assert channel_unit(sled, "torque.slide") == "N"
    assert channel_unit(arm, "torque.elbow") == "N m"
    assert channel_unit(arm, "gyroscope.x") == "rad/s"
    assert channel_unit(sled, "base.position.x") == "m"
    assert channel_unit(sled, "base.roll") == "rad"


@pytest.mark.parametrize("name", all_effects())
def test_no_effect_speaks_of_turning_where_a_joint_slides(name):
    """Every unit of an effect at a joint has its counterpart."""
    plant, kind = plant_of(SLED, kp=1.0, kd=1.0), all_effects()[name]
    if kind.place_kind != "joint":
        return
    for parameter in kind.parameters(plant, "slide"):
        unit = plant.unit(parameter.unit, "slide")
        assert not re.search(r"rad|N m|kg m", unit), unit

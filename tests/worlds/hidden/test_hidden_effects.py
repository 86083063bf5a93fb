import pytest

from groundwalk.errors import BadValueError, GroundwalkError, UnknownNameError
from worlds.hidden.effects import KINDS, Hidden


def test_an_effect_reads_from_text():
    effect = Hidden.parse("backlash@LKneePitch:gap=0.02")
    assert effect == Hidden("backlash", "LKneePitch", {"gap": 0.02})
    assert effect["gap"] == 0.02


def test_an_effect_with_one_place_only_needs_none():
    assert Hidden.parse("command_latency:delay=0.01").place == "commands"


@pytest.mark.parametrize(
    "text",
    [
        "backlsh@knee:gap=0.02",
        "backlash@knee:gp=0.02",
        "backlash@knee",
        "backlash:gap=0.02",
        "backlash@knee:gap=wide",
        "backlash@knee:gap=nan",
        "command_latency@knee:delay=0.01",
    ],
)
def test_what_is_no_effect_is_refused(text):
    with pytest.raises(GroundwalkError):
        Hidden.parse(text)


def test_a_wrong_name_brings_the_right_one():
    with pytest.raises(UnknownNameError, match="did you mean 'backlash'"):
        Hidden.parse("backlsh@knee:gap=1")


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("backlash@LKneePitch:gap=3", r"gap is 3 rad; sensible values are 0 to 0\.5"),
        ("viscous_friction@LKneePitch:coefficient=-1", "0 or more"),
        ("servo_gain@LKneePitch:factor=80", "0 to 10"),
    ],
)
def test_sizes_that_make_no_sense_are_refused_with_those_that_do(text, message):
    with pytest.raises(BadValueError, match=message):
        Hidden.parse(text)


def test_the_order_from_which_cases_are_drawn_is_fixed():
    """Another order would draw other cases from the same seed."""
    ranks = [kind.rank for kind in KINDS.values()]
    assert ranks[:30] == list(range(1, 31))
    assert list(KINDS)[:3] == [
        "viscous_friction",
        "coulomb_friction",
        "stribeck_friction",
    ]
    assert list(KINDS)[29] == "periodic_torque"
    assert [kind.since for kind in KINDS.values()][:30] == [1] * 30
    assert [kind.since for kind in KINDS.values()][30:37] == [2] * 7
    assert all(kind.since > 4 for kind in [*KINDS.values()][37:])


def test_every_effect_of_the_library_is_there_and_some_that_are_not():
    inside = [name for name, kind in KINDS.items() if not kind.outside]
    assert len(inside) == 36
    assert len(KINDS) > 26


def test_compliance_has_a_damping_of_its_own():
    effect = Hidden("contact_compliance", "feet", {"stiffness": 1e4})
    assert effect["damping"] != effect["damping"]
    with pytest.raises(BadValueError):
        Hidden("contact_compliance", "feet", {"damping": 1.0})

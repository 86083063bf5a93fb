import pytest

from groundwalk.errors import UnknownNameError, nearest_name

JOINTS = ["LAnklePitch", "LKneePitch", "RAnklePitch", "RKneePitch"]


@pytest.mark.parametrize(
    ("given", "meant"),
    [
        ("LKnePitch", "LKneePitch"),
        ("RKnePitch", "RKneePitch"),
        ("lkneepitch", "LKneePitch"),
        ("LKneePich", "LKneePitch"),
        ("rAnklePitch", "RAnklePitch"),
    ],
)
def test_a_misspelt_joint_brings_the_one_of_its_own_side(given, meant):
    with pytest.raises(UnknownNameError, match=f"did you mean '{meant}'"):
        raise UnknownNameError("joint", given, JOINTS)


def test_of_names_that_differ_in_capitals_only_the_very_one_is_nearest():
    assert nearest_name("ab", ["AB", "Ab", "ab"]) == "ab"


def test_a_name_that_is_like_none_brings_none():
    assert nearest_name("quux", JOINTS) is None
    assert nearest_name("quux", []) is None
    assert "did you mean" not in str(UnknownNameError("joint", "quux", JOINTS))

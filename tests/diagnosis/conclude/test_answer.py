"""Verdicts on searches that are made up."""

from dataclasses import replace
from types import SimpleNamespace

import pytest
from made_up_search import found
from made_up_traces import arm

from diagnosis.conclude.answer import is_small, verdict_kind
from diagnosis.effects.parts import PlacedEffect
from diagnosis.search.result import SearchResult

ARM = arm()
ALL, ELBOW_STILL = frozenset({"shoulder", "elbow"}), frozenset({"shoulder"})
SHOULDER_STILL = frozenset({"elbow"})
OPEN = "not_identifiable"


def kind(searched, moving=ALL):
    return verdict_kind(searched, ARM, SimpleNamespace(moving=moving))


def nothing(energy):
    return SearchResult(energy, 100.0, {}, 0)


@pytest.mark.parametrize(
    ("searched", "moving", "wanted"),
    [
        (found(ARM, (101.0, "viscous_friction@elbow")), ALL, "effects"),
        (
            found(ARM, (101.0, "viscous_friction@elbow")),
            ELBOW_STILL,
            "not_identifiable",
        ),
        (found(ARM, (101.0, "viscous_friction@shoulder")), ELBOW_STILL, "effects"),
        (
            found(ARM, (101.0, "servo_gain@shoulder", "viscous_friction@elbow")),
            ELBOW_STILL,
            "effects",
        ),
        (found(ARM, (101.0, "payload_mass@lower")), ELBOW_STILL, "effects"),
        (found(ARM, (101.0, "payload_mass@lower")), SHOULDER_STILL, "effects"),
        (found(ARM, (101.0, "payload_mass@upper")), SHOULDER_STILL, OPEN),
        (found(ARM, (101.0, "payload_mass@lower")), frozenset(), OPEN),
        (found(ARM, (6000.0, "viscous_friction@elbow")), ALL, "unknown"),
        (found(ARM, (120.0, "viscous_friction@elbow"), nothing=140.0), ALL, "effects"),
        (nothing(101.0), ALL, "none"),
        (nothing(101.0), ELBOW_STILL, OPEN),
        (nothing(300.0), ALL, "unknown"),
        (replace(nothing(101.0), nothing_fit=150.0, floor_fit=200.0), ALL, "none"),
        (replace(nothing(101.0), nothing_fit=900.0, floor_fit=200.0), ALL, "unknown"),
    ],
)
def test_kinds(searched, moving, wanted):
    """What no moving joint shows is named only together with what one shows."""
    assert kind(searched, moving) == wanted


@pytest.mark.parametrize(
    ("name", "value", "small"),
    [
        ("servo_gain", 1.08, True),
        ("servo_gain", 0.93, True),
        ("servo_gain", 1.12, False),
        ("servo_damping", 0.93, True),
        ("servo_damping", 1.12, False),
        ("coulomb_friction", 1e-6, False),
    ],
)
def test_usual_errors_of_what_a_model_states_are_small(name, value, small):
    """Gains are known to 3 % (one in 400 robots is off by more than 9 %)."""
    placed = PlacedEffect(name, "elbow", (value,))
    assert is_small(ARM, placed) is small


def test_how_much_more_than_noise_is_hardly_more():
    """Noise learned of few recordings may be twice as large: four times the energy."""
    assert SearchResult(300.0, 100.0, {}, 0).leaves_much(0.5)
    assert not SearchResult(300.0, 100.0, {}, 0, most_left=3.0).leaves_much(0.5)
    assert SearchResult(401.0, 100.0, {}, 0, most_left=3.0).leaves_much(0.5)

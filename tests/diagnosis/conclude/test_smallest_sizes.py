"""The smallest sizes of effects, where they follow from a formula."""

from dataclasses import replace

import numpy as np
import pytest
from made_up_traces import arm

from diagnosis.conclude.answer import TIED_NATS
from diagnosis.conclude.effect_sizes import scaled
from diagnosis.conclude.smallest_sizes import Demand, smallest_sizes
from diagnosis.effects import PlacedEffect, effect
from diagnosis.residuals.signatures import Signature
from diagnosis.search.result import VALUE_NATS

PLANT = arm()
GAIN, MORE = 8.0, 1.5
DEMAND = Demand(GAIN, rows=1000, more=MORE)
VISCOUS = PlacedEffect("viscous_friction", "elbow", (0.1,))
DRY = PlacedEffect("coulomb_friction", "elbow", (0.1,))
LOAD = PlacedEffect("load_friction", "elbow", (0.1,))
OFFSET = PlacedEffect("torque_offset", "elbow", (0.1,))
SPRING = PlacedEffect("joint_spring", "elbow", (0.5, 0.0))


def signature(placed, *change, two_sided=False):
    change = np.array(change, float)
    return Signature(placed, change, np.arange(len(change)), two_sided)


def sizes(*found, **options):
    return smallest_sizes(PLANT, found, DEMAND, **options)


def test_an_effect_without_a_like_is_told_where_it_is_seen():
    """A change of |s| = 40 noise gains 800 nats, so that a tenth of it gains 8."""
    found = sizes(signature(LOAD, 24.0, 32.0, 0.0), signature(DRY, 0, 0, 5.0))
    one = found["load_friction@elbow"]
    assert one.seen.value == pytest.approx(0.01)
    assert one.told == one.seen
    assert one.seen.unit == "1"


@pytest.mark.parametrize("angle", [0.05, 0.3, 1.0])
def test_a_like_demands_a_lead(angle):
    """Only the part at right angles counts: |s|^2 sin^2 / 2 on 1.5 times the data."""
    size = 40.0
    found = sizes(
        signature(LOAD, size, 0.0),
        signature(DRY, 3 * np.cos(angle), 3 * np.sin(angle)),
    )
    one = found["load_friction@elbow"]
    lead = 0.1 * np.sqrt(2 * TIED_NATS / MORE) / (size * np.sin(angle))
    assert one.nearest.key == DRY.key
    assert one.alike == pytest.approx(np.cos(angle) ** 2, rel=1e-5)
    assert one.told.value == pytest.approx(max(lead, 0.01), rel=1e-4)


def test_more_values_cost_more():
    """A spring has a rest angle as well: 2 nats more to be seen, and to lead."""
    one = sizes(signature(SPRING, 40.0))["joint_spring@elbow"]
    seen = 0.5 * np.sqrt(2 * (GAIN + VALUE_NATS)) / 40.0
    assert one.seen.value == pytest.approx(seen)


def test_an_effect_of_one_sign_does_not_stand_for_the_opposite():
    against = signature(DRY, -3.0, 0.1)
    one = sizes(signature(LOAD, 40.0, 0.0), against)["load_friction@elbow"]
    assert one.alike == 0.0
    free = replace(against, placed=OFFSET, two_sided=True)
    one = sizes(signature(LOAD, 40.0, 0.0), free)["load_friction@elbow"]
    assert one.alike == pytest.approx(9 / 9.01, rel=1e-5)


def test_what_is_the_same_to_rounding_is_never_told():
    one = sizes(signature(LOAD, 40.0), signature(DRY, 3.0))["load_friction@elbow"]
    assert one.seen is not None
    assert one.told is None


def test_a_general_form_is_no_rival_of_what_it_contains():
    stribeck = PlacedEffect("stribeck_friction", "elbow", (0.1, 0.05, 0.1))
    found = sizes(signature(DRY, 40.0), signature(stribeck, 40.0))
    assert found[DRY.key].told == found[DRY.key].seen
    assert found[DRY.key].told is not None
    assert found[stribeck.key].nearest.key == DRY.key


def test_components_of_a_vector_stand_for_others_together():
    """Each explains half of the square, both of them all of it."""
    x, y = (
        PlacedEffect("com_offset", "lower", values)
        for values in ((0.01, 0.0, 0.0), (0.0, 0.01, 0.0))
    )
    both = (
        signature(x, 1.0, 0.0, two_sided=True),
        signature(y, 0.0, 1.0, two_sided=True),
    )
    one = sizes(signature(LOAD, 30.0, 30.0), *both)["load_friction@elbow"]
    assert one.alike == pytest.approx(1.0)
    assert sizes(signature(LOAD, 30.0, 30.0), both[0])[LOAD.key].alike == (
        pytest.approx(0.5)
    )


def test_what_grows_with_the_square_needs_less_of_a_change():
    play = PlacedEffect("backlash", "elbow", (0.01,))
    found = sizes(signature(play, 4.0), powers={play.key: 2.0})
    # at the tried size it gains 8 nats, whatever the power
    assert found[play.key].seen.value == pytest.approx(0.01)
    found = sizes(signature(play, 64.0), powers={play.key: 2.0})
    assert found[play.key].seen.value == pytest.approx(0.01 / 4)


def test_an_effect_that_is_absent_at_infinity_has_a_largest_value():
    spring = PlacedEffect("joint_elasticity", "elbow", (100.0, 0.1))
    found = sizes(signature(spring, 8.0))["joint_elasticity@elbow"]
    seen = 100.0 * 8.0 / np.sqrt(2 * (GAIN + VALUE_NATS))
    assert found.seen.value == pytest.approx(seen)
    assert found.placed.values[1] == 0.1


def test_a_threshold_counts_as_it_was_tried():
    limit = PlacedEffect("torque_limit", "elbow", (2.0,))
    assert sizes(signature(limit, 4.1))[limit.key].seen.value == 2.0
    assert sizes(signature(limit, 3.9))[limit.key].seen is None


def test_sizes_beyond_what_is_possible_are_none():
    share = PlacedEffect("load_friction", "elbow", (0.1,))
    assert sizes(signature(share, 0.1))[share.key].seen is None
    assert sizes(signature(share, 1.0))[share.key].seen.value == pytest.approx(0.4)


def test_usual_errors_are_not_told():
    """3 % is usual for a gain, so that 9 % is not told, however well it shows."""
    gain = PlacedEffect("servo_gain", "elbow", (0.8,))
    one = sizes(signature(gain, 1e4))["servo_gain@elbow"]
    assert one.usual
    assert one.told.value == pytest.approx(1 - np.exp(-0.09))
    assert not sizes(signature(gain, 4.0))["servo_gain@elbow"].usual


@pytest.mark.parametrize(
    ("placed", "least"),
    [
        (PlacedEffect("backlash", "elbow", (0.01,)), 0.0005),  # gears yield as much
        (PlacedEffect("integral_term", "elbow", (1.0,)), 20.0),  # a third of a minute
    ],
)
def test_what_every_model_leaves_out_is_not_told(placed, least):
    """However well it shows; a larger size is told as it shows."""
    one = sizes(signature(placed, 1e4))[placed.key]
    assert one.told == one.seen
    assert one.told.value == pytest.approx(least)
    assert one.placed.values == pytest.approx((least,))
    assert not one.usual
    # 40 noise gain 800 nats: 10 times less is seen
    one = sizes(signature(placed, 40.0))[placed.key]
    assert one.told.value == pytest.approx(0.001 if least < 1 else 10.0)


@pytest.mark.parametrize("known", [0.5, 10.0, 300.0])
def test_dry_friction_stands_out_from_other_errors_only(known):
    """Dry friction of one standard deviation leaves r = `known` beside all others.

    Whitened with its own as well it is r / (1 + r). On all data it gains 1.5 r / 2 for
    each deviation squared.
    """
    spread = effect("coulomb_friction").spread(PLANT, "elbow")
    rub = PlacedEffect("coulomb_friction", "elbow", (5 * spread,))
    left = 5 * np.sqrt(known / (1 + known))
    one = sizes(signature(rub, left))[rub.key]
    wanted = spread * np.sqrt(2 * GAIN / (MORE * known))
    assert one.told.value == pytest.approx(wanted, rel=1e-4)


def test_dry_friction_is_not_known_better_than_simulations_stop_joints():
    spread = effect("coulomb_friction").spread(PLANT, "elbow")
    rub = PlacedEffect("coulomb_friction", "elbow", (5 * spread,))
    one = sizes(signature(rub, 6.0))[rub.key]
    assert one.told.value == pytest.approx(0.03 * spread * np.sqrt(2 * GAIN / MORE))


def test_all_values_that_say_how_large_an_effect_is_are_scaled():
    stribeck = PlacedEffect("stribeck_friction", "elbow", (0.1, 0.05, 0.1))
    assert scaled(PLANT, stribeck, 2.0).values == pytest.approx((0.2, 0.1, 0.1))
    gain = PlacedEffect("servo_gain", "elbow", (0.8,))
    assert scaled(PLANT, gain, 0.5).values == pytest.approx((0.9,))

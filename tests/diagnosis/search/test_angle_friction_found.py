"""Dry friction that changes with the angle, in the hidden world: found, and told."""

import pytest
from hidden_arm import fitted, floor, plant, predictor_of, recorded

from diagnosis.effects import angle_friction
from diagnosis.effects.library import effect
from diagnosis.effects.parts import PlacedEffect
from diagnosis.effects.variants import Variants

JOINT = "J2"
DRY = ("coulomb_friction", JOINT, 0.3)
NEIGHBOURS = [
    [DRY],
    [("gear_friction", JOINT, 0.2, 0.1)],
    [("stribeck_friction", JOINT, 0.2, 0.2, 0.1)],
    [DRY, ("joint_spring", JOINT, 0.1, 0.0)],
]
CHANCE = 6.0
"""More nats than one value gains by chance in 999 of 1000 cases (chi squared)."""


def grown(torque_nm):
    """What is tried where dry friction of this size was found."""
    simple = PlacedEffect("coulomb_friction", JOINT, (torque_nm,))
    return effect("angle_friction").grown_from(simple)


def best_fit(predictor, torque_nm):
    fits = [
        fitted(predictor, (one.name, one.place, *one.values))
        for one in grown(torque_nm)
    ]
    return min(fits, key=lambda fit: fit.energy)


@pytest.mark.slow
@pytest.mark.parametrize("factor", [0.3, 2.0, 4.0])
def test_it_is_found_with_its_values(factor):
    text = f"angle_friction@{JOINT}:torque=0.4,factor={factor}"
    predictor = predictor_of(recorded(text))
    dry = fitted(predictor, DRY)
    fit = best_fit(predictor, dry.model[0].values[0])
    assert fit.model[0].values == pytest.approx((0.4, factor), rel=0.05)
    noise, spread = floor(predictor)
    assert fit.energy < noise + 3 * spread
    for others in NEIGHBOURS:
        assert fitted(predictor, *others).energy > fit.energy + 20


@pytest.mark.slow
@pytest.mark.parametrize("power", [0.5, 2.0])
def test_the_factors_that_are_tried_may_be_nearer_to_one_or_further(power, monkeypatch):
    some = tuple(one**power for one in angle_friction.GROWN_FACTORS)
    monkeypatch.setattr(angle_friction, "GROWN_FACTORS", some)
    predictor = predictor_of(recorded(f"angle_friction@{JOINT}:torque=0.4,factor=2.0"))
    fit = best_fit(predictor, 0.4)
    assert fit.model[0].values == pytest.approx((0.4, 2.0), rel=0.05)


@pytest.mark.slow
def test_it_is_not_taken_for_friction_that_is_the_same_everywhere():
    predictor = predictor_of(recorded(f"coulomb_friction@{JOINT}:torque=0.4"))
    dry = fitted(predictor, DRY)
    fit = best_fit(predictor, dry.model[0].values[0])
    assert fit.energy > dry.energy - CHANCE
    assert fit.model[0].values[1] == pytest.approx(1.0, abs=0.1)


def test_the_angle_counts_from_the_middle_of_the_range_though_it_was_lifted():
    kind, nominal = effect("angle_friction"), plant()
    assert nominal.model.joint(JOINT).range.any()
    for own in (nominal, nominal.without_ranges([JOINT])):
        low, high = nominal.model.joint(JOINT).range
        copies = Variants(own, 1)
        kind.apply(copies, 0, JOINT, (0.4, 2.0))
        column = copies.column(JOINT)
        assert copies.joints.angle_from_rad[0, column] == (low + high) / 2

"""The ladder of dry friction: which rung contains which, and how each is tried."""

import numpy as np
import pytest
from joint_rigs import PENDULUM, plant_of

from diagnosis.effects.library import containing, effect
from diagnosis.effects.parts import PlacedEffect
from diagnosis.effects.variants import Variants
from diagnosis.search.accept import simpler_models

RUNGS = (
    "shaped_stribeck_friction", "gear_friction", "gear_stribeck_friction",
    "directional_gear_friction", "quadratic_gear_friction",
)  # fmt: skip
PLANT = plant_of(PENDULUM, kp=20.0, kd=1.0, limit=4.0)


def typical(name):
    values = [one.typical for one in effect(name).parameters(PLANT, "hinge")]
    return PlacedEffect(name, "hinge", tuple(values))


@pytest.mark.parametrize("name", RUNGS)
def test_a_rung_is_reached_from_its_simpler_forms_only(name):
    kind = effect(name)
    assert kind.first_tries(PLANT, "hinge", None) == []
    forms = kind.simpler(typical(name))
    assert forms
    for form in forms:
        assert typical(name).key in containing(form)
        assert form.key not in containing(typical(name))
        assert len(form.values) < len(typical(name).values)
        assert len(form.values) == len(effect(form.name).parameters(PLANT, "hinge"))


def test_the_whole_ladder_is_above_dry_friction_and_nothing_above_its_top():
    above = {f"{name}@hinge" for name in RUNGS}
    assert containing(typical("coulomb_friction")) == {
        "stribeck_friction@hinge",
        "presliding@hinge",
        "angle_friction@hinge",
        *above,
    }
    assert containing(typical("quadratic_gear_friction")) == set()
    assert containing(typical("viscous_friction")) == set()


@pytest.mark.parametrize("name", ["coulomb_friction", "load_friction", *RUNGS])
def test_starts_are_within_bounds(name):
    for rung in RUNGS:
        for grown in effect(rung).grown_from(typical(name)):
            bounds = effect(rung).parameters(PLANT, "hinge")
            for value, one in zip(grown.values, bounds, strict=True):
                assert one.low <= value <= one.high, (rung, one.name)


def test_a_form_that_the_model_has_already_is_not_tried_again():
    rung, dry = typical("gear_friction"), typical("coulomb_friction")
    tried = simpler_models((rung, dry))
    names = [{one.name for one in model} for model in tried]
    # only dry friction itself has no simpler form
    assert names == [{"load_friction", "coulomb_friction"}]
    assert simpler_models((dry,)) == []


def test_one_share_of_both_sides_and_peaks_that_add_up():
    variants = Variants(PLANT, 2)
    add = effect("gear_stribeck_friction").apply
    add(variants, 1, "hinge", np.array([0.1, 0.2, 0.4, 1.0, 0.05, 0.1]))
    add(variants, 1, "hinge", np.array([0.1, 0.6, 0.8, 3.0, 0.05, 0.1]))
    joints = {name: one[:, 0].tolist() for name, one in vars(variants.joints).items()}
    assert joints["coulomb_nm"] == pytest.approx([0.0, 0.2])
    assert joints["link_share"] == joints["load_share"] == pytest.approx([0.0, 0.1])
    assert joints["extra_link_share"] == pytest.approx([0.0, 0.2])
    assert joints["extra_load_share"] == pytest.approx([0.0, 0.2])
    assert joints["stribeck_nm"] == pytest.approx([0.0, 0.8])
    assert joints["stribeck_speed_rad_s"] == pytest.approx([0.1, 0.7])
    assert joints["stribeck_exponent"] == pytest.approx([2.0, 2.5])

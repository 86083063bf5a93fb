"""Arms that an unknown controller moves: what their torques say, from end to end."""

from dataclasses import replace

import numpy as np
import pytest
from torque_arm import LOWER_KG, arm, loaded, moved, rubbing

from diagnosis.pipeline import diagnose
from diagnosis.traces.reference import Reference

COULOMB_NM, VISCOUS = (1.0, 2.0, 0.8), (1.5, 3.0, 0.7)


def verdict_of(*traces, **options):
    return diagnose(arm(), traces, np.random.SeedSequence(1), **options).verdict


def found(verdict):
    """Values by effect and place."""
    return {
        (one.name, one.place): [each.value for each in one.parameters.values()]
        for one in verdict.effects
    }


@pytest.mark.parametrize("noise_rad", [1e-5, 1e-3])
def test_a_right_model_lacks_nothing(noise_rad):
    verdict = verdict_of(moved(noise_rad=noise_rad))
    assert verdict.kind == "none"
    assert verdict.effects == ()
    assert any(
        "torques that the recorded motion needs" in text for text in verdict.limits
    )


@pytest.mark.slow
@pytest.mark.parametrize(
    ("noise_rad", "kg"), [(1e-5, 1.0), (1e-4, 1.0), (1e-4, 12.0), (1e-4, -0.5)]
)
def test_a_payload_is_found_at_its_link(noise_rad, kg):
    """One is heavier than the whole arm; the last one is in the model only."""
    verdict = verdict_of(moved(loaded(kg, "lower"), noise_rad=noise_rad))
    assert verdict.kind == "effects"
    ((place, (mass_kg,)),) = found(verdict).items()
    assert place == ("payload_mass", "lower")
    assert mass_kg == pytest.approx(kg, rel=0.1)


@pytest.mark.slow
def test_friction_at_all_joints_is_found():
    verdict = verdict_of(moved(rubbing(COULOMB_NM, VISCOUS)))
    assert verdict.kind == "effects"
    values = found(verdict)
    assert len(values) == 6
    for k, joint in enumerate(arm().joints):
        (coulomb_nm,) = values["coulomb_friction", joint]
        (viscous,) = values["viscous_friction", joint]
        assert coulomb_nm == pytest.approx(COULOMB_NM[k], rel=0.1)
        assert viscous == pytest.approx(VISCOUS[k], rel=0.1)


@pytest.mark.slow
def test_a_payload_is_found_beside_friction_at_all_joints():
    def change(model):
        rubbing(COULOMB_NM, VISCOUS)(model)
        loaded(0.7, "lower")(model)

    values = found(verdict_of(moved(change)))
    assert len(values) == 7
    (mass_kg,) = values["payload_mass", "lower"]
    assert mass_kg == pytest.approx(0.7, rel=0.1)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("joint", "scale"), [("elbow", (1, 1, 1.3)), ("shoulder", (1, 0.8, 1))]
)
def test_a_wrong_scale_of_torques_is_no_inertia(joint, scale):
    verdict = verdict_of(moved(scale=scale))
    assert verdict.kind == "effects"
    ((place, (factor,)),) = found(verdict).items()
    assert place == ("torque_scale", joint)
    assert factor == pytest.approx(np.prod(scale), rel=0.02)


@pytest.mark.slow
def test_only_what_has_changed_since_is_named():
    healthy = moved(rubbing(COULOMB_NM, VISCOUS), seed=3)

    def change(model):
        rubbing(COULOMB_NM, VISCOUS)(model)
        loaded(0.7, "lower")(model)

    verdict = verdict_of(moved(change), reference=Reference(arm(), [healthy]))
    assert verdict.kind == "effects"
    ((place, (mass_kg,)),) = found(verdict).items()
    assert place == ("payload_mass", "lower")
    assert mass_kg == pytest.approx(0.7, rel=0.1)


@pytest.mark.slow
def test_a_reference_may_have_a_model_of_its_own():
    """A tool was changed, and the new model says 0.7 kg too little of it."""
    then = Reference(arm(LOWER_KG + 0.3), [moved(loaded(0.3, "lower"), seed=3)])
    verdict = verdict_of(moved(loaded(0.7, "lower")), reference=then)
    ((place, (mass_kg,)),) = found(verdict).items()
    assert place == ("payload_mass", "lower")
    assert mass_kg == pytest.approx(0.7, rel=0.1)
    wrong = replace(then, plant=arm())
    verdict = verdict_of(moved(loaded(0.7, "lower")), reference=wrong)
    ((_, (mass_kg,)),) = found(verdict).items()
    assert mass_kg == pytest.approx(0.4, rel=0.1)

"""Presliding friction of the hidden world: found, and told from its neighbours."""

import numpy as np
import pytest
from hidden_arm import errors, fitted, floor, plant, predictor_of, recorded
from known_arms import LEAN

from diagnosis.effects.library import effect, grown_from
from diagnosis.effects.parts import PlacedEffect
from diagnosis.pipeline import diagnose

JOINT = "J2"


def grown(predictor, torque=0.2):
    """Fits that begin where a search does: at dry friction with several reaches."""
    (dry,) = fitted(predictor, ("coulomb_friction", JOINT, torque)).model
    return [
        fitted(predictor, (one.name, one.place, *one.values))
        for one in grown_from(dry)
        if one.name == "presliding"
    ]


@pytest.mark.parametrize(
    ("torque", "reach"), [(0.1, 0.005), (0.2, 0.02), (0.4, 0.05), (0.4, 0.1)]
)
def test_it_is_found_from_dry_friction(torque, reach):
    trace = recorded(f"presliding@{JOINT}:torque={torque},reach={reach}")
    predictor = predictor_of(trace)
    noise, spread = floor(predictor)
    for fit in grown(predictor):
        assert fit.energy < noise + 3 * spread
        (found,) = fit.model
        at = fit.coordinates.of(fit.model)
        right = fit.coordinates.of(
            (PlacedEffect(found.name, found.place, (torque, reach)),)
        )
        far = np.abs(at - right)
        assert (far < 4 * errors(fit) + 0.01).all()  # 1 % by the two engines' steps
        assert found.values == pytest.approx((torque, reach), rel=0.05)


@pytest.mark.parametrize(
    "others",
    [
        [("coulomb_friction", JOINT, 0.2)],
        [("stribeck_friction", JOINT, 0.2, 0.1, 0.1)],
        [("backlash", JOINT, 0.01)],
        [("joint_elasticity", JOINT, 200.0, 0.1)],
        [("joint_spring", JOINT, 5.0, 0.0), ("viscous_friction", JOINT, 0.1)],
    ],
    ids=lambda some: some[0][0],
)
def test_its_neighbours_cannot_be_mistaken_for_it(others):
    """All of them together with dry friction leave far more than it does."""
    trace = recorded(f"presliding@{JOINT}:torque=0.2,reach=0.02")
    predictor = predictor_of(trace)
    dry = ("coulomb_friction", JOINT, 0.1)
    with_dry = others if others[0][0] == "coulomb_friction" else [*others, dry]
    assert fitted(predictor, *with_dry).energy > 5 * floor(predictor)[0]


@pytest.mark.slow
@pytest.mark.parametrize(
    ("truth", "own"),
    [
        ("stribeck_friction@J2:coulomb_torque=0.2,extra_torque=0.2,speed=0.1",
         ("stribeck_friction", JOINT, 0.2, 0.1, 0.1)),
        ("backlash@J2:gap=0.03", ("backlash", JOINT, 0.02)),
        ("joint_elasticity@J2:stiffness=100,damping=0.05",
         ("joint_elasticity", JOINT, 150.0, 0.1)),
    ],
    ids=["stribeck", "backlash", "elasticity"],
)  # fmt: skip
def test_it_cannot_be_mistaken_for_its_neighbours(truth, own):
    predictor = predictor_of(recorded(truth))
    right = fitted(predictor, own).energy
    assert min(fit.energy for fit in grown(predictor)) > right + 20


def test_dry_friction_that_slides_at_once_has_no_reach():
    """A reach gains no more than a value does by chance, and the simpler form stays."""
    predictor = predictor_of(recorded("coulomb_friction@J2:torque=0.3"))
    dry = fitted(predictor, ("coulomb_friction", JOINT, 0.2))
    for fit in grown(predictor):
        (found,) = fit.model
        assert found.values[1] < 5e-4
        assert fit.energy > dry.energy - 6
        (simpler,) = effect("presliding").simpler(found)
        assert simpler.name == "coulomb_friction"
        assert simpler.values == pytest.approx(dry.model[0].values, rel=0.01)


def test_the_reaches_that_are_tried_may_be_twice_as_far(monkeypatch):
    from diagnosis.effects import presliding

    predictor = predictor_of(recorded("presliding@J2:torque=0.2,reach=0.02"))
    first, *_, last = presliding.GROWN_REACHES_RAD
    monkeypatch.setattr(presliding, "GROWN_REACHES_RAD", (first / 2, 2 * last))
    one, other = (fit.energy for fit in grown(predictor))
    noise, spread = floor(predictor)
    assert one == pytest.approx(other, abs=3)
    assert one < noise + 3 * spread


@pytest.mark.slow
def test_a_whole_diagnosis_names_it():
    truth = "presliding@J2:torque=0.4,reach=0.05"
    traces = [recorded(truth, seed=seed, duration_s=3.0) for seed in range(3)]
    verdict = diagnose(plant(), traces, np.random.SeedSequence(0), LEAN).verdict
    assert verdict.kind == "effects"
    (found,) = verdict.effects
    assert (found.name, found.place) == ("presliding", JOINT)
    for name, true in (("torque", 0.4), ("reach", 0.05)):
        value = found.parameters[name]
        assert value.value == pytest.approx(true, rel=0.02)
        assert value.low < true < value.high
    assert verdict.fit.corrected < 1.3

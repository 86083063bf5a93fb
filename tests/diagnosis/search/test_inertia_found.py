"""Another rotational inertia in the hidden world: found, told from a rotor's."""

import pytest
from hidden_arm import fitted, floor, plant, predictor_of, recorded

BODY = plant().bodies[-1]
ROTORS = [("armature", "J1", 0.01), ("armature", "J2", 0.01)]
HEAVIER = [("payload_mass", BODY, 0.1)]
LIVELY = {"size": 0.5, "fastest": 9.0}

CHANCE = 6.0
"""More nats than one value gains by chance in 999 of 1000 cases (chi squared)."""


def inertia(factor):
    return ("link_inertia", BODY, factor)


@pytest.mark.slow
@pytest.mark.parametrize("factor", [0.3, 1.5, 4.0])
def test_it_is_found_with_its_value(factor):
    text = f"link_inertia@{BODY}:factor={factor}"
    predictor = predictor_of(recorded(text, **LIVELY))
    fit = fitted(predictor, inertia(1.2))
    assert fit.model[0].values == pytest.approx((factor,), rel=0.03)
    noise, spread = floor(predictor)
    assert fit.energy < noise + 3 * spread
    for others in (ROTORS, HEAVIER):
        assert fitted(predictor, *others).energy > fit.energy + 20


@pytest.mark.slow
@pytest.mark.parametrize(
    ("hidden", "right"),
    [
        ("armature@J1:inertia=0.05", ("armature", "J1", 0.05)),
        (f"payload_mass@{BODY}:mass=0.3", ("payload_mass", BODY, 0.3)),
    ],
)
def test_it_is_not_taken_for_its_neighbours(hidden, right):
    predictor = predictor_of(recorded(hidden, **LIVELY))
    true = fitted(predictor, right)
    assert fitted(predictor, inertia(1.2)).energy > true.energy + 20
    more = fitted(predictor, (*right[:2], *true.model[0].values), inertia(1.0))
    assert more.energy > true.energy - CHANCE

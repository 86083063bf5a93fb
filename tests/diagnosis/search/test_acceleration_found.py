"""Targets that start and stop gently in the hidden world: found, and told apart."""

import pytest
from hidden_arm import fitted, floor, plant, predictor_of, recorded

from diagnosis.effects import set_points
from diagnosis.effects.library import effect
from diagnosis.traces.usage import Usage

JOINT = "J2"
GENTLE, SLOW = ("acceleration_limit", JOINT, 8.0), ("speed_limit", JOINT, 1.0)
LATENCY = ("command_latency", "commands", 0.005)
CHANCE = 6.0
"""More nats than one value gains by chance in 999 of 1000 cases (chi squared)."""


def truth(limit_rad_s2):
    return recorded(f"acceleration_limit@{JOINT}:acceleration={limit_rad_s2}")


def unexplained(predictor):
    """Half the sum of squares [nats] that the nominal model leaves."""
    predictor.calibrate((), tolerances=False)
    (left,) = predictor.residuals([()])
    return 0.5 * float(left @ left)


def best_fit(trace):
    """The best of the fits that begin with the limits that a search tries."""
    usage, predictor = Usage.of(plant(), [trace]), predictor_of(trace)
    tries = effect("acceleration_limit").first_tries(plant(), JOINT, usage)
    fits = [fitted(predictor, ("acceleration_limit", JOINT, *one)) for one in tries]
    best = min(fits, key=lambda fit: fit.energy)
    # where limits change much, their integration error does as well
    return fitted(predictor, ("acceleration_limit", JOINT, *best.model[0].values))


@pytest.mark.slow
@pytest.mark.parametrize("limit_rad_s2", [4.5, 6.0, 9.0])
def test_it_is_found_with_its_value(limit_rad_s2):
    """The stronger the limit, the more a thousandth of it changes."""
    fit = best_fit(truth(limit_rad_s2))
    assert fit.model[0].values == pytest.approx((limit_rad_s2,), rel=0.003)
    predictor = predictor_of(truth(limit_rad_s2))
    noise, spread = floor(predictor)
    assert fit.energy < max(noise + 3 * spread + 20, 1e-3 * unexplained(predictor))
    for others in [(SLOW,), (LATENCY,), (SLOW, LATENCY)]:
        assert fitted(predictor, *others).energy > 20 * fit.energy


@pytest.mark.slow
@pytest.mark.parametrize(
    ("effects", "right"),
    [
        ([], []),
        ([f"speed_limit@{JOINT}:speed=0.8"], [("speed_limit", JOINT, 0.8)]),
        (["command_latency:delay=0.01"], [("command_latency", "commands", 0.01)]),
    ],
    ids=["nothing", "speed", "latency"],
)
def test_it_is_not_taken_for_its_neighbours(effects, right):
    predictor = predictor_of(recorded(*effects))
    before = unexplained(predictor)
    if right:
        true = fitted(predictor, *right)
        assert fitted(predictor, GENTLE).energy > true.energy + 200
        before = true.energy
        right = [(*right[0][:2], *true.model[0].values)]
    assert fitted(predictor, *right, GENTLE).energy > before - CHANCE


@pytest.mark.parametrize("factor", [0.5, 2.0])
def test_the_limits_that_are_tried_may_be_twice_or_half_as_large(factor, monkeypatch):
    some = tuple(factor * rise_s for rise_s in set_points.RISES_S)
    monkeypatch.setattr(set_points, "RISES_S", some)
    assert best_fit(truth(6.0)).model[0].values == pytest.approx((6.0,), rel=0.02)

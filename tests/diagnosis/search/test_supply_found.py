"""A supply that sags under load in the hidden world: found, and told from others."""

import pytest
from hidden_arm import fitted, floor, predictor_of, recorded

SAG = ("supply_sag", "supply", 0.15)
GAINS = [("servo_gain", "J1", 0.95), ("servo_gain", "J2", 0.95)]
LIVELY = {"size": 0.5, "fastest": 9.0}
"""Motion with a sixth of the full load in the mean; a third at most."""

CHANCE = 6.0
"""More nats than one value gains by chance in 999 of 1000 cases (chi squared)."""


def unexplained(predictor):
    """Half the sum of squares [nats] that the nominal model leaves."""
    predictor.calibrate((), tolerances=False)
    (left,) = predictor.residuals([()])
    return 0.5 * float(left @ left)


@pytest.mark.slow
@pytest.mark.parametrize("share", [0.1, 0.2, 0.4])
def test_it_is_found_with_its_value(share):
    predictor = predictor_of(recorded(f"supply_sag:share={share}", **LIVELY))
    fit = fitted(predictor, SAG)
    assert fit.model[0].values == pytest.approx((share,), abs=0.006)
    noise, spread = floor(predictor)
    assert fit.energy < noise + 3 * spread
    for others in [GAINS, [("load_friction", "J1", 0.05)], [("torque_limit", "J1", 7)]]:
        assert fitted(predictor, *others).energy > fit.energy + 20


@pytest.mark.slow
@pytest.mark.parametrize(
    ("effects", "right"),
    [([], []), (["servo_gain@J1:factor=0.9"], [("servo_gain", "J1", 0.9)])],
    ids=["nothing", "gain"],
)
def test_it_is_not_taken_for_its_neighbours(effects, right):
    predictor = predictor_of(recorded(*effects, **LIVELY))
    before = unexplained(predictor)
    if right:
        true = fitted(predictor, *right)
        assert fitted(predictor, SAG).energy > true.energy + 200
        before = true.energy
        right = [(*right[0][:2], *true.model[0].values)]
    assert fitted(predictor, *right, SAG).energy > before - CHANCE

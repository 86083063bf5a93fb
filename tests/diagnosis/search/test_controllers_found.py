"""Firmware of servos in the hidden world: found, and told from what is near it."""

import numpy as np
import pytest
from hidden_arm import errors, fitted, floor, plant, predictor_of, recorded
from known_arms import SINGLE

from diagnosis.effects import controllers as effects
from diagnosis.effects.library import effect
from diagnosis.effects.parts import PlacedEffect
from diagnosis.pipeline import diagnose
from diagnosis.replay import controllers as laws
from diagnosis.traces.usage import Usage

JOINT = "J2"
INTEGRAL = ("integral_term", JOINT, 1.0)
BAND = ("dead_band", JOINT, 0.005)
DERIVATIVE = ("error_derivative", JOINT, 0.3)
BACKLASH = ("backlash", JOINT, 0.02)
GAIN, DAMPING = ("servo_gain", JOINT, 1.1), ("servo_damping", JOINT, 0.8)
CONSTANT = ("torque_offset", JOINT, 0.1)
LATENCY = ("command_latency", "commands", 0.005)
CHANCE = 6.0
"""More nats than one value gains by chance in 999 of 1000 cases (chi squared)."""


def found_in(predictor, start, more=0.0):
    """The value of a fit that leaves noise, and `more` [nats], and its error."""
    noise, spread = floor(predictor)
    fit = fitted(predictor, start)
    assert fit.energy < noise + 3 * spread + more
    ((value,),) = (one.values for one in fit.model)
    (coordinate,) = fit.coordinates.parameters
    size = value if coordinate.logarithmic else coordinate.typical
    return value, float(errors(fit)[0]) * size


def unexplained(predictor):
    """Half the sum of squares [nats] that the nominal model leaves."""
    predictor.calibrate((), tolerances=False)
    (left,) = predictor.residuals([()])
    return 0.5 * float(left @ left)


# At three sizes


@pytest.mark.parametrize("time_s", [0.2, 1.0, 5.0])
def test_an_integral_term_is_found(time_s):
    predictor = predictor_of(recorded(f"integral_term@{JOINT}:time={time_s}"))
    value, error = found_in(predictor, INTEGRAL)
    assert abs(value - time_s) < 4 * error
    noise, _ = floor(predictor)
    for others in [(GAIN,), (CONSTANT,), (GAIN, CONSTANT)]:
        assert fitted(predictor, *others).energy > 5 * noise


def test_a_long_integral_time_is_none():
    """What it has gathered at the start is nothing, either."""
    truth = recorded(f"coulomb_friction@{JOINT}:torque=0.2")
    predictor = predictor_of(truth)
    predictor.correct(())
    longest = PlacedEffect("integral_term", JOINT, (1e4,))
    without, nearly = predictor.residuals([(), (longest,)])
    change = nearly - without
    assert 0.5 * change @ change < 1.0


@pytest.mark.parametrize("factor", [0.5, 2.0])
def test_how_long_a_robot_has_been_on_does_not_matter(factor, monkeypatch):
    predictor = predictor_of(recorded(f"integral_term@{JOINT}:time=5.0"))
    value, error = found_in(predictor, INTEGRAL)
    monkeypatch.setattr(laws, "ON_S", factor * laws.ON_S)
    again, _ = found_in(predictor, INTEGRAL)
    assert abs(again - value) < error


@pytest.mark.slow
@pytest.mark.parametrize("width_rad", [0.003, 0.01, 0.03])
def test_a_dead_band_is_found(width_rad):
    """Where the joint is at the band's edge, the two engines' steps differ, too."""
    predictor = predictor_of(recorded(f"dead_band@{JOINT}:width={width_rad}"))
    value, error = found_in(predictor, BAND, more=20)
    assert abs(value - width_rad) < 4 * error + 1e-5
    own = fitted(predictor, BAND).energy
    for other in (("backlash", JOINT, width_rad), GAIN):
        assert fitted(predictor, other).energy > own + 50


@pytest.mark.parametrize("share", [0.1, 0.3, 0.9])
def test_a_derivative_of_the_error_is_found(share):
    predictor = predictor_of(recorded(f"error_derivative@{JOINT}:share={share}"))
    value, error = found_in(predictor, DERIVATIVE)
    assert abs(value - share) < 4 * error + 0.002  # by the two engines' steps
    noise, _ = floor(predictor)
    for others in [(DAMPING,), (LATENCY,), (DAMPING, LATENCY)]:
        assert fitted(predictor, *others).energy > 3 * noise


# Where they are not


@pytest.mark.parametrize("own", [INTEGRAL, BAND, DERIVATIVE], ids=lambda one: one[0])
def test_where_nothing_is_missing_none_is_found(own):
    predictor = predictor_of(recorded())
    assert fitted(predictor, own).energy > unexplained(predictor) - CHANCE


NEIGHBOURS = [
    ("servo_gain@J2:factor=1.2", GAIN, INTEGRAL),
    ("backlash@J2:gap=0.004", BACKLASH, BAND),
    ("coulomb_friction@J2:torque=0.2", ("coulomb_friction", JOINT, 0.1), BAND),
    ("servo_damping@J2:factor=0.7", DAMPING, DERIVATIVE),
    ("command_latency:delay=0.01", LATENCY, DERIVATIVE),
    ("late_reading@J2:delay=0.01", ("late_reading", JOINT, 0.004), DERIVATIVE),
]


@pytest.mark.slow
@pytest.mark.parametrize(
    ("truth", "right", "own"), NEIGHBOURS, ids=[one[0] for one in NEIGHBOURS]
)
def test_none_is_taken_for_its_neighbours(truth, right, own):
    """Alone it leaves far more than the truth; beside it, it gains by chance only."""
    predictor = predictor_of(recorded(truth))
    true = fitted(predictor, right)
    assert fitted(predictor, own).energy > true.energy + 200
    values = true.model[0].values
    beside = fitted(predictor, (*right[:2], *values), own)
    assert beside.energy > true.energy - CHANCE


# In the midst of a motion, and beside friction


@pytest.mark.parametrize("first", [170, 250, 333])
def test_an_integral_begins_with_what_the_motion_needs(first, monkeypatch):
    """From a start with no torque a part of a recording leaves far more than noise."""
    truth = [f"integral_term@{JOINT}:time=1", f"coulomb_friction@{JOINT}:torque=0.3"]
    part = recorded(*truth, duration_s=6.0).part(first, first + 250)
    predictor = predictor_of(part)
    noise, spread = floor(predictor)
    every = INTEGRAL, ("coulomb_friction", JOINT, 0.2)
    fit = fitted(predictor, *every)
    assert fit.energy < noise + 3 * spread
    (time_s,), (torque,) = (one.values for one in fit.model)
    assert time_s == pytest.approx(1.0, rel=0.01)
    assert torque == pytest.approx(0.3, rel=0.01)
    begin = laws.BatchControllers.begin
    monkeypatch.setattr(laws.BatchControllers, "begin", lambda own, nm=None: begin(own))
    assert fitted(predictor, *every).energy > noise + 5 * spread


# Constants


@pytest.mark.parametrize("factor", [0.5, 2.0])
def test_the_lag_of_a_set_point_s_rate_may_be_twice_or_half(factor, monkeypatch):
    predictor = predictor_of(recorded(f"error_derivative@{JOINT}:share=0.3"))
    lags = laws.DERIVATIVE_LAGS
    monkeypatch.setattr(laws, "DERIVATIVE_LAGS", factor * lags)
    fit = fitted(predictor, DERIVATIVE)
    assert fit.model[0].values == pytest.approx((0.3,), rel=0.01)
    left = fit.energy - floor(predictor)[0]
    assert left < 1e-3 * unexplained(predictor)


@pytest.mark.parametrize("factor", [0.5, 2.0])
def test_the_bands_that_are_tried_may_be_twice_or_half_as_wide(factor, monkeypatch):
    trace = recorded(f"dead_band@{JOINT}:width=0.01")
    predictor, usage = predictor_of(trace), Usage.of(plant(), [trace])
    some = tuple(factor * share for share in effects.BAND_SHARES)
    monkeypatch.setattr(effects, "BAND_SHARES", some)
    tries = effect("dead_band").first_tries(plant(), JOINT, usage)
    assert len({values for values in tries}) == 2
    for values in tries:
        fit = fitted(predictor, ("dead_band", JOINT, *values))
        assert fit.model[0].values == pytest.approx((0.01,), rel=0.02)


@pytest.mark.slow
def test_a_whole_diagnosis_names_an_integral_term():
    truth = f"integral_term@{JOINT}:time=1"
    traces = [recorded(truth, seed=seed, duration_s=3.0) for seed in range(3)]
    verdict = diagnose(plant(), traces, np.random.SeedSequence(0), SINGLE).verdict
    assert verdict.kind == "effects"
    (found,) = verdict.effects
    assert (found.name, found.place) == ("integral_term", JOINT)
    time = found.parameters["time"]
    assert time.value == pytest.approx(1.0, rel=0.01)
    assert time.low < 1.0 < time.high
    assert verdict.fit.corrected < 1.2

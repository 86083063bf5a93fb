"""Joints that are read one after the other: what of that recordings show."""

import numpy as np
import pytest
from hidden_arm import errors, fitted, floor, plant, predictor_of, recorded
from known_arms import SINGLE

from diagnosis.effects.library import effect
from diagnosis.pipeline import diagnose

LATE = ("late_reading", "J2", 0.004)
LATENCY = ("command_latency", "commands", 0.004)


@pytest.mark.parametrize("delay_s", [0.002, 0.006, 0.02])
def test_how_late_one_joint_is_read_is_found(delay_s):
    predictor = predictor_of(recorded(f"late_reading@J2:delay={delay_s}"))
    noise, spread = floor(predictor)
    fit = fitted(predictor, LATE)
    assert fit.energy < noise + 3 * spread
    (found,) = fit.model
    (error,) = 0.005 * errors(fit)
    assert abs(found.values[0] - delay_s) < 3 * error + 1e-5  # half a step of Euler's
    for other in (
        LATENCY,
        ("late_reading", "J1", 0.004),
        ("viscous_friction", "J2", 0.1),
        ("servo_damping", "J2", 1.1),
    ):
        assert fitted(predictor, other).energy > noise + 200


def test_late_commands_are_not_mistaken_for_one_late_joint():
    predictor = predictor_of(recorded("command_latency:delay=0.02"))
    noise, spread = floor(predictor)
    assert fitted(predictor, LATENCY).energy < noise + 3 * spread
    assert fitted(predictor, LATE).energy > 100 * noise


def test_all_joints_together_are_as_late_as_the_commands():
    """Only what a joint is later than others can be told from a latency."""
    truth = [f"late_reading@J{k}:delay={delay}" for k, delay in ((1, 0.01), (2, 0.016))]
    predictor = predictor_of(recorded(*truth))
    noise, spread = floor(predictor)
    both = fitted(predictor, ("late_reading", "J1", 0.004), LATE)
    beside = fitted(predictor, LATENCY, LATE)
    for fit in (both, beside):
        assert fit.energy < noise + 3 * spread
    assert beside.energy == pytest.approx(both.energy, abs=1)
    latency, late = (one.values[0] for one in beside.model)
    assert latency == pytest.approx(0.01, abs=1e-4)
    assert late == pytest.approx(0.006, abs=1e-4)


def test_a_command_that_one_servo_gets_late_looks_like_a_late_reading():
    """Servos are stiff: what the joint does to others later hardly shows beside noise.

    A motion that is 10 ms late is off by 50 times the noise.
    """
    predictor = predictor_of(recorded(late_rows=(0, 1)))
    fit = fitted(predictor, LATE)
    (found,) = fit.model
    assert found.values[0] == pytest.approx(0.01, abs=1e-3)
    rms = np.sqrt(np.square(fit.residual[predictor.scored]).mean())
    assert 1.0 < rms < 1.5


def test_where_it_may_be():
    from wheel_rig import wheel

    trace = recorded()
    assert effect("late_reading").places(plant(), [trace]) == ("J1", "J2")
    assert effect("late_reading").places(wheel(), []) == ()


@pytest.mark.slow
def test_a_whole_diagnosis_names_it():
    traces = [
        recorded("late_reading@J2:delay=0.006", seed=seed, duration_s=3.0)
        for seed in range(3)
    ]
    verdict = diagnose(plant(), traces, np.random.SeedSequence(0), SINGLE).verdict
    assert verdict.kind == "effects"
    (found,) = verdict.effects
    assert (found.name, found.place) == ("late_reading", "J2")
    delay = found.parameters["delay"]
    assert delay.value == pytest.approx(0.006, abs=2e-4)
    assert delay.low < 0.006 < delay.high

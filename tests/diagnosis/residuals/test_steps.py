"""Long steps show a little less than short ones, and fits in them end at the same."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from known_arms import CHANNELS
from made_up_traces import arm, recorded

from diagnosis.effects.parts import PlacedEffect
from diagnosis.residuals import steps
from diagnosis.residuals.predictor import STEPS_S, Predictor
from diagnosis.search.fitting import fit_all

LONG_S, *_, SHORT_S = STEPS_S["fixed"]
FINEST_S = SHORT_S / 4
START = (
    PlacedEffect("coulomb_friction", "shoulder", (0.2,)),
    PlacedEffect("servo_gain", "elbow", (1.0,)),
)
TRUE = ("coulomb_friction", "shoulder", 0.4), ("servo_gain", "elbow", 0.7)


@pytest.fixture(scope="module")
def trace():
    return recorded(arm(), *TRUE, duration_s=2.0, noise_rad=1e-5)


def fitted(trace, step_s, again):
    """Values that fit; the error of steps is measured `again` at each model found."""
    predictor = Predictor(arm(), [trace], CHANNELS, step_s, finest_s=FINEST_S)
    predictor.calibrate()
    predictor = predictor.nominal()
    predictor.correct()
    model = fit_all(predictor, [START])[0].model
    for _ in range(again):
        predictor.correct(model)
        model = fit_all(predictor, [model])[0].model
    return [placed.values[0] for placed in model]


def wrong(trace, again):
    long, short = (fitted(trace, step_s, again) for step_s in (LONG_S, SHORT_S))
    return max(abs(a / b - 1) for a, b in zip(long, short, strict=True))


@pytest.mark.slow
def test_fits_in_long_steps_end_at_the_values_of_short_ones(trace):
    assert wrong(trace, again=2) < 2e-4
    assert wrong(trace, again=0) > 1e-3


def stiff():
    plant = arm(kp=60.0, kd=1.5)
    return Predictor(plant, [recorded(plant, duration_s=1.0)], CHANNELS)


def test_steps_are_shortened_where_effects_would_be_distorted(monkeypatch):
    monkeypatch.setattr(steps, "DISTORTED", 1.0)
    assert steps.with_best_steps(stiff()).steps_s == [LONG_S]
    monkeypatch.setattr(steps, "DISTORTED", 1e-4)
    assert steps.with_best_steps(stiff()).steps_s == [SHORT_S]


def test_only_recordings_that_need_it_take_short_steps():
    """Servos saturate, and leave saturation within a step, where commands jump."""
    plant = arm(kp=60.0, kd=1.5, limit=4.0)
    slow = recorded(plant, duration_s=2.0)
    fast = replace(slow, command_rad=0.5 * np.sign(slow.command_rad))
    whole = steps.with_best_steps(Predictor(plant, [slow, fast], CHANNELS))
    assert whole.steps_s[0] > whole.steps_s[1]


class Measured:
    """Something whose integration error is known by its shortest step [s]."""

    def __init__(self, errors, base="fixed", step_s=LONG_S, finest_s=LONG_S / 4):
        self.plant, self.errors = SimpleNamespace(base=base), errors
        self.step_s, self.finest_s = step_s, finest_s

    def stepped(self, step_s, finest_s):
        return Measured(self.errors, self.plant.base, step_s, finest_s)

    def correct(self, model):
        return np.array([self.errors[self.finest_s]])

    def doubt(self, model, tolerances):
        pass


@pytest.mark.parametrize("enough_s", [LONG_S / 4, FINEST_S, steps.FINEST_S])
def test_the_integration_error_is_measured_with_steps_as_short_as_it_needs(enough_s):
    tried = LONG_S / 4, LONG_S / 8, FINEST_S, steps.FINEST_S
    errors = {one: 0.1 if one <= enough_s else 3.0 for one in tried}
    exact = steps.exact_steps(Measured(errors))
    assert (exact.step_s, exact.finest_s) == (LONG_S, enough_s)


def test_steps_of_a_floating_base_are_not_shortened_for_what_contacts_do():
    (step_s,) = STEPS_S["floating"]
    exact = steps.exact_steps(Measured({step_s / 4: 3.0}, "floating", step_s))
    assert (exact.step_s, exact.finest_s) == (step_s, step_s / 4)

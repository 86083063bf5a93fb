"""An event stands out from the bursts of error that a robot has at all times."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from known_arms import CHANNELS, NOISE_RAD
from made_up_traces import arm, recorded

from diagnosis.conclude import usual_bursts
from diagnosis.conclude.usual_bursts import (
    FEWEST,
    burst_nats,
    largest_by_chance,
    usual_event,
)
from diagnosis.effects.parts import PlacedEffect
from diagnosis.residuals.predictor import Predictor
from diagnosis.search.fitting import fit_all

OFF = "servo_off", "elbow", 0.6, 1.5, 0.1


@cache
def diagnosed(often):
    """An elbow that was weak for a moment; it may also jump again and again."""
    trace = recorded(arm(), OFF, duration_s=8.0)
    if often:
        jumped = trace.position_rad.copy()
        for row, size in zip(range(110, 390, 40), [9, 8, 7, 8, 9, 6, 8], strict=True):
            jumped[row : row + 3, 1] += size * NOISE_RAD
        trace = replace(trace, position_rad=jumped)
    both = Predictor(arm(), [trace], CHANNELS)
    model = (PlacedEffect(OFF[0], OFF[1], OFF[2:]),)
    both.calibrate(model, tolerances=False)
    return both, fit_all(both, [model])[0]


@pytest.mark.parametrize(
    ("name", "factor"),
    [("TAIL", 1), ("TAIL", 0.5), ("TAIL", 2), ("SHOWS_S", 0.5), ("SHOWS_S", 2)],
)
@pytest.mark.parametrize("often", [True, False])
def test_what_happens_again_and_again_is_no_event(often, name, factor, monkeypatch):
    own = getattr(usual_bursts, name)
    monkeypatch.setattr(usual_bursts, name, type(own)(own * factor))
    both, fitted = diagnosed(often)
    found = usual_event(both, (), fitted)
    assert (found.name if found else None) == ("servo_off" if often else None)


@pytest.mark.slow
def test_what_the_healthy_robot_does_as_well_is_no_event():
    both, fitted = diagnosed(often=False)
    healthy, _ = diagnosed(often=True)
    found = usual_event(both, [healthy], fitted)
    assert found is not None


def test_what_lasts_is_never_an_event():
    gain = PlacedEffect("servo_gain", "elbow", (0.7,))
    both = Predictor(arm(), [recorded(arm())], CHANNELS)
    both.calibrate()
    assert usual_event(both, (), fit_all(both, [(gain,)])[0]) is None


@pytest.mark.parametrize("scale", [1.0, 20.0])
def test_one_set_of_bursts_in_a_hundred_has_a_larger_one_by_chance(scale):
    """Sums of squares of noise have nearly an exponential tail."""
    rng = np.random.default_rng(1)
    larger = 0
    for _ in range(2000):
        learned, other = scale * rng.chisquare(10, (2, 200))
        larger += other.max() > largest_by_chance(learned)
    assert 0.003 < larger / 2000 < 0.05
    assert largest_by_chance(learned[: FEWEST - 1]) == 0


def test_bursts_are_energies_above_noise():
    trace = recorded(arm(), duration_s=2.0)
    some = Predictor(arm(), [trace], CHANNELS)
    some.calibrate()
    residual = some.scored.astype(float)
    assert np.allclose(burst_nats(some, residual, 0.2), 0.0)
    found = burst_nats(some, 2 * residual, 0.2)  # 10 rows or so each, minus the start
    assert np.isclose(np.median(found[found > 0]), 1.5 * 10)

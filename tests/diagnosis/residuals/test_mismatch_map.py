"""Errors that are made up of a kind, and where they are said to be."""

from dataclasses import replace

import numpy as np
import pytest
from joint_rigs import ticks, trace_of
from made_up_traces import arm

from diagnosis.residuals.mismatch_map import mismatch_map
from diagnosis.residuals.predictor import Channels, Predictor
from diagnosis.traces.smoothing import moving_mean

NOISE_RAD = 4e-4
CHANNELS = Channels(("position.shoulder", "position.elbow"), np.full(2, NOISE_RAD))
TIME_S = ticks(8.0, 0.02)
PERIOD_S = 2.0
PHASE = 2 * np.pi * TIME_S / PERIOD_S


def predictor_of(middle_rad=0.0):
    """Of an arm whose elbow swings and whose shoulder rests."""
    plant = arm()
    noise = NOISE_RAD * np.random.default_rng(0).standard_normal((len(TIME_S), 2))
    position = noise + middle_rad
    position[:, 1] += 0.4 * np.sin(PHASE)
    return Predictor(plant, [trace_of(plant, TIME_S, position)], CHANNELS)


@pytest.fixture(scope="module")
def predictor():
    return predictor_of()


def cells(predictor, of_elbow):
    """Of an error (T,) at the elbow, with noise everywhere."""
    residual = np.random.default_rng(1).standard_normal((len(TIME_S), 2))
    residual[:, 1] += of_elbow
    return mismatch_map(predictor, residual.ravel() * predictor.scored)


VELOCITY = np.cos(PHASE)
ELSEWHERE = {
    "reversals": ("fast", np.abs(VELOCITY) < np.sin(2 * np.pi * 0.05 / PERIOD_S)),
    "forward": ("backward", VELOCITY > 0.15),
    "backward": ("forward", VELOCITY < -0.15),
    "fast": ("slow", np.abs(VELOCITY) > 0.7),
    "slow": ("fast", np.abs(VELOCITY) < 0.25),
    "last third": ("first third", TIME_S > 16 / 3),
    "high positions": ("low positions", np.sin(PHASE) > 0.75),
}


@pytest.mark.parametrize("regime", ELSEWHERE)
def test_an_error_shows_in_its_regime(predictor, regime):
    """More than in any that it is no part of, and in the opposite one not at all."""
    opposite, where = ELSEWHERE[regime]
    worst = cells(predictor, 10.0 * where)[0]
    assert worst.channel == "position.elbow"
    assert worst.regimes[regime] > 6
    others = {name for name in worst.regimes if {name, regime} != {"slow", "reversals"}}
    assert worst.regimes[regime] == max(worst.regimes[name] for name in others)
    assert worst.regimes[opposite] < 1.3


def test_shares_are_of_the_energy_above_the_noise(predictor):
    worst, other = cells(predictor, 5.0)
    assert worst.share > 0.97
    assert worst.share + other.share == pytest.approx(1.0)
    assert worst.error_rms == pytest.approx(np.sqrt(26) * NOISE_RAD, rel=0.03)
    assert worst.noise_rms == NOISE_RAD
    assert other.error_rms == pytest.approx(NOISE_RAD, rel=0.1)


def test_regimes_do_not_depend_on_where_zero_is(predictor):
    error = 10.0 * ELSEWHERE["reversals"][1]
    here, there = (cells(p, error)[0] for p in (predictor, predictor_of(2.0)))
    assert here.regimes == pytest.approx(there.regimes)


def test_a_joint_without_positions_has_no_regimes(predictor):
    trace = predictor.traces[0]
    position = trace.position_rad.copy()
    position[:, 0] = np.nan
    blind = Predictor(
        predictor.plant, [replace(trace, position_rad=position)], CHANNELS
    )
    by_name = {cell.channel: cell for cell in cells(blind, 0.0)}
    assert by_name["position.shoulder"].regimes == {}
    assert by_name["position.shoulder"].error_rms == 0.0
    assert by_name["position.elbow"].regimes


@pytest.mark.parametrize("width", [1, 4, 5])
def test_means_over_neighbours(width):
    values = np.arange(20.0) ** 2
    found = moving_mean(values, width)
    first = 10 - width // 2
    assert found[10] == pytest.approx(values[first : first + width].mean())
    np.testing.assert_allclose(moving_mean(np.full(9, 3.0), width), 3.0)

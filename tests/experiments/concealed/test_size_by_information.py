"""Tests the nats of simulated motions, and the search for the ease that gives them."""

import math
from types import SimpleNamespace

import numpy as np
import pytest

from experiments.concealed.second.information import MOST_NATS_2
from experiments.concealed.size_by_information import (
    FAR,
    KEPT,
    LEAST_EASE,
    LEVELS,
    MOST_EASE,
    MOST_NATS,
    MOST_TRIALS,
    NEAR,
    SHARES,
    drawn_nats,
    ease_that_tells,
    level_of,
    nats,
)
from worlds.hidden.recorded import HiddenSensors

SENSORS = HiddenSensors(quantum_rad=0.0, encoder_rad=0.001)


def run(encoder_rad, first=2, ok=True):
    clock = SimpleNamespace(first=first)
    return SimpleNamespace(encoder_rad=encoder_rad, clock=clock, ok=ok)


def test_half_the_squared_difference_in_units_of_noise():
    """Nats are the log-likelihood ratio of two Gaussians that differ in their mean."""
    was = np.zeros((12, 3))
    now = was.copy()
    now[:, 1] = 0.002  # two standard deviations in each of ten rows
    assert nats([run(was)], [run(now)], SENSORS) == pytest.approx(KEPT * 0.5 * 10 * 4)


def test_what_one_recording_tells_is_not_told():
    was, now = np.zeros((12, 3)), np.full((12, 3), 0.002)
    one = nats([run(was)] * 3, [run(now), run(was), run(was)], SENSORS)
    two = nats([run(was)] * 3, [run(now), run(now), run(was)], SENSORS)
    assert one == 0.0
    assert two == nats([run(was)], [run(now)], SENSORS) > 0.0


def test_rounding_is_noise_and_what_blows_up_tells_everything():
    was, now = np.zeros((12, 1)), np.full((12, 1), 0.002)
    coarse = HiddenSensors(quantum_rad=0.001 * math.sqrt(12), encoder_rad=0.001)
    wanted = KEPT * 0.5 * 10 * 4 / 2
    assert nats([run(was)], [run(now)], coarse) == pytest.approx(wanted)
    assert nats([run(was)], [run(now, ok=False)], SENSORS) == math.inf


@pytest.mark.parametrize("slope", [3.0, 6.0, 14.0])
@pytest.mark.parametrize("wanted", [2.0, 50.0, 1e4])
def test_the_ease_is_found(slope, wanted):
    calls = []

    def told(ease):
        calls.append(ease)
        return math.exp(5.0 + slope * ease + 0.3 * math.sin(3 * ease))

    ease = ease_that_tells(wanted, told, first=0.7)
    assert len(calls) <= MOST_TRIALS
    if told(LEAST_EASE) < wanted < told(MOST_EASE):
        assert ease is not None
        assert abs(math.log(told(ease) / wanted)) < NEAR
    elif ease is not None:
        assert ease in (LEAST_EASE, MOST_EASE)
        assert abs(math.log(told(ease) / wanted)) < FAR


def test_where_no_size_tells_so_much_there_is_none():
    assert ease_that_tells(1e5, lambda ease: 3.0 * math.exp(ease), first=0.2) is None
    assert ease_that_tells(1.0, lambda ease: 1e4 * math.exp(ease), first=0.2) is None


@pytest.mark.parametrize("wanted", [5.0, 50.0, 2000.0])
@pytest.mark.parametrize("first", [-0.5, 0.3, 0.9])
def test_what_tells_nothing_when_small_does_not_mislead(wanted, first):
    """Some sizes give no nats, such as a torque limit that is not reached."""

    def told(ease):
        return 0.0 if ease < 0.4 else math.exp(20 * (ease - 0.4))

    ease = ease_that_tells(wanted, told, first)
    assert ease is not None
    assert abs(math.log(told(ease) / wanted)) < FAR


@pytest.mark.parametrize("most", [MOST_NATS, MOST_NATS_2])
def test_levels_come_as_often_as_they_should(most):
    rng = np.random.default_rng(0)
    drawn = np.array([drawn_nats(rng, most) for _ in range(4000)])
    levels = [level_of(nats) for nats in drawn]
    for name, share in SHARES.items():
        assert levels.count(name) / len(drawn) == pytest.approx(share, abs=0.03)
    assert SHARES.keys() == LEVELS.keys()
    assert sum(SHARES.values()) == pytest.approx(1.0)
    assert 1.0 <= drawn.min() < drawn.max() <= most


@pytest.mark.parametrize(
    ("told", "level"),
    [(1e6, "L1"), (100.0, "L1"), (99.0, "L2"), (5.0, "L3"), (2.0, "L4"), (-3.0, "L4")],
)
def test_a_level_is_reached_by_its_least(told, level):
    assert level_of(told) == level

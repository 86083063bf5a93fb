import numpy as np
import pytest

from experiments.reports.statistics import half_fall
from groundwalk.errors import BadValueError

LADDER = np.geomspace(0.002, 0.032, 5)


def drawn(rng, middle, width, trials=8, ladder=LADDER):
    """Falls on a ladder where the share that falls is known."""
    x = np.log(ladder / middle) / np.log(ladder[-1] / ladder[0])
    return rng.binomial(trials, 1 / (1 + np.exp(-x / width)))


def test_many_trials_find_the_half():
    falls = drawn(np.random.default_rng(1), 0.007, 0.1, trials=4000)
    found = half_fall(LADDER, falls, [4000] * 5)
    assert found.severity == pytest.approx(0.007, rel=0.02)
    assert found.low < 0.007 < found.high
    assert found.high / found.low < 1.1


@pytest.mark.parametrize("width", [0.03, 0.12])
def test_intervals_hold_the_truth_as_often_as_they_say(width):
    rng = np.random.default_rng(2)
    held = 0
    for _ in range(150):
        middle = LADDER[0] * 16 ** rng.uniform(0.2, 0.8)
        found = half_fall(LADDER, drawn(rng, middle, width), [8] * 5)
        low, high = found.low or 0.0, found.high or np.inf
        held += low <= middle <= high
    # 95 % of 150 are 142; binomial: fewer than 133 have a chance of 3 in 1000
    assert held >= 133


def test_a_jump_between_two_rungs_is_put_in_their_middle():
    found = half_fall(LADDER, [0, 0, 8, 8, 8], [8] * 5)
    assert found.severity == pytest.approx(np.sqrt(LADDER[1] * LADDER[2]), rel=0.01)
    # half the trials may well fall at a rung where 0 of 8 did not show it
    assert LADDER[1] * 0.8 < found.low < found.severity < found.high < LADDER[2] * 1.25


@pytest.mark.parametrize(("falls", "beyond"), [([0] * 5, ">"), ([8] * 5, "<")])
def test_what_was_not_reached_gets_no_number(falls, beyond):
    found = half_fall(LADDER, falls, [8] * 5)
    assert found.beyond == beyond
    if beyond == ">":
        assert found.severity == LADDER[-1]
        assert found.high is None
        assert LADDER[2] < found.low <= LADDER[-1]
    else:
        assert found.severity == LADDER[0]
        assert found.low is None
        assert LADDER[0] <= found.high < LADDER[2]


def test_few_falls_at_the_end_are_not_extrapolated():
    found = half_fall(LADDER, [0, 0, 0, 0, 2], [8] * 5)
    assert found.beyond == ">"
    assert found.low is not None


def test_a_ladder_may_lead_down():
    falls = [0, 1, 4, 7, 8]
    up, down = half_fall(LADDER, falls, [8] * 5), half_fall(1 / LADDER, falls, [8] * 5)
    assert down.severity == pytest.approx(1 / up.severity)
    assert (down.low, down.high) == pytest.approx((1 / up.low, 1 / up.high))
    assert down.low > down.high


@pytest.mark.parametrize("ladder", [[1.0], [1, 1, 2], [1, 3, 2], [0, 1], [-1, 1]])
def test_what_is_no_ladder_is_refused(ladder):
    with pytest.raises(BadValueError, match="from mild to hard"):
        half_fall(ladder, [0] * len(ladder), [1] * len(ladder))

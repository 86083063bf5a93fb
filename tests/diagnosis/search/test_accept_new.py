"""An effect is new if it gains now, nearly always, what it would not have before."""

from types import SimpleNamespace

import numpy as np
import pytest

from diagnosis.search.result import SearchResult
from diagnosis.search.steady_gains import with_steady_gains

FIRST, SECOND = ("first",), ("first", "second")


class Known:
    """A predictor of eight moments, of ten values each, whose gains are given."""

    def __init__(self, base="floating", **gains):
        self.plant = SimpleNamespace(base=base)
        self._gains = {"": np.zeros(8)} | {
            name: np.array(values, float) for name, values in gains.items()
        }
        self.block = np.repeat(np.arange(8), 10)
        self.scored = np.ones(80, bool)

    def residuals(self, models):
        """Of one value in each moment; the energy is 1000 without any effect."""
        found = np.zeros((len(models), 8, 10))
        for row, model in zip(found, models, strict=True):
            gain = sum((self._gains[name] for name in model), np.zeros(8))
            row[:, 0] = np.sqrt(2 * (1000 - gain))
        return found.reshape(len(models), -1)


def chosen(now, before, size=1, fit=None):
    best = {1: [SimpleNamespace(model=FIRST)], 2: [SimpleNamespace(model=SECOND)]}
    judge = SimpleNamespace(fit=fit or now, select=now, healthy=before)
    return with_steady_gains(judge, SearchResult(0.0, 0.0, best, size)).chosen


STEADY, WILD = [20, 25, 18, 22, 24, 19, 21, 23], [150, -20, 3, -15, 5, -10, 8, 2]
NONE = [-1, 2, 0, -2, 1, 0, -1, 1]


@pytest.mark.parametrize(
    ("now", "before", "expected"),
    [
        (STEADY, NONE, 1),
        (STEADY, [-50] * 8, 1),
        ([800, 400, 200, 50, 30, 20, 300, 90], NONE, 1),  # at some far more
        (STEADY, STEADY[::-1], 0),
        (WILD, NONE, 0),
        (STEADY, WILD, 0),
    ],
)
def test_what_is_new_gains_at_all_moments_and_did_not_before(now, before, expected):
    assert chosen(Known(first=now), [Known(first=before)]) == expected


def test_a_second_effect_must_be_new_by_itself():
    now = Known(first=STEADY, second=WILD)
    before = Known(first=NONE, second=NONE)
    assert chosen(now, [before], size=2) == 1
    better = Known(first=STEADY, second=STEADY)
    assert chosen(better, [before], size=2) == 2


def test_a_longer_reference_expects_no_more():
    """What is to be expected grows with the time, whichever the reference has."""
    before = Known(first=[10] * 8)
    now = Known(first=[14, 15, 16, 15, 14, 16, 15, 15])
    assert chosen(now, [before]) == chosen(now, [before, before]) == 1


@pytest.mark.parametrize(("fitted", "expected"), [([25] * 8, 1), ([-25] * 8, 0)])
def test_few_moments_of_each_kind_of_data_tell_together(fitted, expected):
    now = Known(first=[30, 2, 28, -1, 35, 0, 4, 1])
    before = Known(first=NONE)
    assert chosen(now, [before], fit=now) == 1
    assert chosen(now, [before], fit=Known(first=fitted)) == expected


def test_without_a_reference_nothing_is_asked():
    assert chosen(Known(first=WILD), []) == 1

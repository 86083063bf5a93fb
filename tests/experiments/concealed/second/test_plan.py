"""The plan of set 2: counts, and that no property tells of another."""

from collections import Counter

import numpy as np
import pytest

from experiments.concealed.second.plan import (
    KINDS_2,
    RATES_HZ,
    ROBOTS,
    dealt,
    planned,
)
from worlds.hidden.limbs import LIMBS


def counts(plans, name):
    return Counter(getattr(plan, name) for plan in plans)


def test_kinds_come_by_count_and_not_by_chance():
    for seed in (1, 2):
        kinds = counts(planned(seed, 400), "kind")
        assert kinds["none"] >= 80
        assert kinds["outside"] >= 60
        assert kinds == {name: round(400 * share) for name, share in KINDS_2.items()}


def test_robots_rates_gains_drives_and_references_are_as_promised():
    plans = planned(3, 400)
    assert len(counts(plans, "robot")) >= 8
    assert set(ROBOTS) <= {"so101", *LIMBS}
    rates = counts(plans, "rate_hz")
    assert (min(rates), max(rates)) == (30, 1000)
    assert set(rates) == set(RATES_HZ)
    gains = counts(plans, "gains")
    assert gains[1] / gains[2] == pytest.approx(2, abs=0.05)
    assert 40 <= counts(plans, "drive")["torques"] <= 100
    assert counts(plans, "engine") == {"bullet": 200, "mujoco": 200}
    assert 100 <= counts(plans, "reference")[True] <= 150


def test_other_numbers_of_cases_are_dealt_in_proportion():
    for count in (1, 7, 40, 203):
        kinds = counts(planned(5, count), "kind")
        assert sum(kinds.values()) == count
        for name, share in KINDS_2.items():
            assert abs(kinds[name] - share * count) < 1


@pytest.mark.parametrize("count", [1, 10, 33])
def test_keys_are_dealt_by_the_largest_remainders(count):
    shares = {"a": 0.5, "b": 0.31, "c": 0.19}
    found = Counter(dealt(shares, count, np.random.default_rng(0)))
    wanted = {
        1: {"a": 1},
        10: {"a": 5, "b": 3, "c": 2},
        33: {"a": 17, "b": 10, "c": 6},
    }
    assert found == wanted[count]


@pytest.mark.parametrize("name", ["robot", "rate_hz", "drive", "gains", "engine"])
def test_no_property_tells_of_the_kind(name):
    """Chi-squared of the contingency table, over many sets: as by chance."""
    from scipy.stats import chi2_contingency

    chances = []
    for seed in range(40):
        plans = planned(seed, 400)
        rows = Counter((plan.kind, getattr(plan, name)) for plan in plans)
        values = sorted({getattr(plan, name) for plan in plans}, key=str)
        table = [[rows[kind, value] for value in values] for kind in KINDS_2]
        chances.append(chi2_contingency(np.array(table)).pvalue)
    assert np.mean(np.array(chances) < 0.05) < 0.2
    assert np.median(chances) > 0.2


def test_the_seed_decides_the_plan():
    assert planned(1, 50) == planned(1, 50) != planned(2, 50)

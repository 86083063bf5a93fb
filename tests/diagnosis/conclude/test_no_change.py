"""What single recordings of a healthy robot differ by as well is no change of it."""

import numpy as np
import pytest
from differing_gains import GAIN, predictor_of
from scipy.stats import chi2, f, t

from diagnosis.conclude import guards
from diagnosis.conclude import no_change as module
from diagnosis.conclude.guards import established
from diagnosis.conclude.no_change import Told, may_be_no_change, no_change
from diagnosis.effects.parts import PlacedEffect
from diagnosis.residuals.predictor import Predictor
from diagnosis.search.fitting import fit_all
from diagnosis.search.judging import places_of_effects

FRICTION = (PlacedEffect("viscous_friction", "shoulder", (0.05,)),)


def doubted(gains, before, model=GAIN):
    both, healthy = predictor_of(gains), predictor_of(before, first=10, model=())
    (fitted,) = fit_all(both, [model])
    return no_change(both, [healthy], fitted)


@pytest.mark.parametrize(
    ("gains", "before", "expected"),
    [
        ((1.03,) * 3, (1.0,) * 3, False),
        ((1.03, 1.06, 1.0), (1.05, 0.95, 1.0), True),
        ((1.5, 1.51, 1.49), (1.01, 0.99, 1.0), False),
    ],
)
def test_a_change_is_more_than_recordings_differ(gains, before, expected):
    assert (doubted(gains, before) is not None) == expected


def test_without_a_healthy_robot_nothing_is_compared():
    both = predictor_of((1.07, 0.99, 1.01))
    assert no_change(both, [], fit_all(both, [GAIN])[0]) is None


def test_the_guard_keeps_what_has_changed():
    gains, before = (1.5, 1.51, 1.49), (1.0, 0.99, 1.01)
    both, healthy = predictor_of(gains), predictor_of(before, first=10, model=())
    kept, _ = established(both, GAIN + FRICTION, [healthy])
    assert kept is not None
    assert [one.name for one in kept.model] == ["servo_gain"]


def test_the_guard_takes_out_what_recordings_differ_by(monkeypatch):
    """The other guard that compares recordings does not look."""
    monkeypatch.setattr(guards, "scattered", lambda both, healthy, fitted: [])
    both = predictor_of((1.03,) * 3)
    for before, stays in (((1.0,) * 3, True), ((1.05, 0.95, 1.0), False)):
        healthy = predictor_of(before, first=10, model=())
        kept, _ = established(both, GAIN, [healthy])
        assert (kept is not None) == stays


def test_of_two_that_only_together_are_no_change_one_is_doubted(monkeypatch):
    """Each alone gains enough beside the other, both together do not."""
    both, healthy = predictor_of((1.03,) * 3), predictor_of((1.0,) * 3, 10, ())
    (fitted,) = fit_all(both, [GAIN + FRICTION])
    asked = []

    def of(both, healthy, fitted, group):
        asked.append(len(group))
        if len(group) == 2:
            return gains(1000.0, 500.0, 2)
        return gains(900.0 if group[0].name == GAIN[0].name else 800.0, 5.0, 2)

    monkeypatch.setattr(module, "_told", of)
    found = no_change(both, [healthy], fitted)
    assert asked == [1, 1, 2]
    assert found is not None
    assert found[0].name == "viscous_friction"


@pytest.mark.parametrize("known", [False, True])
def test_where_it_is_noise_how_joints_differ_effects_count_singly(monkeypatch, known):
    both, healthy = predictor_of((1.03,) * 3), predictor_of((1.0,) * 3, 10, ())
    (fitted,) = fit_all(both, [GAIN])
    counts = []
    monkeypatch.setattr(Predictor, "knows_healthy_torques", known)
    monkeypatch.setattr(
        module, "may_be_no_change", lambda told, count: bool(counts.append(count))
    )
    no_change(both, [healthy], fitted)
    assert counts == [1 if known else places_of_effects(both)]


def gains(shared, single, values=2, diagnosed=3, healthy=3):
    """What six recordings tell of two values: only gains are compared."""
    count = diagnosed + healthy
    every = np.full(count, single / count)
    side = np.repeat([False, True], [diagnosed, healthy])
    return Told(values, shared, every, np.zeros(count), np.ones(count), side)


def sizes(diagnosed, healthy, error=1.0):
    """What recordings tell of one value, with equal errors."""
    own = np.array([*diagnosed, *healthy], float)
    side = np.repeat([False, True], [len(diagnosed), len(healthy)])
    weights = np.full(len(own), error**-2.0)
    return Told(1, 0.0, np.zeros(len(own)), own, weights, side)


def test_gains_are_compared_by_an_analysis_of_variance():
    """Four degrees of freedom; of three recordings each half of the gain counts."""
    single = 100.0
    least = f.isf(0.05, 2, 4) * single / 4 * 2
    assert may_be_no_change(gains(0.99 * least, single), 1)
    assert not may_be_no_change(gains(1.01 * least, single), 1)


def test_the_best_of_many_must_gain_more():
    single = 100.0
    least = f.isf(0.05 / 20, 2, 4) * single / 4 * 2
    assert may_be_no_change(gains(0.99 * least, single), 20)
    assert not may_be_no_change(gains(1.01 * least, single), 20)


def test_gains_that_noise_alone_gives_doubt_nothing():
    """Twice the gain has the distribution of the squares that are fitted."""
    most = chi2.isf(0.05, 2 * 4) / 2
    assert not may_be_no_change(gains(0.01, 0.99 * most), 1)
    assert may_be_no_change(gains(0.01, 1.01 * most), 1)


def test_of_one_value_means_are_compared():
    """A t test with four degrees of freedom where recordings differ far more than
    by noise."""
    apart = np.array([-1.0, 0.0, 1.0])
    edge = t.isf(0.025, 4) * np.sqrt(2 / 3)
    for times, doubt in ((0.99, True), (1.01, False)):
        told = sizes(5 + times * edge + apart, 5 + apart, error=1e-3)
        assert may_be_no_change(told, 1) == doubt
    strict = t.isf(0.025 / 20, 4) * np.sqrt(2 / 3)
    assert may_be_no_change(sizes(0.99 * strict + apart, apart, 1e-3), 20)


def test_recordings_that_agree_to_their_errors_doubt_nothing():
    """Sums of squares of two groups around their means."""
    most = np.sqrt(chi2.isf(0.05, 4) / 4)
    for times, doubt in ((0.99, False), (1.01, True)):
        apart = times * most * np.array([-1.0, 0.0, 1.0])
        assert may_be_no_change(sizes(apart, apart), 1) == doubt


def test_a_recording_that_tells_nothing_does_not_count():
    told = sizes([5.0, 5.4, 900.0], [0.0, 0.3], error=0.1)
    assert may_be_no_change(told, 1)
    hardly = told.weights * [1, 1, 1e-4, 1, 1]
    assert not may_be_no_change(told._replace(weights=hardly), 1)


def test_two_recordings_tell_nothing_of_differences():
    assert not may_be_no_change(gains(0.01, 1e6, diagnosed=1, healthy=1), 1)
    assert not may_be_no_change(sizes([5.0], [4.9], error=1e-3), 1)


@pytest.mark.parametrize(("between", "most"), [(0.0, 0.06), (1.0, 0.12), (30.0, 0.06)])
def test_three_of_each_find_no_change_as_rarely_as_the_level_says(between, most):
    """Values that differ by noise, by twice its variance, and by much more.

    Differences as large as the noise are not always seen: twice as often then.
    """
    random, wrong, count = np.random.default_rng(5), 0, 3000
    for _ in range(count):
        own = random.normal(0, between, 6) + random.normal(0, 1, 6)
        told = sizes(own[:3], own[3:])
        is_far = abs(own[:3].mean() - own[3:].mean()) > 1.96 * np.sqrt(2 / 3)
        wrong += is_far and not may_be_no_change(told, 1)
    assert wrong / count < most


@pytest.mark.slow
@pytest.mark.parametrize("factor", [0.5, 2.0])
@pytest.mark.parametrize("name", ["LEVEL", "LEAST_SHARE"])
def test_half_or_twice_a_constant_decides_the_same(monkeypatch, name, factor):
    monkeypatch.setattr(module, name, factor * getattr(module, name))
    assert doubted((1.03,) * 3, (1.0,) * 3) is None
    assert doubted((1.03, 1.06, 1.0), (1.05, 0.95, 1.0)) is not None
    assert doubted((1.5, 1.51, 1.49), (1.01, 0.99, 1.0)) is None

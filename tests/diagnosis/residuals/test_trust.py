"""Weights of recordings in which models leave more than in most."""

from dataclasses import replace

import numpy as np
import pytest
from known_arms import CHANNELS, measured
from made_up_traces import arm

from diagnosis.effects.parts import PlacedEffect
from diagnosis.residuals.predictor import Predictor
from diagnosis.residuals.trust import trust_of
from diagnosis.search.judging import Judge
from diagnosis.search.many.fits import Fits

GUESS = tuple(
    PlacedEffect("coulomb_friction", joint, (0.1,)) for joint in ("shoulder", "elbow")
)


def squares(**rms):
    """Sums of squares of 50 entries in each of two channels, and their number."""
    return {
        name: np.stack([50 * np.array(own) ** 2, np.full(2, 50.0)])
        for name, own in rms.items()
    }


def test_what_leaves_more_than_the_median_weighs_less():
    found = trust_of([squares(a=(2.0, 3.0), b=(4.0, 3.0), c=(20.0, 1.5))])
    assert {name: own.tolist() for name, own in found.items()} == {
        "a": [1.0, 1.0],
        "b": [1.0, 1.0],
        "c": [pytest.approx(0.2), 1.0],
    }


def test_parts_of_a_recording_count_together():
    parts = squares(a=(2.0, 2.0), b=(2.0, 2.0), c=(2.0, 2.0)), squares(c=(10.0, 2.0))
    both = np.sqrt((50 * 4 + 50 * 100) / 100)
    assert trust_of(parts)["c"].tolist() == [pytest.approx(2 / both), 1.0]


def test_noise_is_no_reason_to_weigh():
    found = trust_of([squares(a=(0.5, 0.5), b=(0.9, 0.9), c=(1.0, 1.0))])
    assert all((own == 1).all() for own in found.values())


def test_two_recordings_tell_no_median():
    assert trust_of([squares(a=(2.0, 2.0), b=(90.0, 90.0))]) == {}


@pytest.fixture(scope="module")
def traces():
    """Four recordings of an arm that rubs; in the last one its servos are also weak."""

    def friction_nm(t, q, v):
        return -0.5 * np.tanh(v / 0.01)

    weak = {3: (0.4, 0.4)}
    made = [measured(k, friction_nm, gain=weak.get(k, (1.0, 1.0))) for k in range(4)]
    return [replace(one, name=str(k)) for k, one in enumerate(made)]


def test_weights_are_those_of_recordings_until_they_are_taken_away(traces):
    plain, weighed = (Predictor(arm(), traces, CHANNELS) for _ in range(2))
    weighed.trusting({"2": np.array([0.5, 0.25])})
    (before,), (after,) = plain.residuals([()]), weighed.residuals([()])
    expected = np.where(plain.trace == 2, np.array([0.5, 0.25])[plain.channel], 1.0)
    np.testing.assert_allclose(after, before * expected)
    second = weighed.part(2, 3).residuals([()])[0]
    np.testing.assert_allclose(second, after[plain.trace == 2])
    np.testing.assert_allclose(weighed.stepped(0.004).residuals([()])[0], after)
    np.testing.assert_allclose(weighed.evenly().residuals([()])[0], before)
    for name, own in weighed.squares_in(()).items():
        np.testing.assert_allclose(own, plain.squares_in(())[name])
    weighed.trusting({})
    np.testing.assert_allclose(weighed.residuals([()])[0], before)


def errors_of(traces, weighs):
    """Relative errors of friction that is fitted to all recordings but the third."""
    fit = Predictor(arm(), [*traces[:2], traces[3]], CHANNELS)
    select = Predictor(arm(), traces[2:3], CHANNELS)
    for part in (fit, select):
        part.calibrate()
    fits = Fits(Judge(fit, select), weighs=weighs)
    best = fits.exact(fits.fitted(GUESS))
    return [abs(one.values[0] / 0.5 - 1) for one in best.model]


@pytest.mark.slow
def test_one_odd_recording_does_not_decide_values(traces):
    assert max(errors_of(traces, weighs=False)) > 0.5
    assert max(errors_of(traces, weighs=True)) < 0.15

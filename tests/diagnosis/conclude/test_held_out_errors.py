from types import SimpleNamespace

import numpy as np
import pytest

from diagnosis.conclude.held_out_errors import (
    channel_rms,
    larger_than_learned,
    model_refuted,
)
from diagnosis.verdict import ChannelFit, Fit

CHANNELS = SimpleNamespace(names=("position.a", "position.b"))
LEARNED = SimpleNamespace(
    channels=CHANNELS,
    channel=np.array([0, 0, 0, 1, 1]),
    scored=np.array([True, True, False, True, True]),
)


def fit_of(a, b):
    """Errors on the test data, in units of noise; the noise of b is 0.1."""
    channels = {
        "position.a": ChannelFit(unit="rad", nominal=50.0, floor=1.0, corrected=a),
        "position.b": ChannelFit(unit="rad", nominal=5.0, floor=0.1, corrected=0.1 * b),
    }
    together = float(np.sqrt((a**2 + b**2) / 2))
    return Fit(nominal=50.0, floor=1.0, corrected=together, channels=channels)


def test_rms_is_of_the_rows_that_are_scored():
    found = channel_rms(LEARNED, np.array([3.0, 4.0, 0.0, 1.0, 1.0]))
    assert found == pytest.approx([np.sqrt(12.5), 1.0])


def test_a_test_that_is_much_worse_is_told_with_its_worst_channel():
    left = np.array([1.0, 1.0, 0.0, 1.0, 1.0])
    (said,) = larger_than_learned(LEARNED, left, fit_of(1.0, 20.0))
    assert "14 instead of 1 times" in said
    assert "position.b" in said


@pytest.mark.parametrize(("left", "test"), [(1.0, 1.5), (15.0, 20.0), (0.1, 1.0)])
def test_a_test_as_good_as_what_was_learned_from_is_none(left, test):
    residual = left * np.array([1.0, 1.0, 0.0, 1.0, 1.0])
    assert larger_than_learned(LEARNED, residual, fit_of(test, test)) == ()


def test_a_model_that_makes_the_test_worse_is_refuted():
    """Half the squared residuals are nats: 40 are lost, or none, or hardly any."""
    plain, worse = np.full(100, 1.0), np.full(100, np.sqrt(1.8))
    (said,) = model_refuted(plain, worse, 15.0)
    assert "worse" in said
    assert model_refuted(plain, worse, 45.0) == ()
    assert model_refuted(worse, plain, 15.0) == ()
    assert model_refuted(plain, plain, 15.0) == ()

from types import SimpleNamespace

import numpy as np
import pytest

from diagnosis.conclude.held_out_errors import (
    channel_rms,
    larger_than_learned,
    model_refuted,
    rms_above_floor,
)
from diagnosis.residuals.channels import Channels

CHANNELS = Channels(("position.a", "position.b"), np.array([1.0, 0.1]))
LEARNED = SimpleNamespace(
    channels=CHANNELS,
    channel=np.array([0, 0, 0, 1, 1]),
    scored=np.array([True, True, False, True, True]),
)


def test_rms_is_of_the_rows_that_are_scored():
    found = channel_rms(LEARNED, np.array([3.0, 4.0, 0.0, 1.0, 1.0]))
    assert found == pytest.approx([np.sqrt(12.5), 1.0])


def leaving(a, b):
    """A predictor and a residual of rms a and b in its channels."""
    return LEARNED, np.array([a, a, 0.0, b, b])


def test_a_test_that_is_much_worse_is_told_with_its_worst_channel():
    (said,) = larger_than_learned(leaving(1.0, 1.0), leaving(1.0, 20.0))
    assert "20 instead of 1 times" in said
    assert "position.b" in said


@pytest.mark.parametrize(("left", "test"), [(1.0, 1.5), (15.0, 20.0), (0.1, 1.0)])
def test_a_test_as_good_as_what_was_learned_from_is_none(left, test):
    assert larger_than_learned(leaving(left, left), leaving(test, test)) == ()


def test_where_more_than_noise_is_left_errors_are_still_told_by_the_noise():
    wide = CHANNELS.widened(np.array([3.0, 3.0]))
    predictor = SimpleNamespace(**{**vars(LEARNED), "channels": wide})
    residual = np.array([1.0, 1.0, 0.0, 1.0, 1.0])
    assert rms_above_floor(LEARNED, residual) == pytest.approx(1.0)
    assert rms_above_floor(predictor, residual) == pytest.approx(3.0)


def test_a_model_that_makes_the_test_worse_is_refuted():
    """Half the squared residuals are nats: 40 are lost, or none, or hardly any."""
    plain, worse = np.full(100, 1.0), np.full(100, np.sqrt(1.8))
    (said,) = model_refuted(plain, worse, 15.0)
    assert "worse" in said
    assert model_refuted(plain, worse, 45.0) == ()
    assert model_refuted(worse, plain, 15.0) == ()
    assert model_refuted(plain, plain, 15.0) == ()

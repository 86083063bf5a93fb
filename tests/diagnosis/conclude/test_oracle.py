import numpy as np
import pytest

from diagnosis.conclude.oracle import log_score_gain


def test_gain_is_the_difference_of_log_likelihoods_at_the_noise_that_is_left():
    channel = np.tile([0, 1], 100)
    nominal, fitted = np.full(200, 3.0), np.full(200, 1.0)
    assert log_score_gain(nominal, fitted, channel) == pytest.approx(200 * (9 - 1) / 2)
    fitted[1::2] = 2.0  # what is left counts as noise
    expected = 100 * (9 - 1) / 2 + 100 * (9 - 4) / 2 / 4
    assert log_score_gain(nominal, fitted, channel) == pytest.approx(expected)
    nominal[:100], fitted[:100] = 0, 0  # not scored
    assert log_score_gain(nominal, fitted, channel) == pytest.approx(expected / 2)
    assert log_score_gain(fitted, fitted, channel) == 0

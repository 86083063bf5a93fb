import numpy as np
import pytest

from diagnosis.conclude.held_out_series import (
    ChannelSeries,
    HeldOutSeries,
    by_error,
    rms,
)
from diagnosis.verdict import ChannelFit, Fit


def channels(**errors):
    flat = np.zeros(5)
    return {
        name: ChannelSeries(flat, flat + error, flat) for name, error in errors.items()
    }


def test_the_worst_channel_is_that_of_most_noise_floors():
    series = HeldOutSeries("a", np.arange(5.0), channels(a=0.5, b=-0.1, c=9.0))
    floors = {"a": 0.1, "b": 0.001}
    fits = {
        name: ChannelFit(nominal=1.0, corrected=1.0, floor=floor, unit="rad")
        for name, floor in floors.items()
    }
    fit = Fit(nominal=1.0, corrected=1.0, floor=1.0, channels=fits)
    assert by_error(series, fit) == ["b", "a"]
    assert by_error(series, None) == ["c", "a", "b"]


def test_rms_leaves_out_what_is_missing():
    assert rms(np.array([3.0, np.nan, -4.0])) == pytest.approx(np.sqrt(12.5))
    assert rms(np.array([np.nan])) == 0.0

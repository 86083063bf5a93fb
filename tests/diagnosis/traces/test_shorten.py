import numpy as np
import pytest

from diagnosis.plant.servo import Servo
from diagnosis.traces.split import shortened
from diagnosis.traces.trace import Trace


def trace(name, lively_from_s, duration_s=20.0):
    """Still, but for a fast sine of 5 s."""
    time_s = np.arange(0, duration_s, 0.01)
    lively = (time_s >= lively_from_s) & (time_s < lively_from_s + 5)
    position = np.where(lively, np.sin(10 * time_s), 0.0)
    return Trace(name, time_s, position[:, None], Servo.ideal(1))


def test_short_recordings_stay_whole():
    traces = [trace("a", 3.0), trace("b", 9.0)]
    assert shortened(traces, 40.0) == traces


def test_of_long_ones_the_liveliest_part_is_kept():
    parts = shortened([trace("a", 3.0), trace("b", 12.0)], 10.0)
    assert [part.duration_s for part in parts] == pytest.approx([5.0, 5.0], abs=0.02)
    assert [part.time_s[0] for part in parts] == pytest.approx([3.0, 12.0], abs=0.2)


def test_missing_values_do_not_count_as_motion():
    whole = trace("a", 3.0)
    position = whole.position_rad.copy()
    position[::2][800:] = np.nan
    holes = Trace("a", whole.time_s, position, whole.servo)
    (part,) = shortened([holes], 5.0)
    assert part.time_s[0] == pytest.approx(3.0, abs=0.2)


def test_even_the_smallest_part_is_long_enough_to_learn_from():
    parts = shortened([trace(str(i), 3.0) for i in range(10)], 10.0)
    assert min(part.duration_s for part in parts) >= 2.99

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from joint_rigs import ARM, plant_of

from diagnosis.plant.servo import Servo
from diagnosis.traces.split import MOST_COMPARED, split, thinned
from diagnosis.traces.trace import Trace
from groundwalk.errors import BadRecordingError

HZ = 100


def trace(name, seconds, moving=(1.0, 1.0)):
    """Two joints that swing as far as `moving` says; unique times tell rows apart."""
    time_s = np.arange(int(seconds * HZ)) / HZ
    swing = np.sin(2 * np.pi * 0.5 * time_s)
    return Trace(name, time_s, swing[:, None] * np.array(moving), Servo.ideal(2))


def seconds(part):
    return sum(trace.duration_s for trace in part)


def names(part):
    return sorted(trace.name for trace in part)


def test_whole_recordings_by_time():
    traces = [trace(f"t{k}", 10) for k in range(8)]
    result = split(traces)
    used = [*result.fit, *result.select, *result.test]
    assert names(used) == names(traces)
    assert (len(result.fit), len(result.select), len(result.test)) == (4, 2, 2)


def test_many_recordings():
    traces = [trace(f"t{k}", 5 + k % 3) for k in range(30)]
    result = split(traces)
    whole = seconds(traces)
    assert names([*result.fit, *result.select, *result.test]) == names(traces)
    assert seconds(result.test) == pytest.approx(0.25 * whole, rel=0.15)
    assert seconds(result.select) == pytest.approx(0.25 * whole, rel=0.15)


def test_the_only_motion_of_a_joint_is_fitted():
    # lengths would have `alone` set aside: it is a quarter of the time
    traces = [
        trace("alone", 10, (1.0, 1.0)),
        trace("x", 15, (1.0, 0.0)),
        trace("y", 9, (1.0, 0.0)),
        trace("z", 6, (1.0, 0.0)),
    ]
    result = split(traces)
    assert "alone" in names(result.fit)
    both = [trace(one.name, one.duration_s + 0.01) for one in traces]
    assert names(split(both).test) == ["alone"]


def test_where_each_moves_its_own_joint_all_are_cut():
    traces = [
        trace("a", 10, (1.0, 0.0)),
        trace("b", 10, (0.0, 1.0)),
        trace("c", 10, (0.0, 0.0)),
    ]
    # only c could be set aside, but then nothing is left to select with
    result = split(traces)
    for part in (result.fit, result.select, result.test):
        assert {one.name[0] for one in part} == {"a", "b", "c"}


def test_parts_of_one_recording_do_not_touch():
    whole = trace("one", 30)
    result = split([whole])
    parts = [*result.fit, *result.select, *result.test]
    parts.sort(key=lambda part: part.time_s[0])
    for before, after in pairwise(parts):
        assert after.time_s[0] - before.time_s[-1] >= 0.2
        assert after.time_s[0] - before.time_s[-1] < 0.25
    assert parts[0].time_s[0] == whole.time_s[0]
    assert parts[-1].time_s[-1] == whole.time_s[-1]
    assert seconds(result.fit) == pytest.approx(2 * seconds(result.test), rel=0.02)
    assert seconds(result.select) == pytest.approx(seconds(result.test), rel=0.02)


def test_what_happens_at_one_time_is_fitted_and_judged():
    """A push that comes in every recording, or what a drift has come to."""
    result = split([trace(f"t{k}", 10) for k in range(4)])
    for moment_s in (1.0, 4.0, 6.0, 9.0):
        uses = [
            sum(one.time_s[0] < moment_s < one.time_s[-1] for one in part)
            for part in (result.fit, result.select, result.test)
        ]
        assert uses == [2, 1, 1]


def test_parts_are_ordered_for_their_motion():
    """The second joint moves in the last half alone; fit must have some of it."""
    whole = trace("one", 12)
    position = whole.position_rad.copy()
    position[: len(position) // 2, 1] = 0
    late = Trace("late", whole.time_s, position, whole.servo)
    result = split([late])
    assert max(np.ptp(part.position_rad[:, 1]) for part in result.fit) > 1


def test_splits_are_always_alike():
    traces = [trace(f"t{k}", 5 + k) for k in range(5)]
    first, second = split(traces), split(traces)
    assert names(first.test) == names(second.test)
    assert names(first.select) == names(second.select)


def test_missing_values_do_not_matter():
    holed = trace("one", 20)
    holed.position_rad[::3] = np.nan
    assert len(split([holed]).test) == len(split([trace("one", 20)]).test)


def test_too_short_to_be_cut():
    with pytest.raises(BadRecordingError, match="too short"):
        split([trace("short", 0.9)])


def test_both_ways_of_a_motion_that_repeats_itself_are_fitted():
    time_s = np.arange(24 * HZ) / HZ
    # three seconds forward, three back: as long as two of the eight parts
    position = np.abs((time_s + 3) % 6 - 3)[:, None]
    result = split([Trace("there and back", time_s, position, Servo.ideal(1))])
    for parts in (result.fit, result.select, result.test):
        ways = [np.sign(np.diff(part.position_rad[:, 0])) for part in parts]
        forward = np.mean(np.concatenate(ways) > 0)
        assert 0.3 < forward < 0.7


@pytest.mark.parametrize(
    ("every", "duration_s", "cut"),
    [
        ("abc", 7.0, False),
        ("abc", 9.0, True),
        ("abcde", 7.0, False),
        ("abcde", 9.0, True),
        ("abcdef", 9.0, False),
    ],
)
def test_a_few_recordings_are_cut_if_they_are_long(every, duration_s, cut):
    result = split([trace(name, duration_s) for name in every])
    parts = (result.fit, result.select, result.test)
    names_of = [{one.name[0] for one in part} for part in parts]
    assert all(names == set(every) for names in names_of) is cut
    if not cut:
        assert sum(len(names) for names in names_of) == len(every)


def held(seconds):
    """A recording of two joints that servos hold."""
    servo = Servo(*(np.full(2, value) for value in (10.0, 1.0, 5.0, 0.0)))
    some = trace("held", seconds)
    return replace(some, servo=servo, command_rad=some.position_rad)


def test_of_very_many_values_fewer_rows_are_compared():
    arm, traces = plant_of(ARM, kp=10.0, kd=1.0), [held(40), held(60)]
    enough = 2 * MOST_COMPARED // (100 * HZ)
    assert [one.every for one in thinned(arm, traces, enough // 2)] == [1, 1]
    fewer = thinned(arm, traces, enough + 1)
    assert [one.every for one in fewer] == [3, 3]
    assert sum(one.rows for one in fewer) * (enough + 1) <= MOST_COMPARED
    assert [one.ticks for one in fewer] == [one.ticks for one in traces]
    np.testing.assert_array_equal(
        fewer[0].time_s[fewer[0].compared], fewer[0].time_s[::3]
    )
    assert fewer[0].part(7, 100).rows == 31


def test_of_short_windows_all_rows_are_compared():
    arm = plant_of(ARM, kp=10.0, kd=1.0)
    driven = trace("driven", 60)
    assert [one.every for one in thinned(arm, [driven], 10**6)] == [1]

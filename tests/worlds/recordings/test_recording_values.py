import numpy as np
import pytest

from groundwalk.errors import BadRecordingError
from worlds.recordings.recording import check_values, frozen_columns

NAN = float("nan")


def columns(**changed):
    values = {"time": [0.0, 0.5, 2.0], "position.knee": [1.0, NAN, 3.0]}
    return frozen_columns(values | changed)


def refusal(values):
    with pytest.raises(BadRecordingError) as caught:
        check_values(frozen_columns(values))
    return str(caught.value)


def orientation(*rows):
    quaternions = zip(*rows, strict=True)
    names = [f"base.orientation.{part}" for part in "wxyz"]
    return dict(zip(names, map(list, quaternions), strict=True))


def test_uneven_times_and_missing_values_are_right():
    check_values(columns())


@pytest.mark.parametrize("time", [[0.0, 0.5, 0.5], [0.0, 0.5, 0.4]])
def test_times_must_increase(time):
    assert refusal({"time": time}) == (
        f"column 'time', row 2 (counted from 0): {time[2]} s is not later than the "
        "row before"
    )


def test_the_first_bad_row_is_the_one_named():
    assert "row 1 " in refusal({"time": [5.0, 4.0, 3.0, 2.0]})


def test_far_apart_times_are_no_overflow():
    check_values(frozen_columns({"time": [-1.7e308, 1.7e308]}))


def test_a_time_must_not_be_missing():
    message = refusal({"time": [0.0, NAN, 1.0]})
    assert message == "column 'time', row 1 (counted from 0): a time is missing"


@pytest.mark.parametrize("infinite", [np.inf, -np.inf])
@pytest.mark.parametrize("name", ["time", "position.knee"])
def test_infinite_values_are_refused(name, infinite):
    values = {"time": [0.0, 1.0, 2.0], "position.knee": [1.0, NAN, 3.0]}
    values[name][2] = infinite
    message = refusal(values)
    assert message.startswith(f"column '{name}', row 2 ")
    assert f"{infinite} is not finite" in message


def test_no_rows_are_refused():
    assert refusal({"time": [], "position.knee": []}) == "no rows"


def test_one_row_is_enough():
    check_values(frozen_columns({"time": [3.0]}))


def test_unit_quaternions_pass():
    half = np.sqrt(0.5)
    rows = [(1, 0, 0, 0), (half, 0, -half, 0), (0.577, 0.577, 0.578, 0.0)]
    check_values(columns(**orientation(*rows)))


def test_quaternions_with_missing_parts_pass():
    rows = [(1, 0, 0, 0), (NAN, NAN, NAN, NAN), (NAN, 0, 0, 0)]
    check_values(columns(**orientation(*rows)))


@pytest.mark.parametrize(
    ("wrong", "norm"),
    [((0, 0, 0, 0), "0.0"), ((0, 3, 0, 4), "5.0"), ((1e200, 0, 0, 0), "inf")],
)
def test_other_quaternions_are_refused(wrong, norm):
    rows = [(1, 0, 0, 0), wrong, (1, 0, 0, 0)]
    message = refusal(columns(**orientation(*rows)))
    assert message.startswith("column 'base.orientation.w', row 1 ")
    assert f"norm {norm}, not 1" in message


@pytest.mark.parametrize(("norm", "right"), [(1.0009, True), (0.9989, False)])
def test_quaternions_may_be_off_by_a_thousandth(norm, right):
    values = {"time": [0.0], **orientation((0, 0, norm, 0))}
    if right:
        check_values(frozen_columns(values))
    else:
        assert "not 1" in refusal(values)


def test_support_is_a_leg_or_both_or_missing():
    check_values(columns(support=[-1, 0, 1]))
    check_values(columns(support=[1, NAN, -1]))
    message = refusal(columns(support=[0, 1, 0.5]))
    assert (
        message == "column 'support', row 2 (counted from 0): 0.5 is none of -1, 0, 1"
    )


@pytest.mark.parametrize("wrong", [["a", "b", "c"], [True, False, True], [1j, 0, 0]])
def test_a_column_of_something_else_is_refused(wrong):
    with pytest.raises(BadRecordingError, match=r"'support' holds .*, not numbers"):
        columns(support=wrong)


def test_a_column_of_another_length_is_refused():
    with pytest.raises(
        BadRecordingError, match="'support' has 2 rows, column 'time' has 3"
    ):
        columns(support=[0, 1])


def test_a_column_has_one_value_a_row():
    with pytest.raises(BadRecordingError, match=r"'support' has the shape \(3, 1\)"):
        columns(support=np.zeros((3, 1)))


def test_integers_become_floats():
    frozen = columns(support=np.array([-1, 0, 1], dtype=np.int8))
    assert frozen["support"].dtype == np.float64


def test_changing_the_given_array_changes_nothing():
    given = np.array([0.0, 1.0, 2.0])
    frozen = columns(time=given)
    given[0] = 7.0
    assert frozen["time"][0] == 0.0
    with pytest.raises(ValueError, match="read-only"):
        frozen["time"][0] = 7.0


def test_a_read_only_array_is_not_copied():
    given = np.array([0.0, 1.0, 2.0])
    given.flags.writeable = False
    assert columns(time=given)["time"] is given

import pytest

from groundwalk.errors import BadRecordingError
from worlds.recordings.recording import check_names, joints_with

LEAST = ["time", "position.knee", "command.knee"]
XYZ = ("x", "y", "z")
SENSORS = ("front_left", "front_right", "rear_left", "rear_right")


def refusal(names):
    with pytest.raises(BadRecordingError) as caught:
        check_names(names)
    return str(caught.value)


@pytest.mark.parametrize("drive", ["command", "command_torque", "torque"])
def test_time_position_and_one_drive_are_enough(drive):
    check_names(["time", "position.knee", f"{drive}.knee"])


@pytest.mark.parametrize(
    "vector",
    [
        *(
            [f"{name}.{c}" for c in XYZ]
            for name in (
                "base.position",
                "base.linear_velocity",
                "base.angular_velocity",
                "gyroscope",
                "accelerometer",
            )
        ),
        [f"base.orientation.{c}" for c in "wxyz"],
        ["foot_force.left", "foot_force.right"],
        [f"foot_force.left.{c}" for c in SENSORS],
        [f"foot_force.right.{c}" for c in SENSORS],
    ],
    ids=lambda vector: vector[0],
)
def test_a_vector_may_be_there_whole_but_not_in_part(vector):
    check_names(LEAST + vector)
    for missing in vector:
        rest = [name for name in vector if name != missing]
        assert f"column '{missing}' is missing" in refusal(LEAST + rest)


@pytest.mark.parametrize("name", ["support", "velocity.knee", "torque.knee"])
def test_optional_columns_are_known(name):
    check_names([*LEAST, name])


def test_a_joint_may_have_dots_and_spaces_in_its_name():
    check_names(["time", "position.left leg.knee", "command.left leg.knee"])


@pytest.mark.parametrize(
    ("wrong", "right"),
    [
        ("positon.knee", "position.knee"),
        ("Velocity.knee", "velocity.knee"),
        ("gyro.x", "gyroscope.x"),
        ("base.orientaton.w", "base.orientation.w"),
        (" time", "time"),
    ],
)
def test_an_unknown_column_is_named_with_the_nearest_known_one(wrong, right):
    message = refusal([*LEAST, wrong])
    assert f"unknown column '{wrong}'" in message
    assert f"did you mean '{right}'?" in message


@pytest.mark.parametrize("wrong", ["", "q", "position.", "position.a\nb", "zzz.knee"])
def test_names_that_mean_nothing_are_refused(wrong):
    assert f"unknown column {wrong!r}" in refusal([*LEAST, wrong])


def test_without_a_near_name_the_message_lists_what_there_is():
    message = refusal([*LEAST, "zzzzzz"])
    for known in ("time", "support", "base.orientation", "command_torque"):
        assert known in message


def test_a_column_twice_is_refused():
    message = refusal([*LEAST, "position.knee"])
    assert message == "column 'position.knee' is there 2 times"


def test_time_is_required():
    assert refusal(LEAST[1:]) == "no column 'time'"


def test_a_position_is_required():
    assert refusal(["time", "command.knee"]) == "no column 'position.<joint>'"


def test_something_that_drives_is_required():
    message = refusal(["time", "position.knee", "velocity.knee"])
    assert "command.<joint>, command_torque.<joint>, torque.<joint>" in message


@pytest.mark.parametrize(
    "quantity", ["velocity", "command", "command_torque", "torque"]
)
def test_a_joint_without_position_is_refused(quantity):
    message = refusal([*LEAST, f"{quantity}.kne"])
    assert f"column '{quantity}.kne' has no 'position.kne'" in message
    assert "did you mean 'knee'?" in message


def test_joints_come_in_the_order_of_their_columns():
    names = ["command.b", "time", "position.b", "position.a", "command.a"]
    assert joints_with("position", names) == ("b", "a")
    assert joints_with("torque", names) == ()
    # "command_torque.b" is no command of a joint "torque.b" or the like.
    assert joints_with("command", [*names, "command_torque.b"]) == ("b", "a")

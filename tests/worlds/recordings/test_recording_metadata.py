import json
from dataclasses import replace

import numpy as np
import pytest

from groundwalk.errors import BadRecordingError
from worlds.recordings.load import Load
from worlds.recordings.metadata import RecordingMetadata, ServoGains

LEAST = {"format": 1, "robot": "nao", "base": "floating", "source": "a test"}
FULL = LEAST | {
    "servo": {"knee": {"kp": 20.0, "kd": 1.5, "max_torque": 9.0}},
    "loads": {"shin": {"mass": 1.5, "at": [0.0, 0.1, -0.2]}},
    "terrain": {"name": "lumps", "parameters": {"amplitude_m": 0.01}, "seed": 2**70},
    "gait": {"step_height_m": 0.02},
    "world": "sim",
    "end": "fall",
}


def read(document):
    return RecordingMetadata.from_json(json.dumps(document))


def refusal(document):
    with pytest.raises(BadRecordingError) as caught:
        read(document)
    return str(caught.value)


def test_the_least_there_can_be():
    metadata = read(LEAST)
    assert metadata == RecordingMetadata("nao", "floating", "a test")
    assert metadata.servo == {} == metadata.loads
    assert "loads" not in json.loads(metadata.to_json())
    assert metadata.terrain is None


def test_all_there_can_be():
    metadata = read(FULL)
    assert metadata.servo == {"knee": ServoGains(20.0, 1.5, 9.0)}
    assert metadata.loads == {"shin": Load(1.5, (0.0, 0.1, -0.2))}
    assert metadata.terrain == FULL["terrain"]
    assert metadata.gait == {"step_height_m": 0.02}
    assert (metadata.world, metadata.end) == ("sim", "fall")


MOTOR = {"kp": 20.0, "kd": 0.0, "max_torque": 9.0, "back_emf": 0.6, "armature": 0.03}
KNOWN_MOTOR = LEAST | {"servo": {"knee": MOTOR}}


def test_a_servo_may_state_its_motor():
    (servo,) = read(KNOWN_MOTOR).servo.values()
    assert (servo.back_emf, servo.armature) == (0.6, 0.03)
    wrong = LEAST | {"servo": {"knee": MOTOR | {"armature": -1.0}}}
    assert "armature must be a number from 0 up" in refusal(wrong)


@pytest.mark.parametrize("document", [LEAST, FULL, KNOWN_MOTOR])
def test_what_is_written_is_what_was_read(document):
    assert json.loads(read(document).to_json()) == document


def test_an_empty_gait_is_not_a_missing_one():
    assert read(LEAST | {"gait": {}}).gait == {}
    assert json.loads(read(LEAST | {"gait": {}}).to_json())["gait"] == {}


def test_null_means_left_out():
    assert read(LEAST | {"servo": None, "terrain": None, "end": None}) == read(LEAST)
    assert refusal(LEAST | {"robot": None}) == "metadata has no 'robot'"


def test_the_order_of_keys_does_not_change_the_text():
    turned = dict(reversed(FULL.items()))
    turned["gait"] = {"b": 1, "a": 2}
    other = FULL | {"gait": {"a": 2, "b": 1}}
    assert read(turned).to_json() == read(other).to_json()


def test_whole_numbers_of_gains_are_floats():
    assert replace(read(LEAST), servo={"knee": ServoGains(1, 2, 3)}) == replace(
        read(LEAST), servo={"knee": ServoGains(1.0, 2.0, 3.0)}
    )
    assert repr(ServoGains(np.int64(1), 0, 3).kp) == "1.0"


@pytest.mark.parametrize(
    "text",
    [
        "",
        "{",
        b"\xff\xfe\xfd",
        '{"format": NaN}',
        '{"format": Infinity}',
        "[" * 100_000,
    ],
)
def test_what_is_no_json_is_refused(text):
    with pytest.raises(BadRecordingError, match="metadata is not JSON"):
        RecordingMetadata.from_json(text)


def test_another_thing_than_an_object_is_refused():
    assert "must be a JSON object, not [1]" in refusal([1])


@pytest.mark.parametrize("version", [2, "1", True, None, 1.5])
def test_another_format_is_refused(version):
    message = refusal(LEAST | {"format": version})
    assert message == f"metadata 'format' is {version!r}; only 1 is known"


@pytest.mark.parametrize("key", ["format", "robot", "base", "source"])
def test_required_keys(key):
    document = {name: value for name, value in LEAST.items() if name != key}
    assert f"metadata has no '{key}'" in refusal(document)


def test_an_unknown_key_is_named_with_the_nearest_one():
    message = refusal(LEAST | {"servos": {}})
    assert message.startswith(
        "metadata has an unknown key 'servos': did you mean 'servo'? known are base,"
    )
    assert "known are base, end, gait, loads, robot" in refusal(LEAST | {"zzzz": 1})


@pytest.mark.parametrize("key", ["robot", "base", "source", "world", "end"])
def test_text_must_be_text(key):
    assert refusal(LEAST | {key: 3}) == f"metadata.{key} must be text, not 3"


def test_a_robot_has_a_name_but_a_source_may_be_empty():
    assert refusal(LEAST | {"robot": ""}) == "metadata 'robot' is empty"
    assert read(LEAST | {"source": ""}).source == ""


def test_the_base_is_fixed_or_floating():
    assert read(LEAST | {"base": "fixed"}).base == "fixed"
    message = refusal(LEAST | {"base": "flaoting"})
    assert message == "metadata 'base' must be 'fixed' or 'floating', not 'flaoting'"


GAINS = FULL["servo"]["knee"]


@pytest.mark.parametrize(
    ("servo", "problem"),
    [
        ([], "metadata.servo must be an object"),
        ({"knee": 3}, "metadata.servo.knee must be an object"),
        ({"knee": {"kp": 1, "kd": 0}}, "metadata.servo.knee has no 'max_torque'"),
        ({"knee": GAINS | {"ki": 0}}, "metadata.servo.knee has an unknown key 'ki'"),
        ({"knee": GAINS | {"kp": -1}}, "kp must be a number from 0 up, not -1"),
        (
            {"knee": GAINS | {"kp": "1"}},
            "servo.knee.kp must be a finite number, not '1'",
        ),
        (
            {"knee": GAINS | {"kd": True}},
            "servo.knee.kd must be a finite number, not True",
        ),
        ({"knee": GAINS | {"kd": 10**400}}, "servo.knee.kd must be a finite number"),
        ({"knee": GAINS | {"max_torque": 0}}, "max_torque must be above 0"),
    ],
)
def test_gains_are_checked(servo, problem):
    assert problem in refusal(LEAST | {"servo": servo})


@pytest.mark.parametrize(
    ("loads", "problem"),
    [
        (3, "metadata.loads must be an object, not 3"),
        ({"shin": {"mass": 1}}, "metadata.loads.shin has no 'at'"),
        ({"shin": {"mass": 0, "at": [0, 0, 0]}}, "must be a number above 0, not 0.0"),
        ({"shin": {"mass": 1, "at": [0, 0]}}, "loads.shin.at must be a list of 3"),
        ({"shin": {"mass": 1, "at": 3}}, "metadata.loads.shin.at must be a list"),
        (
            {"shin": {"mass": 1, "at": [0, "a", 0]}},
            "metadata.loads.shin.at[1] must be a finite number",
        ),
    ],
)
def test_loads_are_checked(loads, problem):
    assert problem in refusal(LEAST | {"loads": loads})


@pytest.mark.parametrize(
    ("mass", "at"),
    [(-1.0, (0, 0, 0)), (True, (0, 0, 0)), (1.0, (0, 0)), (1.0, "abc"), (1.0, 3)],
)
def test_a_load_is_a_mass_at_a_place(mass, at):
    assert Load(2, [1, 0, 0]) == Load(2.0, (1.0, 0.0, 0.0))
    with pytest.raises(BadRecordingError, match="of a load must be"):
        Load(mass, at)


def test_a_gain_of_nothing_is_allowed():
    assert read(LEAST | {"servo": {"knee": GAINS | {"kp": 0, "kd": 0}}})


@pytest.mark.parametrize("wrong", [float("nan"), float("inf")])
def test_gains_are_finite(wrong):
    with pytest.raises(BadRecordingError, match="must be a number from 0 up"):
        ServoGains(wrong, 1.0, 1.0)


def test_a_servo_holds_gains():
    with pytest.raises(BadRecordingError, match="servo of 'knee' must be gains"):
        RecordingMetadata("nao", "fixed", "", servo={"knee": GAINS})


@pytest.mark.parametrize(
    ("terrain", "problem"),
    [
        ("lumps", "metadata.terrain must be an object"),
        ({}, "metadata.terrain has no 'name'"),
        ({"name": 3}, "name must be text, not 3"),
        ({"name": "flat", "sead": 3}, "unknown key 'sead': did you mean 'seed'?"),
        ({"name": "flat", "parameters": [1]}, "parameters must be an object"),
        ({"name": "flat", "seed": -1}, "seed must be from 0 up, not -1"),
        ({"name": "flat", "seed": 1.5}, "seed must be a whole number, not 1.5"),
    ],
)
def test_the_terrain_is_checked(terrain, problem):
    assert problem in refusal(LEAST | {"terrain": terrain})


def test_a_terrain_needs_only_a_name():
    assert read(LEAST | {"terrain": {"name": "flat"}}).terrain == {"name": "flat"}


def test_a_gait_is_an_object():
    assert "metadata.gait must be an object" in refusal(LEAST | {"gait": [0.02]})


@pytest.mark.parametrize("wrong", [float("nan"), object(), np.int64(3)])
def test_what_json_cannot_hold_is_refused_at_once(wrong):
    with pytest.raises(BadRecordingError, match="metadata 'gait' is not JSON"):
        RecordingMetadata("nao", "fixed", "", gait={"a": wrong})


def test_metadata_are_copies_and_hold_what_json_gives_back():
    gait = {"offsets": (1, 2)}
    servo = {"knee": ServoGains(1, 1, 1)}
    metadata = RecordingMetadata("nao", "fixed", "", servo=servo, gait=gait)
    gait["more"] = 1
    servo.clear()
    assert metadata.gait == {"offsets": [1, 2]}
    assert list(metadata.servo) == ["knee"]
    assert RecordingMetadata.from_json(metadata.to_json()) == metadata

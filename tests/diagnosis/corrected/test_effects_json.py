"""Effects on their way from a diagnosis to a sim."""

import json

import pytest

from diagnosis.corrected.effects_json import Correction, load_correction
from diagnosis.effects.parts import PlacedEffect
from diagnosis.plant.load import load_plant
from diagnosis.verdict import Estimate, Found, Verdict
from groundwalk.errors import BadModelError, GroundwalkError, UnknownNameError

KNEE = "LKneePitch"
PLAY = PlacedEffect("backlash", KNEE, (0.03,))
WEAK = PlacedEffect("servo_gain", KNEE, (0.7,))
SPRING = PlacedEffect("joint_spring", "RAnkleRoll", (1.5, -0.2))
HUNG = PlacedEffect("ground_slope", "world", (0.1, 0.0))


@pytest.fixture(scope="module")
def held():
    return load_plant("nao", "fixed")


@pytest.fixture(scope="module")
def walking():
    return load_plant("nao", "floating")


def written(tmp_path, plant, *model):
    path = tmp_path / "corrected.json"
    path.write_text(Correction.of(plant, model).to_json())
    return path


def edited(path, **changes):
    path.write_text(json.dumps({**json.loads(path.read_text()), **changes}))
    return path


def test_what_was_written_is_read_from_folder_and_file(tmp_path, held, walking):
    path = written(tmp_path, held, PLAY, WEAK, SPRING)
    assert load_correction(tmp_path, walking) == (WEAK, SPRING, PLAY)
    assert load_correction(path, held) == (WEAK, SPRING, PLAY)


def test_the_file_says_what_mujoco_has(tmp_path, held):
    plain = json.loads(written(tmp_path, held, PLAY, SPRING).read_text())
    assert plain == {
        "format": 1,
        "robot": "nao",
        "base": "fixed",
        "native": [
            {
                "name": "joint_spring",
                "place": "RAnkleRoll",
                "parameters": {"stiffness": 1.5, "rest": -0.2},
            }
        ],
        "per_tick": [{"name": "backlash", "place": KNEE, "parameters": {"gap": 0.03}}],
    }


def test_parameters_count_by_name_not_by_order(tmp_path, held):
    path = written(tmp_path, held, SPRING)
    native = json.loads(path.read_text())["native"]
    native[0]["parameters"] = {"rest": -0.2, "stiffness": 1.5}
    assert load_correction(edited(path, native=native), held) == (SPRING,)


def test_a_verdict_will_do(tmp_path, held):
    found = [
        Found("backlash", KNEE, {"gap": Estimate(0.03, 0.02, 0.04, "rad")}, 0.9),
        Found("servo_gain", KNEE, {"factor": Estimate(0.7, 0.6, 0.8, "1")}, 0.9),
    ]
    path = tmp_path / "diagnosis.json"
    path.write_text(Verdict("effects", tuple(found)).to_json())
    assert load_correction(tmp_path, held) == (WEAK, PLAY)
    path.write_text(Verdict("none").to_json())
    assert load_correction(path, held) == ()


@pytest.mark.parametrize(
    ("name", "text", "message"),
    [
        ("other.txt", "", r"is no folder of a diagnosis: it has no corrected\.json"),
        ("corrected.json", "{", r"corrected\.json is no diagnosis: .* Expecting"),
        ("corrected.json", "[]", "must be a JSON object"),
        ("corrected.json", '{"format": 2}', "'format' is 2; only 1 is known"),
        ("corrected.json", '{"format": 1}', "has no 'robot'"),
        ("diagnosis.json", '{"kind": "none"}', "has no 'format'"),
    ],
)
def test_what_is_no_diagnosis_is_refused(tmp_path, held, name, text, message):
    (tmp_path / name).write_text(text)
    with pytest.raises(BadModelError, match=message) as caught:
        load_correction(tmp_path, held)
    assert "\n" not in str(caught.value)


def test_a_folder_that_is_not_there_is_refused(tmp_path, held):
    with pytest.raises(BadModelError, match="gone: no such folder or file"):
        load_correction(tmp_path / "gone", held)


@pytest.mark.parametrize(
    ("part", "message"),
    [
        ({"name": "backlas"}, "unknown effect 'backlas': did you mean 'backlash'"),
        ({"place": "LKnee"}, "unknown joint of nao 'LKnee'"),
        ({"parameters": {"gab": 0.1}}, "has the parameters gab; it needs gap"),
        ({"parameters": {"gap": None}}, "must be a finite number"),
    ],
)
def test_effects_that_cannot_be_are_refused(tmp_path, held, part, message):
    path = written(tmp_path, held, PLAY)
    effects = json.loads(path.read_text())["per_tick"]
    edited(path, per_tick=[{**effects[0], **part}])
    with pytest.raises(GroundwalkError, match=message):
        load_correction(path, held)


def test_another_robots_effects_are_refused(tmp_path, held):
    path = edited(written(tmp_path, held, PLAY), robot="so101")
    with pytest.raises(BadModelError, match="of 'so101', the robot is 'nao'"):
        load_correction(path, held)


def test_how_a_base_was_mounted_is_nothing_for_a_robot_that_walks(
    tmp_path, held, walking
):
    path = written(tmp_path, held, HUNG)
    assert load_correction(path, held) == (HUNG,)
    with pytest.raises(BadModelError, match="how a fixed base was mounted"):
        load_correction(path, walking)
    assert load_correction(written(tmp_path, walking, HUNG), walking) == (HUNG,)


def test_a_base_that_was_mounted_about_level_is_no_obstacle(tmp_path, held, walking):
    level = PlacedEffect("ground_slope", "world", (0.004, 0.0))
    path = written(tmp_path, held, PLAY, level)
    assert load_correction(path, held) == (level, PLAY)
    assert load_correction(path, walking) == (PLAY,)


def test_feet_in_the_air_have_no_contact(tmp_path, held, walking):
    path = written(tmp_path, walking, PlacedEffect("contact_friction", "feet", (0.5,)))
    assert load_correction(path, walking)
    with pytest.raises(BadModelError, match="contact_friction needs a robot that"):
        load_correction(path, held)


def test_a_body_that_is_welded_away_is_no_place(tmp_path, held, walking):
    path = written(tmp_path, walking, PlacedEffect("payload_mass", "torso", (0.1,)))
    assert load_correction(path, walking)
    with pytest.raises(UnknownNameError, match="unknown body of nao 'torso'"):
        load_correction(path, held)

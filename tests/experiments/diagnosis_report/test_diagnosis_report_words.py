import re
from dataclasses import replace
from string import Formatter

import made_up_diagnoses as made_up
import numpy as np
import pytest

from diagnosis.effects import all_effects, effect
from diagnosis.verdict import (
    Amount,
    Estimate,
    Found,
    PlacedEffect,
    Verdict,
    When,
)
from experiments.diagnosis_report.figures import CLOSE_UP_S, close_up
from experiments.diagnosis_report.findings import finding, findings
from experiments.diagnosis_report.numbers import (
    amount_text,
    error_unit,
    errors_text,
    estimate_text,
    percent,
)
from experiments.diagnosis_report.place_words import (
    at_words,
    channel_words,
    place_words,
)
from experiments.diagnosis_report.text import answer, doubts
from groundwalk.errors import UnknownNameError

STRIBECK = ("coulomb_torque", "extra_torque", "speed", "exponent")
SIDES = ("link_share", "motor_share", "extra_link_share", "extra_motor_share")
# Effects with their parameters, as the diagnosis' file format has them.
PARAMETERS = {
    "viscous_friction": ("coefficient",),
    "coulomb_friction": ("torque",),
    "stribeck_friction": ("coulomb_torque", "extra_torque", "speed"),
    "load_friction": ("share",),
    "presliding": ("torque", "reach"),
    "shaped_stribeck_friction": STRIBECK,
    "gear_friction": ("coulomb_torque", "share"),
    "gear_stribeck_friction": (*STRIBECK, "share", "extra_share"),
    "directional_gear_friction": (*STRIBECK, *SIDES),
    "quadratic_gear_friction": (*STRIBECK, *SIDES, "extra_square"),
    "backlash": ("gap",),
    "joint_elasticity": ("stiffness", "damping"),
    "command_latency": ("delay",),
    "sensor_delay": ("delay",),
    "late_reading": ("delay",),
    "encoder_offset": ("offset",),
    "gyro_bias": ("x", "y", "z"),
    "torque_limit": ("torque",),
    "speed_limit": ("speed",),
    "acceleration_limit": ("acceleration",),
    "servo_gain": ("factor",),
    "servo_damping": ("factor",),
    "integral_term": ("time",),
    "dead_band": ("width",),
    "error_derivative": ("share",),
    "armature": ("inertia",),
    "payload_mass": ("mass",),
    "com_offset": ("x", "y", "z"),
    "link_inertia": ("factor",),
    "joint_spring": ("stiffness", "rest"),
    "torque_offset": ("torque",),
    "cogging": ("torque", "per_turn", "phase"),
    "end_stop": ("angle", "side"),
    "servo_fade": ("rate",),
    "servo_off": ("share",),
    "supply_sag": ("share",),
    "angle_friction": ("torque", "factor"),
    "contact_friction": ("coefficient",),
    "contact_compliance": ("stiffness",),
    "ground_slope": ("pitch", "roll"),
    "uneven_ground": ("height",),
    "external_force": ("x", "y", "z", "start", "duration"),
    "drag": ("coefficient",),
    "torque_scale": ("factor",),
}
BODIES = {"payload_mass", "com_offset", "link_inertia", "external_force", "drag"}
ELSEWHERE = {
    "command_latency", "sensor_delay", "gyro_bias", "contact_friction",
    "contact_compliance", "ground_slope", "supply_sag", "uneven_ground",
}  # fmt: skip
UNSAID = {"end_stop": {"side"}, "external_force": {"start", "duration"}}


def test_every_effect_has_words_and_no_other():
    assert all_effects().keys() == PARAMETERS.keys()
    for words in (one.words for one in all_effects().values()):
        assert re.fullmatch(r"[A-Z].*\.", words.meaning)
        assert len(words.label) < 40


@pytest.mark.parametrize("name", PARAMETERS)
def test_findings_tell_the_place_and_every_parameter(name):
    finding = effect(name).words.finding
    told = {field for _, field, _, _ in Formatter().parse(finding) if field}
    place = set() if name in ELSEWHERE else {"body" if name in BODIES else "joint"}
    wanted = {*PARAMETERS[name], *place} - UNSAID.get(name, set())
    assert told - {"lacking", "usual"} == wanted


@pytest.mark.parametrize("name", PARAMETERS)
@pytest.mark.parametrize("changed", [False, True])
def test_findings_leave_nothing_open(name, changed):
    parameters = {key: Estimate(0.2, 0.1, 0.3, "N") for key in PARAMETERS[name]}
    text = finding(Found(name, "LTibia", parameters, 0.9), changed)
    assert "{" not in text
    assert "unknown amount" not in text
    assert "sim" not in text or not changed
    without = finding(Found(name, "LTibia", {}, 0.9), changed)
    assert "an unknown amount" in without


def test_mass_that_the_robot_lacks_is_said_without_a_sign():
    lighter = Estimate(-0.2, -0.3, -0.1, "kg")
    text = finding(Found("payload_mass", "lever", {"mass": lighter}, 0.9))
    wanted = (
        "the body lever is lighter than in the sim, by about 0.20 kg (0.10 to 0.30)"
    )
    assert text == wanted
    more = {"mass": Estimate(0.2, 0.1, 0.3, "kg")}
    assert "carries about 0.20 kg" in finding(Found("payload_mass", "lever", more, 0.9))


def test_unknown_effects_have_no_words():
    assert effect("backlash").words.label == "play (backlash)"
    with pytest.raises(UnknownNameError, match="did you mean 'backlash'"):
        effect("backlsh")


@pytest.mark.parametrize(
    ("place", "kind", "words"),
    [
        ("LKneePitch", "joint", "the left knee (LKneePitch)"),
        ("RAnkleRoll", "joint", "the right ankle roll (RAnkleRoll)"),
        ("LHipYawPitch", "joint", "the left hip yaw pitch (LHipYawPitch)"),
        ("LTibia", "body", "the left tibia (LTibia)"),
        ("shoulder_pan", "joint", "the joint shoulder_pan"),
        ("torso", "body", "the body torso"),
        ("Lift", "joint", "the joint Lift"),
        ("commands", "", "commands"),
    ],
)
def test_places_in_words(place, kind, words):
    assert place_words(place, kind) == words


def test_effects_and_channels_in_words():
    assert at_words(PlacedEffect("drag", "torso")) == "drag at the body torso"
    assert at_words(PlacedEffect("command_latency", "commands")) == "late commands"
    knee = "the torque of the right knee (RKneePitch)"
    assert channel_words("torque.RKneePitch") == knee
    assert channel_words("gyroscope.x") == "gyroscope x"


@pytest.mark.parametrize(
    ("estimate", "text"),
    [
        (Estimate(0.0304, 0.0271, 0.0338, "rad"), "0.030 rad (0.027 to 0.034)"),
        (Estimate(3.041, 3.031, 3.053, "rad"), "3.041 rad (3.031 to 3.053)"),
        (Estimate(0.0183, 0.0175, 0.0190, "s"), "18.3 ms (17.5 to 19.0)"),
        (Estimate(12.31, 12.28, 12.34, "s"), "12.31 s (12.28 to 12.34)"),
        (Estimate(203.5, 180.2, 231.9, "N s/m"), "204 N s/m (180 to 232)"),
        (Estimate(0.0121, 0.0112, 0.0133, "kg m^2"), "0.0121 kg m² (0.0112 to 0.0133)"),
        (Estimate(0.8, 0.76, 0.85, "1"), "0.80 (0.76 to 0.85)"),
        (Estimate(0.0021, 0.0018, 0.0024, "1/s"), "0.21 % per second (0.18 to 0.24)"),
        (Estimate(-0.0004, -0.5, 0.4, "N"), "0.0 N (-0.5 to 0.4)"),
        (Estimate(-1.0, -1.0, -1.0, "1"), "-1"),
        (Estimate(0.0, 0.0, 0.0, "rad"), "0 rad"),
    ],
)
def test_estimates_have_the_digits_that_are_known(estimate, text):
    assert estimate_text(estimate) == text


def test_errors_that_stand_together_have_the_same_decimals():
    assert errors_text([5.13, 1.17, 0.9]) == ["5.1", "1.2", "0.9"]
    assert errors_text([None, 12.2, 14.0]) == ["\N{EN DASH}", "12", "14"]
    assert errors_text([1234.0, 0.5, 0.0]) == ["1234", "0", "0"]
    assert errors_text([None]) == ["\N{EN DASH}"]
    assert error_unit("rad", 0.005) == (1e3, "mrad")
    assert error_unit("rad", 0.5) == (1.0, "rad")
    assert error_unit("N m", 0.005) == (1.0, "N m")


def test_amounts_and_parts_of_a_hundred():
    assert amount_text(Amount(0.00421, "rad")) == "0.0042 rad"
    assert amount_text(Amount(0.0006, "s")) == "0.60 ms"
    assert amount_text(Amount(0.0, "1")) == "0"
    texts = [percent(part) for part in (0.0, 0.001, 0.5, 0.97, 0.998, 1.0)]
    assert texts == ["0 %", "under 1 %", "50 %", "97 %", "over 99 %", "100 %"]


def one_second(real, sim):
    time_s = np.arange(1000) * 0.01
    return close_up(time_s, real, sim)


def test_the_close_up_is_where_the_error_is():
    real, off = np.zeros(1000), np.zeros(1000)
    off[600:700] = 0.1
    wave = np.sin(0.3 * np.arange(1000))
    rows = one_second(wave, wave + off)
    assert rows.start <= 649 <= rows.stop - 1
    assert rows.stop - rows.start == pytest.approx(100 * CLOSE_UP_S, abs=1)
    assert one_second(real, real).start == 0
    gap = np.where(off > 0, np.nan, real)
    assert one_second(gap, real).start == 0


def test_of_two_errors_the_one_beside_less_motion_is_shown():
    motion = np.concatenate([np.linspace(0, 5, 500), 5 + 0.01 * np.arange(500) / 500])
    off = np.full(1000, 0.02)
    rows = one_second(motion, motion + off)
    assert rows.start >= 400


def friction(place, torque):
    value = Estimate(torque, torque * 0.9, torque * 1.1, "N m")
    return Found("coulomb_friction", place, {"torque": value}, 0.9)


def test_a_value_that_all_places_share_is_told_once():
    joints = "A", "B", "C"
    found = [
        Found(
            "servo_gain",
            joint,
            {"factor": Estimate(1.5, 1.4, 1.6, "1")},
            0.9,
            shared_with=tuple(one for one in joints if one != joint),
        )
        for joint in joints
    ]
    (told,) = findings(found)
    many = "servo stiffness at 3 places"
    assert told == f"{many}, factor about 1.50 (1.40 to 1.60) at all of them"


def test_one_effect_at_many_places_is_told_once():
    at_three = [friction("A", 0.5), friction("B", 0.2), friction("C", 0.3)]
    assert findings(at_three) == [
        "dry friction at 3 places, torque from about 0.2 N m at the joint B to about "
        "0.5 N m at the joint A"
    ]
    assert [clause.count("has dry friction") for clause in findings(at_three[:2])] == [
        1,
        1,
    ]


def test_effects_without_values_are_told_one_by_one():
    bare = [Found("coulomb_friction", place, {}, 0.9) for place in "ABC"]
    assert ["unknown amount" in told for told in findings(bare)] == [True] * 3


def test_what_comes_and_goes_is_told_one_by_one():
    fading = replace(friction("C", 0.3), when=When("drift", 1.0, 2.0))
    told = findings([friction("A", 0.5), friction("B", 0.2), fading])
    assert len(told) == 3
    assert told[2].endswith("growing from 1 to 2 s")


def test_what_the_data_do_not_show_is_not_given_as_a_number():
    """A push on a sliding joint shows along its axis only."""
    shown, not_shown = Estimate(3.4, 3.1, 3.6, "N"), Estimate(2.0, -598.0, 598.0, "N")
    force = {"x": shown, "y": not_shown, "z": not_shown}
    push = Found("external_force", "carriage", force, 0.8)
    assert finding(push) == (
        "the body carriage was pushed with about 3.4 N (3.1 to 3.6) in x, an unknown "
        "amount in y and an unknown amount in z"
    )
    shove = replace(push, when=When("burst", 3.1, 3.35))
    assert finding(shove).endswith("in z, from 3.1 to 3.35 s")


def test_small_values_are_said_last_and_are_no_evidence():
    names = ("coulomb_friction", "torque", "N m"), ("servo_gain", "factor", "1")
    missing, small = (
        Found(
            name=name,
            place="knee",
            parameters={value: Estimate(1.01, 1.0, 1.02, unit)},
            probability=0.9,
            native=True,
        )
        for name, value, unit in names
    )
    *_, last = answer(Verdict("effects", (missing,), (small,)))
    assert "servo stiffness at the joint knee" in last
    assert "no evidence" in last
    assert "dry friction" not in last
    assert not any("no evidence" in text for text in answer(Verdict("none")))


def test_what_holds_at_many_places_is_said_once():
    (known,) = made_up.ONE.effects
    alike = [replace(known, place=place) for place in "ABCD"]
    sure = replace(known, place="E", confusable_with=())
    verdict = replace(made_up.ONE, effects=(*alike, sure), alternatives=())
    many, other = doubts(verdict)
    assert many.startswith("Play (backlash) at 4 places: ")
    assert "do not rule out dry friction" in many
    assert "no other effect" in other
    few = replace(verdict, effects=(*alike[:2],))
    assert len(doubts(few)) == 2

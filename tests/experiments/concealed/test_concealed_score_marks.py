"""Tests the scores of made-up sets, whose figures can be computed by hand."""

from dataclasses import replace

import pytest
from made_up_scores import (
    DRY,
    HIP,
    KNEE,
    NOTHING,
    RIGHT,
    UNKNOWN,
    UNSURE,
    WET,
    found,
    names,
    oracle,
    scored,
    single,
)

from diagnosis.verdict import Estimate, Fit, Found, PlacedEffect, Verdict
from experiments.concealed.scoring.answers import Answer
from experiments.concealed.scoring.oracle import Oracle
from experiments.reports.statistics import wilson
from worlds.hidden.effects import Hidden

COGGING = Hidden("cogging", KNEE, {"torque": 0.1, "per_turn": 12.0, "phase": 0.0})
REFUSED = Answer("refused", limits=("too short",))
DRAG = Hidden("drag", "x", {"coefficient": 1.0})

# Names


def test_right_first_names_are_counted_by_level():
    score = scored(
        single(names(RIGHT), oracle(gain=100.5)),
        single(names(found("backlash", KNEE)), oracle(gain=150.0)),
        single(names(RIGHT), oracle(gain=99.0)),
        single(names(RIGHT), oracle(gain=19.0)),
        single(NOTHING, oracle(gain=4.9)),
    )
    counts = {name: (f["value"], f["n"]) for name, f in score["top1"].items()}
    assert counts == {
        "L1": (0.5, 2),
        "L2": (1.0, 1),
        "L3": (1.0, 1),
        "L4": (0.0, 1),
        "all": (0.6, 5),
    }
    low, high = wilson(1, 2)
    assert (score["top1"]["L1"]["low"], score["top1"]["L1"]["high"]) == (low, high)
    assert set(score["levels"].values()) == {"L1", "L2", "L3", "L4"}


def test_a_right_name_at_another_place_is_not_there():
    elsewhere = names(replace(RIGHT, place="LAnklePitch"))
    score = scored(single(names(RIGHT)), single(elsewhere), single(NOTHING))
    assert (score["top1"]["all"]["value"], score["there"]["value"]) == (2 / 3, 1 / 3)
    second = names(found("backlash", KNEE), RIGHT)
    assert scored(single(second))["there"]["value"] == 0


def test_a_right_effect_that_is_not_the_first_is_in_the_set_but_not_top():
    second = names(found("backlash", KNEE), RIGHT)
    score = scored(single(second))
    assert score["top1"]["L1"]["value"] == 0
    assert score["in_set"]["L1"]["value"] == 1


def test_the_set_is_what_is_found_what_is_confusable_and_the_alternatives():
    confusable = names(found("backlash", KNEE, others=("coulomb_friction",)))
    other = Verdict(
        "not_identifiable",
        alternatives=(
            (PlacedEffect("coulomb_friction", HIP),),
            (PlacedEffect("drag", "x"),),
        ),
    )
    wrong = names(found("backlash", KNEE, others=("load_friction",)))
    score = scored(single(confusable), single(other), single(wrong), single(NOTHING))
    assert (score["in_set"]["all"]["value"], score["in_set"]["all"]["n"]) == (0.5, 4)
    assert score["set_size"]["value"] == 2.0
    assert score["set_size"]["n"] == 3


def test_places_count_where_the_name_is_right():
    score = scored(
        single(names(RIGHT)),
        single(names(found("coulomb_friction", HIP))),
        single(names(found("backlash", HIP))),
    )
    assert (score["place"]["value"], score["place"]["n"]) == (0.5, 2)


def test_f1_of_pairs_wants_name_and_place():
    pair = ("pair", (DRY, WET))
    score = scored(
        (*pair, names(RIGHT, found("viscous_friction", HIP, 0.5, 0.4, 0.6)), oracle()),
        (*pair, names(RIGHT, found("viscous_friction", KNEE)), oracle()),
        (
            "triple",
            (DRY, WET, Hidden("drag", "x", {"coefficient": 1.0})),
            None,
            oracle(),
        ),
        single(names(found("backlash", KNEE))),  # singles do not count
    )
    # 3 hits, 1 extra, 1 + 3 missed
    assert score["pairs_f1"]["value"] == pytest.approx(6 / (6 + 1 + 4))
    assert score["pairs_f1"]["n"] == 3
    assert score["pairs_f1"]["low"] <= 6 / 11 <= score["pairs_f1"]["high"]


# Right as a whole


@pytest.mark.parametrize(
    ("kind", "verdict", "right"),
    [
        ("single", names(RIGHT), True),
        ("single", names(RIGHT, found("backlash", HIP)), False),  # one too many
        ("single", names(found("coulomb_friction", HIP)), False),
        (
            "single",
            Verdict("unknown", (RIGHT,), unexplained=UNKNOWN.unexplained),
            False,
        ),
        ("single", NOTHING, False),
        ("pair", names(found("viscous_friction", HIP), RIGHT), True),
        ("pair", names(RIGHT), False),  # one is missed
        ("none", NOTHING, True),
        ("none", UNKNOWN, False),
        ("none", UNSURE, False),
        ("none", REFUSED, False),
        ("none", names(RIGHT), False),
        ("outside", UNKNOWN, True),
        ("outside", NOTHING, True),  # set 1 does not say how clearly it shows
        ("outside", UNSURE, False),
        ("outside", REFUSED, False),
        ("unexcited", REFUSED, False),
        ("outside", names(found("backlash", KNEE)), False),
        ("unexcited", UNSURE, True),
        ("unexcited", NOTHING, True),
        ("unexcited", names(RIGHT), True),
        ("unexcited", names(found("backlash", KNEE)), False),
        ("unexcited", UNKNOWN, False),
        ("single", None, False),
        ("none", None, False),
        ("outside", None, False),
        ("unexcited", None, False),
    ],
)
def test_an_answer_is_right_as_a_whole_or_not(kind, verdict, right):
    hidden = {
        "pair": (DRY, WET),
        "none": (),
        "outside": (COGGING,),
    }
    known = oracle() if kind in ("single", "pair") else None
    score = scored((kind, hidden.get(kind, (DRY,)), verdict, known))
    assert (score["right"]["value"], score["right"]["n"]) == (float(right), 1)


# Values


def test_errors_and_intervals_of_right_effects():
    def answer(value, low, high):
        return single(names(found("coulomb_friction", KNEE, value, low, high)))

    score = scored(
        answer(0.22, 0.21, 0.23),  # 10 % off, not covered
        answer(0.19, 0.18, 0.21),  # 5 % off
        answer(0.28, 0.10, 0.30),  # 40 % off
        single(names(found("coulomb_friction", HIP, 9, 9, 9))),  # wrong place
    )
    assert score["parameter_error_median"]["value"] == pytest.approx(0.10)
    assert score["parameter_error_median"]["n"] == 3
    assert score["coverage80"]["value"] == pytest.approx(2 / 3)
    assert score["coverage80"]["n"] == 3


def test_vectors_are_compared_as_vectors_and_factors_from_where_they_do_nothing():
    com = Hidden("com_offset", "torso", {"x": 0.03, "y": 0.04, "z": 0.0})
    at = {name: Estimate(value, value, value, "m") for name, value in
          {"x": 0.03, "y": 0.04, "z": 0.01}.items()}  # fmt: skip
    gain = Hidden("servo_gain", KNEE, {"factor": 1.2})
    factor = {"factor": Estimate(1.1, 1.0, 1.3, "1")}
    none_at = {"com_offset@torso": dict.fromkeys("xyz", 0.0)}
    one_at = {f"servo_gain@{KNEE}": {"factor": 1.0}}
    for hidden, values, neutral, error in (
        (com, at, none_at, 0.2),
        (gain, factor, one_at, 0.5),
    ):
        verdict = names(Found(hidden.name, hidden.place, values, 0.9))
        its = Oracle(200.0, 5.0, 1.0, neutral, {})
        score = scored(("single", (hidden,), verdict, its))
        assert score["parameter_error_median"]["value"] == pytest.approx(error)
    # of com_offset's three components two are covered
    score = scored(
        (
            "single",
            (com,),
            names(Found("com_offset", "torso", at, 0.9)),
            Oracle(200.0, 5.0, 1.0, none_at, {}),
        )
    )
    assert (score["coverage80"]["value"], score["coverage80"]["n"]) == (2 / 3, 3)


def test_a_stiffness_is_measured_against_itself():
    spring = Hidden("joint_elasticity", KNEE, {"stiffness": 100.0, "damping": 1.0})
    values = {
        "stiffness": Estimate(150.0, 90.0, 160.0, "N m/rad"),
        "damping": Estimate(9.0, 8.0, 10.0, "N m s/rad"),  # does not count
    }
    neutral = {f"joint_elasticity@{KNEE}": {"stiffness": None, "damping": 0.0}}
    verdict = names(Found("joint_elasticity", KNEE, values, 0.9))
    its = Oracle(200.0, 5.0, 1.0, neutral, {})
    score = scored(("single", (spring,), verdict, its))
    assert score["parameter_error_median"]["value"] == pytest.approx(0.5)
    assert (score["coverage80"]["value"], score["coverage80"]["n"]) == (1.0, 1)


# Held-out errors


def test_closed_is_relative_to_the_oracle_and_needs_something_to_close():
    fit = Fit(
        nominal=5.0,
        corrected=2.0,
        floor=1.0,
        wrong_place=4.4,
        wrong_effect=3.5,
        channels={},
    )
    score = scored(
        single(names(RIGHT, fit=fit), oracle(diagnosis=2.0)),  # 3 of 4
        single(NOTHING, oracle(diagnosis=5.0)),  # nothing
        single(None, oracle()),  # no answer: nothing
        single(names(RIGHT), oracle(diagnosis=500.0)),  # worse counts as -1
        single(names(RIGHT), oracle(gain=10.0, diagnosis=1.0)),  # L3
        single(names(RIGHT), oracle(nominal=1.0, fitted=1.0, diagnosis=1.0)),
    )
    closed = score["closed"]
    assert closed["closed"]["value"] == pytest.approx((0.75 + 0 + 0 - 1) / 4)
    assert closed["closed"]["n"] == 4
    # of three quarters a fifth and a half are left to the controls
    assert closed["wrong_place"]["value"] == pytest.approx(0.75 * 0.2)
    assert closed["wrong_effect"]["value"] == pytest.approx(0.75 * 0.5)
    assert closed["wrong_place"]["n"] == 1


# Nothing, something else, nothing that moved


def test_false_alarms_and_names_for_what_has_none():
    partly = Verdict("unknown", (RIGHT,), unexplained=UNKNOWN.unexplained)
    strange = COGGING
    score = scored(
        ("none", (), NOTHING, None),
        ("none", (), UNKNOWN, None),
        ("none", (), partly, None),
        ("none", (), names(RIGHT), None),
        ("outside", (strange,), names(RIGHT), None),
        ("outside", (strange,), partly, None),
        ("outside", (strange,), UNKNOWN, None),
        ("unexcited", (DRY,), UNSURE, None),
        ("unexcited", (DRY,), NOTHING, None),
        ("unexcited", (DRY,), names(RIGHT), None),
    )
    # what is listed beside "unknown" is not named
    assert (score["null_false_alarms"]["value"], score["null_false_alarms"]["n"]) == (
        0.25,
        4,
    )
    assert score["outside_named"]["value"] == pytest.approx(1 / 3)
    assert score["unexcited_right"]["value"] == pytest.approx(2 / 3)
    assert score["verdicts"]["none"] == {"none": 1, "unknown": 2, "effects": 1}
    assert score["pairs_f1"] == {"value": None, "n": 0, "low": None, "high": None}


def test_missing_answers_are_wrong_everywhere_and_named():
    score = scored(
        single(names(RIGHT)),
        single(None),
        ("none", (), None, None),
        ("outside", (DRY,), None, None),
        ("unexcited", (DRY,), None, None),
    )
    assert score["missing"] == ["case_001", "case_002", "case_003", "case_004"]
    assert score["top1"]["all"]["value"] == 0.5
    assert score["null_false_alarms"]["value"] == 1
    assert score["outside_named"]["value"] == 1
    assert score["unexcited_right"]["value"] == 0


# Probabilities


def test_calibration_error_is_the_weighted_gap_of_the_bins():
    def stated(probability, is_right):
        name = "coulomb_friction" if is_right else "backlash"
        return single(names(found(name, KNEE, probability=probability)))

    good = scored(*[stated(0.75, i < 3) for i in range(4)])
    assert good["ece"]["value"] == pytest.approx(0.0)
    bad = scored(*[stated(0.95, i < 5) for i in range(10)], *[stated(0.25, False)] * 2)
    assert bad["ece"]["value"] == pytest.approx((10 * 0.45 + 2 * 0.25) / 12)
    assert [(row["n"], row["right"]["value"]) for row in bad["reliability"]] == [
        (2, 0.0),
        (10, 0.5),
    ]
    assert scored(single(NOTHING))["ece"]["n"] == 0


def test_the_same_truth_gives_the_same_intervals():
    rows = [single(names(RIGHT)), single(NOTHING), single(names(RIGHT))]
    assert scored(*rows) == scored(*rows)

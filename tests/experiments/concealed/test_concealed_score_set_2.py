"""Scores of cases with small mismatch, levels in the truth, and probabilities."""

import numpy as np
import pytest
from made_up_scores import DRY, HIP, KNEE, NOTHING, RIGHT, UNKNOWN, WET, found, names

from diagnosis.verdict import Estimate, Found
from experiments.concealed.score import score_of
from experiments.concealed.scoring.answers import Answer, Named, read_answer
from experiments.concealed.scoring.paired import mcnemar
from experiments.concealed.scoring.truth import SmallMismatch, TrueCase, Truth
from worlds.hidden.effects import Hidden

SMALL = (
    SmallMismatch("servo_gain", HIP, {"factor": 1.04}),
    SmallMismatch("viscous_friction", KNEE, {"coefficient": 0.02}),
    SmallMismatch("payload_mass", "shin", {"mass": -0.03}),
)
STRANGE = Hidden("cogging", KNEE, {"torque": 0.1, "per_turn": 12.0, "phase": 0.0})


def case(number, kind, *effects, nats=None):
    told = () if nats is None else (nats,) * len(effects)
    name = f"case_{number:03d}"
    return TrueCase("z1", "mujoco", kind, effects, nats=told, nuisance=SMALL, name=name)


def scored(*rows, **others):
    """Scores of rows (case without number, answer), by methods of the same cases."""
    cases = {f"case_{i:03d}": case(i, *row[0][:-1], nats=row[0][-1])
             for i, row in enumerate(rows)}  # fmt: skip
    ours = {
        name: row[1] if isinstance(row[1], Answer) else read_answer(row[1].to_json())
        for name, row in zip(cases, rows, strict=True)
    }
    theirs = {
        method: {
            name: read_answer(one.to_json())
            for name, one in zip(cases, some, strict=True)
        }
        for method, some in others.items()
    }
    return score_of(Truth(7, cases, "ab", 2), {"diagnosis": ours, **theirs}, {})


def gain(factor, place=HIP):
    value = {"factor": Estimate(factor, factor, factor, "1")}
    return Found("servo_gain", place, value, 0.9)


NULL = ("none", None)
EASY, FAINT = ("single", DRY, 300.0), ("single", DRY, 7.0)


@pytest.mark.parametrize(
    ("answer", "alarm", "right"),
    [
        (NOTHING, False, True),
        (names(gain(1.04)), False, True),
        (names(gain(1.07)), False, True),
        (names(gain(1.09)), True, False),  # nothing would be nearer
        (names(gain(0.97)), True, False),  # to the wrong side
        (names(gain(1.04, KNEE)), True, False),  # not there
        (names(gain(1.04), found("backlash", KNEE)), True, False),
        (UNKNOWN, False, False),
    ],
)
def test_small_mismatch_that_is_there_may_be_named(answer, alarm, right):
    score = scored((NULL, answer))
    assert score["null_false_alarms"]["value"] == float(alarm)
    assert score["right"]["value"] == float(right)
    assert score["right_by_kind"]["none"]["n"] == 1


def test_small_mismatch_is_neither_needed_nor_in_the_way():
    first = names(gain(1.03), RIGHT)
    score = scored((EASY, first), (EASY, names(RIGHT)))
    assert score["right"]["value"] == 1
    assert score["top1"]["L1"]["value"] == 1
    assert score["coverage80"]["n"] == 2


def test_levels_are_those_of_the_truth_and_of_the_faintest_effect():
    pair = ("pair", DRY, WET)
    cases = [case(0, *pair, nats=300.0), case(1, *EASY[:2], nats=30.0)]
    cases[0] = TrueCase("z1", "mujoco", "pair", (DRY, WET), nats=(300.0, 6.0), name="a")
    score = score_of(Truth(1, {one.name: one for one in cases}), {"diagnosis": {}}, {})
    assert score["levels"] == {"a": "L3", "case_001": "L2"}
    assert score["compounds"]["L3"]["n"] == 1


def test_a_faint_effect_from_outside_may_be_missed_and_a_clear_one_may_not():
    clear, faint = ("outside", STRANGE, 30.0), ("outside", STRANGE, 12.0)
    for row, answer, right in (
        (clear, UNKNOWN, 1),
        (clear, NOTHING, 0),
        (clear, names(gain(1.04)), 0),
        (faint, NOTHING, 1),
        (faint, names(gain(1.04)), 1),
        (faint, names(RIGHT), 0),
    ):
        assert scored((row, answer))["right"]["value"] == right
    named = scored((clear, names(RIGHT)), (clear, names(gain(1.04))), (clear, UNKNOWN))
    assert named["outside_named"]["value"] == pytest.approx(1 / 3)


def test_intervals_are_counted_by_size_and_for_several_at_once():
    tight = names(found("coulomb_friction", KNEE, 0.3, 0.25, 0.35))
    wet = found("viscous_friction", HIP, 0.5, 0.4, 0.6)
    both = names(RIGHT, wet)
    score = scored(
        (EASY, names(RIGHT)),
        (EASY, tight),
        (FAINT, names(RIGHT)),
        (("pair", DRY, WET, 50.0), both),
    )
    of = score["coverage80_of"]
    assert (of["large"]["value"], of["large"]["n"]) == (0.5, 2)
    assert (of["small"]["value"], of["small"]["n"]) == (1.0, 1)
    assert (of["several"]["value"], of["several"]["n"]) == (1.0, 2)


def stated(probability, is_right):
    name = "coulomb_friction" if is_right else "backlash"
    return EASY, Answer("effects", (Named(name, KNEE, {}, probability),))


def test_probabilities_are_held_against_the_best_constant():
    rows = [stated(0.9, True)] * 6 + [stated(0.2, False)] * 2
    score = scored(*rows)
    brier, constant = (6 * 0.1**2 + 2 * 0.2**2) / 8, 0.75 * 0.25
    assert score["brier"]["value"] == pytest.approx(brier)
    assert score["brier_constant"]["value"] == pytest.approx(constant)
    assert score["brier_skill"]["value"] == pytest.approx(1 - brier / constant)
    same = scored(*[stated(0.75, i < 6) for i in range(8)])
    assert same["brier_skill"]["value"] == pytest.approx(0.0)


def test_an_answer_without_probability_is_no_statement():
    score = scored(stated(None, True), stated(0.8, True))
    assert score["brier"]["n"] == score["ece"]["n"] == 1
    assert score["top1"]["L1"]["value"] == 1
    beside = Answer("unknown", (Named("backlash", KNEE, {}, None),))
    assert scored((EASY, beside))["brier"]["n"] == 0


def test_mcnemar_is_the_sign_test_of_the_cases_that_differ():
    assert mcnemar(0, 0) == 1.0
    assert mcnemar(5, 0) == pytest.approx(2 * 0.5**5)
    assert mcnemar(8, 1) == mcnemar(1, 8) == pytest.approx(2 * (1 + 9) * 0.5**9)
    assert mcnemar(4, 4) == 1.0


def test_methods_are_compared_case_by_case():
    score = scored(
        (EASY, names(RIGHT)),
        (EASY, names(RIGHT)),
        (NULL, NOTHING),
        (("outside", STRANGE, 30.0), UNKNOWN),
        bic=[names(RIGHT), NOTHING, names(RIGHT), names(RIGHT)],
    )
    paired = score["paired"]["bic"]
    assert (paired["right"]["only_ours"], paired["right"]["only_theirs"]) == (3, 0)
    assert paired["right"]["p"] == pytest.approx(0.25)
    assert paired["top1"]["n"] == 2
    assert paired["null"] == {"n": 1, "only_ours": 1, "only_theirs": 0, "p": 1.0}
    assert np.isfinite([one["p"] for one in paired.values()]).all()

"""Answers in the format of docs/concealed_answers.md."""

import json

import pytest
from made_up_scores import KNEE, NOTHING, RIGHT, UNKNOWN, UNSURE, names

from experiments.concealed.scoring.answers import Answer, Named, Stated, read_answer
from groundwalk.errors import BadValueError


def text(**plain):
    return json.dumps({"format": 1, **plain})


def test_little_is_asked_for():
    assert read_answer(text(kind="none")) == Answer("none")
    one = read_answer(text(kind="effects", effects=[{"name": "drag", "place": "x"}]))
    assert one.effects == (Named("drag", "x"),)
    assert one.effects[0].probability is None


def test_values_may_have_intervals_or_none():
    values = {"torque": {"value": 0.2, "low": 0.1, "high": 0.3, "unit": "N m"}}
    effect = {"name": "coulomb_friction", "place": KNEE, "parameters": values}
    (found,) = read_answer(text(kind="effects", effects=[effect])).effects
    assert found.parameters["torque"].holds(0.25)
    assert not found.parameters["torque"].holds(0.31)
    assert not Stated(0.2).holds(0.2)


@pytest.mark.parametrize("verdict", [names(RIGHT), NOTHING, UNKNOWN, UNSURE])
def test_every_verdict_of_a_diagnosis_is_an_answer(verdict):
    answer = read_answer(verdict.to_json())
    assert answer.kind == verdict.kind
    assert [each.name for each in answer.effects] == [e.name for e in verdict.effects]
    assert read_answer(answer.to_json()) == answer


def test_a_probability_may_be_unknown():
    plain = json.loads(names(RIGHT).to_json())
    plain["effects"][0]["probability"] = None
    plain["kind"] = "unknown"
    answer = read_answer(json.dumps(plain))
    assert answer.effects[0].probability is None


@pytest.mark.parametrize(
    ("plain", "message"),
    [
        ({"kind": "maybe"}, "kind must be"),
        ({}, "has no 'kind'"),
        ({"kind": "effects"}, "must name one"),
        ({"kind": "none", "effects": [{"name": "a", "place": "b"}]}, "must not name"),
        ({"kind": "effects", "effects": [{"name": "drag"}]}, "has no 'place'"),
        (
            {"kind": "effects", "effects": [
                {"name": "drag", "place": "x", "probability": 1.2}
            ]},
            "probability",
        ),
        (
            {"kind": "effects", "effects": [
                {"name": "drag", "place": "x", "parameters": {"c": {"value": "big"}}}
            ]},
            "finite number",
        ),
    ],
)  # fmt: skip
def test_what_is_no_answer_is_refused_with_a_reason(plain, message):
    with pytest.raises(BadValueError, match=message):
        read_answer(text(**plain))

"""At how many joints something is missing, and which search follows from that."""

import numpy as np
import pytest
from known_arms import CHANNELS, SINGLE, measured
from made_up_traces import arm, recorded

from diagnosis.effects.parts import PlacedEffect
from diagnosis.residuals.predictor import Predictor
from diagnosis.search import few_or_many
from diagnosis.search.few_or_many import found_by
from diagnosis.search.judging import Judge
from diagnosis.search.search import Search
from diagnosis.search.spread import is_widespread, joints_off

SHOULDER = ("servo_gain", "shoulder", 0.75)
ELBOW = ("servo_gain", "elbow", 0.7)


def predictor_of(*effects):
    found = Predictor(arm(), [recorded(arm(), *effects, duration_s=2.0)], CHANNELS)
    found.calibrate()
    return found


def model_of(*effects):
    return tuple(PlacedEffect(name, place, (value,)) for name, place, value in effects)


@pytest.mark.parametrize(
    ("missing", "known", "off"),
    [
        ((), (), []),
        ((ELBOW,), (), ["elbow"]),
        ((SHOULDER, ELBOW), (), ["shoulder", "elbow"]),
        ((SHOULDER, ELBOW), (SHOULDER, ELBOW), []),
    ],
)
def test_joints_are_off_until_a_model_explains_them(missing, known, off):
    predictor, model = predictor_of(*missing), model_of(*known)
    assert joints_off(predictor, model) == off
    assert is_widespread(predictor, model, few=1) is (len(off) == 2)
    assert not is_widespread(predictor, model, few=2)  # two effects may explain both


def test_what_models_usually_get_wrong_does_not_count():
    predictor = predictor_of(("servo_gain", "elbow", 0.94))
    nominal = predictor.nominal().residuals([()])[0]
    elbow = predictor.scored & (predictor.channel == 1)
    assert np.mean(nominal[elbow] ** 2) > 20
    assert joints_off(predictor, ()) == []


def found(monkeypatch, **truth):
    """What is found where few or many joints lack something; which searches ran."""
    ran = []

    search_for_many = few_or_many.everywhere

    def everywhere(judge, result, known):
        ran.append("everywhere")
        return search_for_many(judge, result, known)

    monkeypatch.setattr(few_or_many, "everywhere", everywhere)
    parts = [Predictor(arm(), [measured(seed, **truth)], CHANNELS) for seed in (1, 2)]
    for part in parts:
        part.calibrate()
    result, at_all = found_by(Search(Judge(*parts, SINGLE)))
    return result.winner.keys if result.winner else set(), at_all, ran


@pytest.mark.slow
def test_effects_at_all_joints_are_searched_for_where_most_are_off(monkeypatch):
    keys = {"servo_gain@shoulder", "servo_gain@elbow"}
    wrong = {"gain": (0.75, 0.7), "duration_s": 2.5}
    assert found(monkeypatch, **wrong) == (keys, True, ["everywhere"])


@pytest.mark.slow
def test_few_effects_are_searched_for_where_few_joints_are_off(monkeypatch):
    wrong = {"gain": (0.8, 1.0), "duration_s": 2.5}
    assert found(monkeypatch, **wrong) == ({"servo_gain@shoulder"}, False, [])

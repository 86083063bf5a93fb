from dataclasses import replace

import made_up_diagnoses as made_up
import pytest

from diagnosis.effects.library import BUILT_IN
from diagnosis.verdict import Estimate, Found, Verdict
from experiments.diagnosis_report.advice import advised
from experiments.diagnosis_report.page import write_report

RUB = Found(
    "coulomb_friction", "elbow", {"torque": Estimate(1.0, 0.9, 1.1, "N m")}, 0.9
)


@pytest.mark.parametrize("name", BUILT_IN)
def test_every_effect_says_what_to_do(name):
    advice = BUILT_IN[name].words.advice
    assert advice.endswith(".")
    assert 20 < len(advice) < 160


def test_advice_says_where_the_correction_is():
    (rub,) = advised(Verdict("effects", effects=(RUB,)))
    assert rub.about == "dry friction at the joint elbow"
    assert "rubs" in rub.robot
    assert "corrected.xml" in rub.sim
    (play,) = advised(Verdict("effects", effects=(made_up.PLAY,)))
    assert play.sim.startswith("Or let the sim have it. MuJoCo does not have it: ")
    assert "corrected_laws.py" in play.sim
    bumps = Found("uneven_ground", "world", {}, 0.9, native=False)
    (one,) = advised(Verdict("effects", effects=(bumps,)))
    assert one.sim.startswith("MuJoCo does not have it, and no file")


def test_the_same_at_many_places_is_one_advice():
    many = tuple(replace(RUB, place=f"joint_{k}") for k in range(4))
    (one,) = advised(Verdict("effects", effects=many))
    assert one.about == "dry friction at 4 places"


@pytest.mark.parametrize("kind", ["none", "unknown", "not_identifiable"])
def test_nothing_is_advised_about_what_is_not_established(kind, tmp_path):
    verdict = made_up.KINDS[kind]
    assert list(advised(verdict)) == []
    for one, there in ((verdict, False), (made_up.EFFECTS, True)):
        path = tmp_path / f"{there}.html"
        write_report(path, one, [], made_up.FACTS)
        assert ("What to do about it" in path.read_text()) == there

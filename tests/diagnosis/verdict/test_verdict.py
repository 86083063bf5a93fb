import dataclasses
import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from diagnosis import verdict as verdicts
from diagnosis.verdict import (
    Amount,
    ChannelFit,
    Estimate,
    Fit,
    Found,
    MismatchCell,
    NextExperiment,
    PlacedEffect,
    Recordings,
    Unexplained,
    ValueRange,
    Verdict,
    When,
)
from groundwalk.errors import BadValueError

DOCUMENT = Path(__file__).resolve().parents[3] / "docs" / "diagnosis_json.md"
KNEE = PlacedEffect("coulomb_friction", "knee")
PLAY = Found(
    "backlash",
    "knee",
    {"gap": Estimate(0.03, 0.027, 0.034, "rad")},
    0.97,
    (KNEE,),
    When("burst", 1.0, 2.5),
    native=False,
)
REST = Unexplained(
    share=0.4,
    channel="position.knee",
    unit="rad",
    against="velocity.knee",
    against_unit="rad/s",
    at=(0, 1),
    mean=(0.1, 0.2),
    spread=(0.01, 0.01),
)
CHANNEL = ChannelFit(nominal=5e-3, corrected=1e-3, floor=9e-4, unit="rad")
FULL = Verdict(
    "unknown",
    effects=(PLAY,),
    alternatives=((KNEE, PlacedEffect("command_latency", "commands")),),
    smallest_detectable={"drag@torso": Amount(0.5, "N s/m")},
    unexplained=REST,
    limits=("Only 15 Hz.",),
    mismatch=(
        MismatchCell("position.knee", "rad", 0.9, 5e-3, 9e-4, {"fast": 7.5}, ((1, 2),)),
    ),
    fit=Fit(
        nominal=5.5,
        corrected=1.1,
        floor=1.0,
        ceiling=1.05,
        wrong_place=5.0,
        channels={"position.knee": CHANNEL},
    ),
    next_experiment=NextExperiment("slow ramps", "knee", "tells them apart"),
    recordings=Recordings(("a",), ("b",), ("c", "d")),
    seconds=12.5,
)


@pytest.mark.parametrize(
    "verdict", [FULL, Verdict("none"), Verdict("effects", (PLAY,))]
)
def test_what_was_written_is_read_again(verdict):
    text = verdict.to_json()
    assert Verdict.from_json(text) == verdict
    assert Verdict.from_json(text).to_json() == text


def test_the_text_is_the_documented_one():
    plain = json.loads(FULL.to_json())
    assert plain["format"] == 1
    gap = {"value": 0.03, "low": 0.027, "high": 0.034, "unit": "rad"}
    unchecked = {"nominal": None, "recordings": {}, "starts": None}
    assert plain["effects"][0]["parameters"]["gap"] == gap | unchecked
    other = {"name": "coulomb_friction", "place": "knee"}
    assert plain["effects"][0]["confusable_with"] == [other]
    assert plain["mismatch"][0]["bursts"] == [[1, 2]]
    assert plain["fit"]["wrong_effect"] is None
    assert plain["fit"]["channels"]["position.knee"]["corrected"] == 1e-3


def test_numbers_of_numpy_become_numbers():
    gap = Estimate(np.float32(0.5), np.float64(0.25), np.int64(1), "rad")
    found = replace(PLAY, parameters={"gap": gap})
    plain = json.loads(Verdict("effects", (found,)).to_json())
    gap = {"value": 0.5, "low": 0.25, "high": 1.0, "unit": "rad"}
    assert plain["effects"][0]["parameters"]["gap"].items() >= gap.items()


def changed(path, value):
    """FULL as plain values, with one of them changed; a missing value is dropped."""
    plain = json.loads(FULL.to_json())
    inner = plain
    *way, last = path
    for step in way:
        inner = inner[step]
    if value is KeyError:
        del inner[last]
    else:
        inner[last] = value
    return json.dumps(plain)


EFFECT = ("effects", 0)


@pytest.mark.parametrize(
    ("path", "value", "words"),
    [
        (("format",), 2, "'format' is 2; only 1"),
        (("format",), True, "'format' is True"),
        (("fit",), KeyError, "has no 'fit'"),
        (("fits",), 1, "unknown key 'fits': did you mean 'fit'?"),
        (("kind",), "maybe", "kind must be effects or none"),
        (("kind",), "none", "must not name effects"),
        (("unexplained",), None, "must show 'unexplained'"),
        (("limits",), "text", "limits must be a list"),
        (("seconds",), "3", "seconds must be a finite number"),
        (("seconds",), float("nan"), "verdict is not JSON: NaN is no number"),
        (("smallest_detectable", "drag"), {"value": 1, "unit": "N"}, "'effect@place'"),
        ((*EFFECT, "probability"), 1.2, r"effects\[0\]: probability .* from 0 to 1"),
        ((*EFFECT, "probability"), True, "must be a finite number, not True"),
        ((*EFFECT, "native"), 1, "must be true or false"),
        ((*EFFECT, "place"), None, "must be text"),
        ((*EFFECT, "when", "start_s"), None, "needs start_s and end_s"),
        ((*EFFECT, "when", "end_s"), 0.5, "end_s must be .* from 1 up"),
        ((*EFFECT, "when", "kind"), "always", "has no start_s"),
        ((*EFFECT, "parameters", "gap", "low"), 0.031, "lie in its interval"),
        ((*EFFECT, "parameters", "gap", "units"), "rad", r"gap has an unknown key"),
        (("mismatch", 0, "bursts"), [[1, 2, 3]], "must be a list of 2"),
        (("mismatch", 0, "bursts"), [[2, 1]], "end of a burst"),
        (("mismatch", 0, "share"), -0.1, "share must be"),
        (("fit", "nominal"), -1, "nominal must be"),
        (("unexplained", "mean"), [0.1], "of one length, not 2, 1 and 2"),
    ],
)
def test_what_is_wrong_is_refused_in_one_line(path, value, words):
    assert Verdict.from_json(changed(("seconds",), 1.0)).seconds == 1.0
    with pytest.raises(BadValueError, match=words) as caught:
        Verdict.from_json(changed(path, value))
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("text", ["", "[]", "3", "{", '{"kind": "none"}'])
def test_what_is_no_verdict_is_refused(text):
    with pytest.raises(BadValueError, match="verdict"):
        Verdict.from_json(text)


@pytest.mark.parametrize("kind", ["effects", "unknown", "not_identifiable"])
def test_an_empty_answer_is_only_right_if_nothing_is_missing(kind):
    assert Verdict("none").effects == ()
    with pytest.raises(BadValueError, match=kind):
        Verdict(kind)


@pytest.mark.parametrize(
    "why", [{"limits": ("Nothing moved.",)}, {"alternatives": ((KNEE,),)}]
)
def test_what_is_not_identifiable_says_why(why):
    assert Verdict("not_identifiable", **why).kind == "not_identifiable"


def test_closed_is_the_part_of_the_excess_that_is_gone():
    fit = ChannelFit(nominal=5.0, corrected=2.0, floor=1.0, unit="rad")
    assert fit.closed(fit.corrected) == pytest.approx(3 / 4)
    assert fit.closed(5.0) == 0
    assert fit.closed(6.0) == pytest.approx(-1 / 4)
    assert fit.closed(None) is None
    flat = ChannelFit(nominal=1.0, corrected=1.0, floor=1.0, unit="rad")
    assert flat.closed(1.0) is None


def documented(text, name):
    return f"`{name}`" in text or f'"{name}"' in text


def test_every_field_is_documented():
    text = DOCUMENT.read_text()
    kinds = [part for part in vars(verdicts).values() if dataclasses.is_dataclass(part)]
    fields = [field for kind in kinds for field in dataclasses.fields(kind)]
    names = {field.name for field in fields if field.metadata.get("json", True)}
    assert {"kind", "low", "wrong_place", "spread", "bursts"} <= names
    assert [name for name in sorted(names) if not documented(text, name)] == []
    assert not documented(text, "wrong_plaice")


CHECKED = Estimate(
    *(0.03, 0.027, 0.034, "rad"),
    nominal=0.0,
    recordings={"a": ValueRange(0.031, 0.028, 0.034), "b": ValueRange(0.02, 0.0, 0.05)},
    starts=(0.0299, 0.0301),
)


def test_how_a_value_was_checked_is_kept():
    verdict = Verdict(
        "effects", (replace(PLAY, parameters={"gap": CHECKED}),), tried=93
    )
    assert Verdict.from_json(verdict.to_json()) == verdict
    plain = json.loads(verdict.to_json())
    own = plain["effects"][0]["parameters"]["gap"]
    assert own["recordings"]["a"] == {"value": 0.031, "low": 0.028, "high": 0.034}
    assert (own["nominal"], own["starts"]) == (0.0, [0.0299, 0.0301])
    own["recordings"]["a"]["low"] = 0.04
    with pytest.raises(BadValueError, match="must lie in its interval"):
        Verdict.from_json(json.dumps(plain))


def test_verdicts_of_before_values_were_checked_are_read():
    verdict = Verdict("effects", effects=(PLAY,))
    plain = json.loads(verdict.to_json())
    del plain["tried"]
    for key in ("nominal", "recordings", "starts"):
        del plain["effects"][0]["parameters"]["gap"][key]
    assert Verdict.from_json(json.dumps(plain)) == verdict


def test_verdicts_of_before_values_were_shared_are_read():
    verdict = Verdict("effects", effects=(PLAY,))
    plain = json.loads(verdict.to_json())
    del plain["effects"][0]["shared_with"]
    assert Verdict.from_json(json.dumps(plain)) == verdict
    for wrong in (3, [3], [None]):
        with pytest.raises(BadValueError):
            Verdict.from_json(json.dumps(plain | {"effects": wrong}))

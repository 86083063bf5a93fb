"""A made-up result on the page and on the console."""

from dataclasses import replace

import pytest

from diagnosis.verdict import PlacedEffect
from experiments.prediction.page import (
    by_size,
    console_lines,
    doubts_of,
    interval_sentence,
    limits_of,
    promise_sentence,
    rows_of,
)
from experiments.prediction.result import (
    Errors,
    Interval,
    PredictionResult,
    Promise,
    Recorded,
)
from groundwalk.errors import BadValueError

JOINTS = [f"joint_{k}" for k in range(1, 16)]
CHANNELS = {
    f"position.{joint}": Errors(0.002 * k, 0.002, 0.001, "rad", float(k), 0.9 * k, 2.0)
    for k, joint in enumerate(JOINTS, 1)
}
TOGETHER = Errors(12.0, 3.0, 1.0, "noise floors", 4.0, 3.1, 5.2)
RESULT = PredictionResult(
    judgement="holds",
    sentence="holds: the corrected sim's error is 4.0 times smaller",
    robot="arm",
    base="fixed",
    verdict="effects",
    effects=(PlacedEffect("coulomb_friction", "joint_15"),),
    left_out=(),
    together=TOGETHER,
    channels=CHANNELS,
    interval=Interval(0.95, "blocks of time", 23),
    promise=Promise(10.0, 2.0, 5.0),
    recordings=(
        Recorded("good", False, 4.0, TOGETHER, CHANNELS),
        Recorded("bad", False, 4.0, replace(TOGETHER, ratio=0.5), CHANNELS),
        Recorded("old", True),
    ),
    limits=(),
)


def test_json_and_back():
    assert PredictionResult.from_json(RESULT.to_json()) == RESULT
    with pytest.raises(BadValueError, match="judgment"):
        PredictionResult.from_json(RESULT.to_json().replace("judgement", "judgment"))


def test_the_worst_channel_comes_first_and_few_are_on_the_console():
    assert by_size(RESULT)[0][0] == "position.joint_15"
    every, some = rows_of(RESULT), rows_of(RESULT, 12)
    assert every[0] == (
        "all channels", "12.0", "3.0", "1.0", "noise floors", "4.0", "3.1 to 5.2",
    )  # fmt: skip
    assert every[1][:6] == ("position.joint_15", "30.0", "2.0", "1.0", "mrad", "15")
    assert len(every) == 1 + 15 + 3
    assert some[13][0] == "3 more in the report"
    assert len(some) == 1 + 12 + 1 + 3


def test_the_console_says_what_was_left_out_and_what_contradicts():
    lines = dict(console_lines(RESULT))
    assert lines["judgement"] == RESULT.sentence
    assert "larger: bad (ratio 0.50)" in lines["but"]
    assert lines["used"] == "old was used by the diagnosis: not counted"
    assert "limits" not in lines
    good = replace(RESULT, recordings=RESULT.recordings[:1])
    assert {"but", "used"} & set(dict(console_lines(good))) == set()


def test_error_that_is_left_beyond_what_was_promised_is_a_doubt():
    """The promise is twice the noise floor, three times are left; then four."""
    good = replace(RESULT, recordings=())
    assert doubts_of(good) == []
    far = replace(good, together=replace(TOGETHER, corrected=4.0))
    (said,) = doubts_of(far)
    assert "leaves 4.0 times the noise floor here, 2.0 times as much" in said


def test_what_the_diagnosis_promised():
    assert "was 5.0 times the corrected sim's" in promise_sentence(RESULT)
    assert "promised no number" in promise_sentence(replace(RESULT, promise=None))


def test_what_an_interval_holds_for():
    assert "23 blocks of time" in interval_sentence(RESULT)
    by_recording = replace(RESULT, interval=Interval(0.95, "recordings", 7))
    assert "more recordings like these" in interval_sentence(by_recording)


def test_limits():
    event = PlacedEffect("external_force", "torso")
    said = limits_of(replace(RESULT, verdict="unknown", left_out=(event,)))
    assert "none of them is established" in said[0]
    assert "of one recording only" in said[-1]
    assert limits_of(RESULT) == []

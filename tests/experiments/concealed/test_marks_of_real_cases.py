"""How answers to doctored real recordings are marked."""

import pytest
from made_up_scores import DRY, HIP, NOTHING, RIGHT, UNKNOWN, UNSURE, found, names

from experiments.concealed.scoring.answers import Answer, read_answer
from experiments.concealed.scoring.marks import mark
from experiments.concealed.scoring.truth import TrueCase, TrueEffect

SWAPPED = TrueEffect("joints_swapped", "a, b", {})
WORDS = ("swapped", "a", "b")
ELSE = found("viscous_friction", HIP)


def marked(kind, effects, verdict, **more):
    case = TrueCase("so101", "real", kind, effects, **more)
    answer = verdict if isinstance(verdict, Answer) else read_answer(verdict.to_json())
    return mark(case, answer, None, "diagnosis")


@pytest.mark.parametrize(
    ("answer", "right"),
    [
        (UNKNOWN, True),
        (UNSURE, True),
        (Answer("refused", limits=("b follows a: are joints swapped?",)), True),
        (Answer("refused", limits=("are joints swapped?", "a and b rest")), False),
        (Answer("refused", limits=("the recording is too short",)), False),
        (NOTHING, False),
        (names(RIGHT), False),
    ],
)
def test_outside_the_library_a_doubt_or_the_right_refusal_is_right(answer, right):
    case = {"refusal": WORDS, "nats": (300.0,)}
    assert marked("outside", (SWAPPED,), answer, **case).right == right


def test_a_refusal_is_not_right_where_the_truth_names_no_words():
    answer = Answer("refused", limits=("are joints swapped? a b",))
    assert not marked("outside", (SWAPPED,), answer).right
    assert not marked("none", (), answer, refusal=WORDS).right


def test_of_what_hardly_shows_nothing_need_be_said():
    faint = {"refusal": WORDS, "nats": (3.0,)}
    for answer, right in ((NOTHING, True), (UNKNOWN, True), (names(RIGHT), False)):
        assert marked("outside", (SWAPPED,), answer, **faint).right == right


def test_what_is_named_beside_the_true_effect_is_wrong():
    one = marked("single", (DRY,), names(ELSE, RIGHT))
    assert (one.right, one.top1, one.hits, one.extra) == (False, False, 1, 1)

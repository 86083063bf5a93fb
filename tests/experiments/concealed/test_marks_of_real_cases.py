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
    assert marked("outside", (SWAPPED,), answer, refusal=WORDS).right == right


def test_a_refusal_is_not_right_where_the_truth_names_no_words():
    answer = Answer("refused", limits=("are joints swapped? a b",))
    assert not marked("outside", (SWAPPED,), answer).right
    assert not marked("none", (), answer, refusal=WORDS).right


def test_what_else_is_missing_counts_nowhere_beside_the_true_effect():
    both = names(ELSE, RIGHT)
    one = marked("single", (DRY,), both, else_missing=True)
    assert (one.right, one.top1, one.hits, one.extra) == (True, True, 1, 0)
    strict = marked("single", (DRY,), both)
    assert (strict.right, strict.top1, strict.extra) == (False, False, 1)


def test_other_effects_alone_stay_wrong_where_more_is_missing():
    one = marked("single", (DRY,), names(ELSE), else_missing=True)
    assert (one.right, one.top1, one.extra, one.missed) == (False, False, 1, 1)
    elsewhere = names(found("coulomb_friction", HIP))
    one = marked("single", (DRY,), elsewhere, else_missing=True)
    assert (one.right, one.places) == (False, (False,))

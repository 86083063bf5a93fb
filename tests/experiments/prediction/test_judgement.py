"""A judgement follows from an interval, and a line says it."""

import pytest

from diagnosis.conclude.error_ratio import Ratio
from experiments.prediction.judgement import exceptions, judge, judgement_line


@pytest.mark.parametrize(
    ("ratio", "nominal", "word", "said"),
    [
        ((7.1, 5.0, 9.3), 20.0, "holds", "7.1 times smaller than the sim's (95 % int"),
        ((1.2, 1.01, 1.5), 5.0, "holds", "1.20 times smaller than the sim's (95 % int"),
        ((1.02, 1.01, 1.03), 5.0, "does not hold", "hardly smaller"),
        ((1.02, 1.01, 1.03), 1.05, "undecided", "hardly show what the sim lacks"),
        ((2.0, 0.8, 4.0), 20.0, "undecided", "more recordings would tell"),
        ((1.0, 0.97, 1.03), 1.05, "undecided", "hardly show what the sim lacks"),
        (
            (1.0, 0.97, 1.03),
            5.0,
            "does not hold",
            "the ratio of the sim's to it is 1.00",
        ),
        ((0.5, 0.4, 0.8), 5.0, "does not hold", "2.0 times the sim's (95 % interval"),
        ((0.5, 0.4, 0.8), 1.0, "does not hold", "1.25 to 2.5)"),
    ],
)
def test_a_judgement_and_its_line(ratio, nominal, word, said):
    assert judge(Ratio(*ratio), nominal) == word
    line = judgement_line(Ratio(*ratio), nominal)
    assert line.startswith(f"{word}: ")
    assert said in line
    assert "\n" not in line


def test_recordings_that_say_otherwise_are_named():
    ratios = {"a": 7.0, "b": 0.5, "c": 1.0}
    assert "larger: b (ratio 0.50)" in exceptions("holds", ratios)
    assert "smaller: a (ratio 7.0)" in exceptions("does not hold", ratios)
    assert exceptions("holds", {"a": 7.0, "c": 1.0}) == ""
    assert exceptions("undecided", {"c": 1.0}) == ""

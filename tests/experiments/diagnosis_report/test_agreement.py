"""How values were checked, as the report says it."""

import html
from dataclasses import replace

import made_up_diagnoses as made_up
import numpy as np
import pytest
from html_page import Page

from diagnosis.conclude.estimates import Z_80
from diagnosis.verdict import Estimate, ValueRange
from experiments.diagnosis_report.agreement import agree, checked
from experiments.diagnosis_report.page import write_report

PLAY = made_up.ONE.effects[0]


def said(values, error=0.001):
    """What recordings say alone: values with the same standard error."""
    half = Z_80 * error
    return {
        f"r{k}": ValueRange(one, one - half, one + half) for k, one in enumerate(values)
    }


def estimate(values, **more):
    return Estimate(0.03, 0.027, 0.034, "rad", 0.0, said(values), **more)


def test_recordings_agree_as_often_as_the_level_says():
    rng = np.random.default_rng(1)
    draws = 0.03 + 0.001 * rng.standard_normal((400, 5))
    draws += 0.03 - draws.mean(axis=1, keepdims=True)  # the value is their mean
    agreed = sum(agree(estimate(list(row))) for row in draws)
    assert 385 <= agreed <= 400
    apart = draws + np.array([0.01, 0, 0, 0, -0.01])
    assert not any(agree(estimate(list(row))) for row in apart)


def test_a_recording_beyond_a_bound_decides_nothing():
    own = estimate([0.0295, 0.0305])
    beyond = {**own.recordings, "far": ValueRange(0.0, 0.0, 0.0)}
    assert agree(replace(own, recordings=beyond))
    apart = estimate([0.02, 0.04])
    assert not agree(
        replace(apart, recordings={**apart.recordings, "far": beyond["far"]})
    )


def test_a_single_recording_agrees_with_nothing():
    assert agree(estimate([0.03])) is None
    assert agree(estimate([])) is None


@pytest.mark.parametrize(
    ("values", "words"),
    [
        ([0.0292, 0.0308], "0.029 to 0.031 rad: 2 agree"),
        ([0.02, 0.04, 0.03], "0.020 to 0.040 rad: 3 differ by more than their errors"),
        ([], "\N{EN DASH}"),
    ],
)
def test_the_table_says_whether_they_agree(values, words):
    effect = replace(PLAY, parameters={"gap": estimate(values, starts=(0.029, 0.031))})
    (row,) = checked([effect])
    assert row["alone"] == words
    assert row["starts"] == "0.029 to 0.031 rad"
    assert row["nominal"] == "0 rad"
    assert [name for name, _ in row["recordings"]] == [*said(values)]


def test_what_is_infinite_or_unknown_is_a_dash():
    bare = Estimate(120.0, 100.0, 140.0, "N m/rad")
    (row,) = checked([replace(PLAY, parameters={"stiffness": bare})])
    assert (row["nominal"], row["alone"], row["starts"]) == ("\N{EN DASH}",) * 3


def test_the_page_has_the_table(tmp_path):
    own = estimate([0.0292, 0.0308], starts=(0.03, 0.03))
    effect = replace(PLAY, parameters={"gap": own})
    path = tmp_path / "report.html"
    verdict = replace(made_up.ONE, effects=(effect,), tried=93)
    write_report(path, verdict, [], made_up.FACTS)
    page = Page(path.read_text())
    assert (page.open, page.wrong) == ([], [])
    text = html.unescape(page.text)
    assert "How the values were checked" in text
    assert "0.029 to 0.031 rad: 2 agree" in text
    assert "93 effects at their places were compared" in text
    assert "What each recording says alone" in text
    write_report(path, made_up.ONE, [], made_up.FACTS)
    assert "What each recording says alone" not in path.read_text()

import html
import re
from dataclasses import replace

import made_up_diagnoses as made_up
import pytest
from html_page import Page

from diagnosis.seen import Curve, Delay, Seen, SeenJoint, Share
from diagnosis.verdict import NextExperiment
from experiments.diagnosis_report.figure_style import CORRECTED, slim
from experiments.diagnosis_report.joints_shown import MOST_FIGURES
from experiments.diagnosis_report.page import write_report

AT = (-2.0, -1.0, -0.5, 0.5, 1.0, 2.0)
SPEED = Curve(
    "speed", "both", "speed", "rad/s", "N m", AT,
    (-0.3, -0.3, -0.3, 0.3, 0.3, 0.3),
    (-0.4, -0.4, -0.4, 0.2, 0.2, 0.2),
    (-0.2, -0.2, -0.2, 0.4, 0.4, 0.4),
)  # fmt: skip
KNEE = SeenJoint(
    "knee",
    "servo",
    loss_rms=0.31,
    needed_rms=1.2,
    stiffness=20.0,
    curves=(
        SPEED,
        replace(SPEED, kind="position", way="forward", over="position"),
        replace(SPEED, kind="error", way="backward", unit="rad"),
    ),
    shares=(Share("sign of speed", 0.93, 0.41), Share("load", 0.0, 0.0)),
    together=0.95,
    noise_share=0.02,
    delay=Delay(0.0441, 0.042, 0.046, {"a": 0.0441}),
)
UNKNOWN = SeenJoint("hip", "unknown", ("Its torque is <unknown>.",))
SEEN = Seen((KNEE, UNKNOWN), ("a", "b", "c"), "recordings", 8.0)


def report(folder, seen):
    path = folder / "report.html"
    write_report(path, made_up.ONE, [], made_up.FACTS, seen)
    return path.read_text()


def test_the_section_shows_each_joint(tmp_path):
    text = report(tmp_path, SEEN)
    page = Page(text)
    assert (page.open, page.wrong) == ([], [])
    assert len(page.ids) == len(set(page.ids))
    said = html.unescape(page.text)
    for words in (
        "What each joint shows",
        "below 8 Hz",
        "medians over 3 recordings",
        "sign of speed (93 %)",
        "44.1 ms (42 to 46)",
        "0.31 N m",
        "loss torque over speed",
        "Bars, grey",
    ):
        assert words in said
    assert re.findall(r"url\((?!#)[^)]*\)|<script|<img", text) == []


def test_each_joint_has_what_was_found_there(tmp_path):
    at_knee = replace(made_up.ONE.effects[0], place="knee")
    step = NextExperiment("ramps", "knee", "they tell friction from play.")
    path = tmp_path / "report.html"
    verdict = replace(made_up.ONE, effects=(at_knee,), next_experiment=step)
    hip = replace(KNEE, joint="hip", loss_rms=0.1)
    seen = replace(SEEN, joints=(KNEE, hip))
    write_report(path, verdict, [], made_up.FACTS, seen)
    text = html.unescape(path.read_text())
    knee, rest = text.split("<h3>knee: loss torque")[1].split("<h3>hip: loss torque")
    assert "knee has play of about 0.030 rad" in knee
    assert "% sure" in knee
    assert "What would tell: Record ramps of the joint knee" in knee
    assert "No effect was found at this joint itself." in rest
    assert "play of about" not in rest.split("</figure>")[0]


def test_it_says_what_is_not_known(tmp_path):
    said = html.unescape(Page(report(tmp_path, SEEN)).text)
    assert "hip: Its torque is <unknown>." in said
    assert "hip not known \N{EN DASH} \N{EN DASH} \N{EN DASH}" in said
    assert "knee: Its torque" not in said


def test_without_any_torque_only_delays_are_shown(tmp_path):
    nothing = Seen((UNKNOWN,), ("a",), "blocks")
    text = report(tmp_path, nothing)
    assert "only how late the joints follow" in text
    assert "Bars, grey" not in text
    assert 'aria-label="loss torque' not in text


def test_a_report_may_lack_the_section(tmp_path):
    assert "What each joint shows" not in report(tmp_path, None)


def test_the_law_is_drawn_in_its_own_colour(tmp_path):
    law = replace(KNEE, curves=(replace(SPEED, law=SPEED.middle),))
    shown = [report(tmp_path, replace(SEEN, joints=(one,))) for one in (KNEE, law)]
    figures = [
        re.search(r'<svg role="img" aria-label="loss torque.*?</svg>', one, re.DOTALL)[
            0
        ]
        for one in shown
    ]
    assert [CORRECTED in one for one in figures] == [False, True]
    assert ["what was found" in one for one in figures] == [False, True]


def test_a_robot_of_many_joints_is_drawn_in_part(tmp_path):
    joints = tuple(
        replace(KNEE, joint=f"joint {k}", loss_rms=0.1 * k) for k in range(1, 11)
    )
    text = report(tmp_path, replace(SEEN, joints=joints))
    assert text.count('aria-label="loss torque') == MOST_FIGURES
    assert "2 more joints have smaller loss torques" in text
    assert "joint 1: loss" not in text
    assert len(text) < 500_000


def test_the_same_joints_make_the_same_page(tmp_path):
    assert report(tmp_path, SEEN) == report(tmp_path, SEEN)


@pytest.mark.parametrize(
    ("others", "named"), [(0.95, "sign of speed (93 %)"), (1.0, "sign of speed")]
)
def test_joints_that_move_together_are_not_named(tmp_path, others, named):
    shares = (*KNEE.shares, Share("other joints", others, 0.0))
    knee = replace(KNEE, shares=shares)
    assert named in Page(report(tmp_path, replace(SEEN, joints=(knee,)))).text
    weak = replace(knee, shares=(Share("load", 0.2, 0), shares[-1]))
    said = Page(report(tmp_path, replace(SEEN, joints=(weak,)))).text
    assert "other joints (" in said


@pytest.mark.parametrize(
    "joint",
    [
        replace(KNEE, curves=KNEE.curves[:1], shares=(), together=None),
        replace(KNEE, noise_share=None, stiffness=None, delay=None),
        replace(KNEE, joint="<b>&'\""),
    ],
)
def test_a_joint_may_show_less(tmp_path, joint):
    page = Page(report(tmp_path, replace(SEEN, joints=(joint,))))
    assert (page.open, page.wrong) == ([], [])


def test_a_slim_figure_keeps_its_places():
    style = "font-family: 'A', sans-serif; fill: #111"
    svg = f'<text style="{style}" x="1.23456">0.1</text>'
    assert slim(svg) == '<text style=" fill: #111" x="1.23">0.1</text>'

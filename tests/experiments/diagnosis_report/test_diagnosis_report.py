import dataclasses
import html
import re

import made_up_diagnoses as made_up
import numpy as np
import pytest
from html_page import Page

from diagnosis.verdict import (
    ChannelFit,
    Estimate,
    Fit,
    Found,
    MismatchCell,
    Verdict,
)
from experiments.diagnosis_report.page import write_report
from groundwalk.errors import UnknownNameError


def report(folder, verdict, series=(), facts=made_up.FACTS):
    path = folder / "new" / "report.html"
    write_report(path, verdict, series, facts)
    return path.read_text()


@pytest.fixture(scope="module")
def pages(tmp_path_factory):
    folder = tmp_path_factory.mktemp("reports")
    held_out = [made_up.series(), made_up.series("air_steps_1", seed=4)]
    return {k: report(folder, v, held_out) for k, v in made_up.KINDS.items()}


@pytest.mark.parametrize("kind", made_up.KINDS)
def test_a_page_is_whole_and_needs_nothing_else(pages, kind):
    page = Page(pages[kind])
    assert (page.open, page.wrong) == ([], [])
    assert sorted(page.ids) == sorted(set(page.ids))
    assert len(page.ids) > 5
    beside = [link for link in page.links if not link.startswith("#")]
    assert set(beside) == set(made_up.FACTS.files)
    assert {link[1:] for link in page.links if link.startswith("#")} <= set(page.ids)
    fetched = re.findall(r"url\((?!#)[^)]*\)|@import|<script|<link|<img", pages[kind])
    assert fetched == []


def test_tags_that_do_not_match_are_seen():
    assert Page("<p><b>x</p>").wrong == ["p"]
    assert Page("<p>").open == ["p"]


@pytest.mark.parametrize(
    ("kind", "says", "does_not_say"),
    [
        (
            "effects",
            [
                "The left knee (LKneePitch) has play of about 0.030 rad "
                "(0.027 to 0.034) that the sim lacks.",
                "Commands take effect about 18.3 ms (17.5 to 19.0) later",
                "falls from 5.1 to 1.2 mrad; the noise floor is 0.9.",
                "97 % sure; the recordings do not rule out dry friction at the left "
                "knee (LKneePitch) instead.",
                "Record slow ramps with reversals of the left knee",
                "MuJoCo does not have it: corrected_laws.py adds it before each step.",
                "rotor inertia below 0.002 kg m²",
                "halving it changes 0.04 mrad",
                "control: the same effect at another place",
                "corrected sim",
                "3 more channels",
                "large errors",
            ],
            ["Nothing is missing", "smallest effects", "What no effect explains"],
        ),
        (
            "none",
            [
                "Nothing is missing that these recordings could show.",
                "play (backlash) the left knee (LKneePitch) 0.0042 rad",
                "late commands commands 0.60 ms",
                "no limits worth naming",
            ],
            ["What was found", "control:", "corrected sim", "falls from"],
        ),
        (
            "unknown",
            [
                "Something is missing that no effect known here explains.",
                "41 % of the squared error above the noise is left",
                "Besides, commands take effect",
                "What no effect explains",
            ],
            ["Nothing is missing", "equally well"],
        ),
        (
            "not_identifiable",
            [
                "these recordings fit several explanations equally well: extra mass at "
                "the left tibia (LTibia); or servo stiffness at the left knee "
                "(LKneePitch); or tilt together with encoder offset at the left hip",
                "No answer stands out",
                "Record static holds at mirrored poses: a mass",
            ],
            ["What was found", "control:", "falls from"],
        ),
    ],
)
def test_the_words_fit_the_kind(pages, kind, says, does_not_say):
    text = html.unescape(Page(pages[kind]).text)
    assert [words for words in says if words not in text] == []
    assert [words for words in does_not_say if words in text] == []


def test_the_answer_comes_first(pages):
    text = Page(pages["effects"]).text
    order = [
        "has play of",
        "else could it be",
        "was found",
        "is off",
        "Before and after",
    ]
    places = [text.index(words) for words in (*order, "cannot tell", "was made")]
    assert places == sorted(places)


def test_the_table_holds_every_error(tmp_path):
    text = Page(report(tmp_path, made_up.EFFECTS)).text
    channel = made_up.EFFECTS.fit.channels[made_up.WORST]
    names = ("floor", "ceiling", "wrong_place", "wrong_effect")
    numbers = " ".join(f"{1e3 * getattr(channel, name):.1f}" for name in names)
    closed = (channel.nominal - channel.corrected) / (channel.nominal - channel.floor)
    assert f"LKneePitch 5.1 1.2 {100 * closed:.0f} % {numbers} mrad" in text


def test_an_error_below_the_noise_floor_closes_all_and_no_more(tmp_path):
    below = dataclasses.replace(made_up.fit(), corrected=0.7)
    verdict = dataclasses.replace(made_up.ONE, fit=below)
    text = Page(report(tmp_path, verdict)).text
    assert "all channels 5.7 0.7 100 % 1.0" in text
    assert "no error above the noise floor is left" in text


def test_the_noise_floor_is_explained(tmp_path):
    text = Page(report(tmp_path, made_up.ONE)).text
    assert "the noise measured in these recordings (audit.json)" in text
    assert "the error of the simulation itself" in text
    assert "noise alone makes" not in text


def test_what_was_not_computed_is_a_dash(tmp_path):
    fit = dataclasses.replace(made_up.EFFECTS.fit, ceiling=None, wrong_place=None)
    verdict = dataclasses.replace(made_up.ONE, fit=fit)
    text = Page(report(tmp_path, verdict)).text
    assert "5.7 1.3 94 % 1.0 \N{EN DASH} \N{EN DASH} 4.6 noise floors" in text
    assert "control: the same effect" not in text
    assert "control: another effect at this place" in text


def test_it_can_be_asked_what_has_changed(tmp_path):
    facts = dataclasses.replace(made_up.FACTS, changed=True)
    text = Page(report(tmp_path, made_up.ONE, facts=facts)).text
    assert "What has changed about nao since the reference" in text
    assert "that was not there before." in text
    assert "that the sim lacks" not in text


@pytest.mark.parametrize(
    "verdict",
    [
        Verdict("none"),
        Verdict("effects", (made_up.PUSH,)),
        Verdict("not_identifiable", limits=("Nothing moved.",)),
        Verdict("none", fit=Fit(nominal=1, corrected=1, floor=1, channels={})),
        dataclasses.replace(made_up.UNKNOWN, fit=None, mismatch=()),
    ],
)
def test_a_verdict_may_be_bare(tmp_path, verdict):
    page = Page(report(tmp_path, verdict))
    assert (page.open, page.wrong) == ([], [])
    assert ("12.3 to 12.6 s" in page.text) == (made_up.PUSH in verdict.effects)


def test_names_cannot_break_the_page(tmp_path):
    bad = "<b>&'\""
    facts = dataclasses.replace(made_up.FACTS, robot=bad, settings={bad: bad})
    limited = dataclasses.replace(made_up.NONE, limits=(bad,))
    text = report(tmp_path, limited, [made_up.series(bad)], facts)
    page = Page(text)
    assert (page.open, page.wrong) == ([], [])
    assert bad not in text
    assert page.texts.count(bad) >= 3


def test_the_same_verdict_makes_the_same_page(tmp_path, pages):
    held_out = [made_up.series(), made_up.series("air_steps_1", seed=4)]
    assert report(tmp_path, made_up.EFFECTS, held_out) == pages["effects"]
    assert report(tmp_path, made_up.ONE, held_out) != pages["effects"]


def test_missing_values_leave_gaps(tmp_path):
    series = made_up.series(joints=("LKneePitch",))
    real = series.channels[made_up.WORST].real.copy()
    real[100:900] = np.nan
    channel = series.channels[made_up.WORST]._replace(real=real)
    gappy = dataclasses.replace(series, channels={made_up.WORST: channel})
    page = Page(report(tmp_path, made_up.EFFECTS, [gappy]))
    assert (page.open, page.wrong) == ([], [])


def test_an_effect_without_words_is_refused(tmp_path):
    odd = Found("gremlins", "knee", {"size": Estimate(1, 1, 1, "m")}, 0.5)
    with pytest.raises(UnknownNameError, match="effect 'gremlins'"):
        report(tmp_path, Verdict("effects", (odd,)))
    assert not (tmp_path / "new").exists()


@pytest.mark.parametrize(
    "cell",
    [
        MismatchCell("gyroscope.x", "rad/s", 1.0, 0.5, 0.0, {}),
        MismatchCell("gyroscope.x", "rad/s", 0.0, 0.0, 0.1, {"fast": 0.0}),
        MismatchCell("gyroscope.x", "rad/s", 1.0, 0.5, 0.1, {}, ((3.0, 3.0),)),
    ],
)
def test_a_mismatch_may_be_of_any_shape(tmp_path, cell):
    silent = ChannelFit(nominal=0.5, corrected=0.5, floor=0.0, unit="rad/s")
    fit = Fit(nominal=5, corrected=5, floor=1, channels={cell.channel: silent})
    verdict = Verdict("none", mismatch=(cell,), fit=fit)
    short = made_up.series(duration_s=0.03, joints=("elbow",))
    page = Page(report(tmp_path, verdict, [short]))
    assert (page.open, page.wrong) == ([], [])
    assert cell.channel in page.texts
    assert ("Dark cells" in page.text) == bool(cell.regimes)
    assert ("times at which the error stands out" in page.text) == bool(cell.bursts)

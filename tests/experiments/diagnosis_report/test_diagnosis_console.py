import dataclasses
from pathlib import Path

import made_up_diagnoses as made_up
import pytest

from diagnosis.verdict import Verdict
from experiments.diagnosis_report.console import console_lines, print_verdict

FILES = [Path("out/report.html"), Path("out/diagnosis.json"), Path("out/overlay.rrd")]


def lines(verdict):
    return console_lines(verdict, FILES)


def text_of(verdict):
    return "\n".join(text for _, text in lines(verdict))


@pytest.mark.parametrize("kind", made_up.KINDS)
def test_ten_lines_or_fewer_with_no_break_in_them(kind):
    verdict = made_up.KINDS[kind]
    if kind in ("effects", "unknown"):
        three = (made_up.PLAY, made_up.LATENCY, made_up.PUSH)
        verdict = dataclasses.replace(verdict, effects=three, limits=("a", "b"))
    shown = lines(verdict)
    assert 3 <= len(shown) <= 10
    assert all(text and "\n" not in text for _, text in shown)
    assert shown[-1] == ("files", "out/report.html out/diagnosis.json out/overlay.rrd")


def test_effects_have_place_value_interval_and_doubt():
    text = text_of(made_up.EFFECTS)
    assert "play (backlash) at the left knee (LKneePitch)" in text
    assert "gap 0.030 rad (0.027 to 0.034); 97 % sure" in text
    assert "5.1 -> 1.2 mrad, noise floor 0.9" in text
    assert "all channels 5.7 -> 1.3 times the noise floor; instead of it the" in text
    assert "the same effect at another place 5.5, another effect at this place" in text
    assert "also fit dry friction at the left knee" in text
    assert "Record slow ramps" in text
    assert "(and 1 more)" in text
    assert "do not rule out dry friction" in text_of(made_up.ONE)


def test_other_kinds_claim_nothing():
    none, unknown, open_ = (
        text_of(made_up.KINDS[kind]) for kind in ("none", "unknown", "not_identifiable")
    )
    assert "as large as play (backlash) at the left knee" in none
    assert "unknown physics: 41 % of the squared error" in unknown
    assert "recordings fit extra mass at the left tibia (LTibia); or" in open_
    assert "->" not in none + open_
    assert "sure" not in none + open_


def test_controls_that_were_not_computed_are_not_told():
    fit = dataclasses.replace(made_up.EFFECTS.fit, wrong_place=None, ceiling=None)
    text = text_of(dataclasses.replace(made_up.EFFECTS, fit=fit))
    assert "instead of it another effect at this place 4.6" in text
    assert "another place" not in text
    assert "regression" not in text
    bare = dataclasses.replace(fit, wrong_effect=None)
    assert "instead" not in text_of(dataclasses.replace(made_up.NONE, fit=bare))


def test_printed_lines_are_plain_in_a_pipe(capsys):
    print_verdict(Verdict("not_identifiable", limits=("Nothing [b]moved[/b].",)), FILES)
    printed = capsys.readouterr().out.splitlines()
    assert printed == [
        "verdict     these data cannot tell",
        "limits      Nothing [b]moved[/b]",
        "files       out/report.html out/diagnosis.json out/overlay.rrd",
    ]


def test_a_terminal_gets_the_same_words(capsys, monkeypatch):
    monkeypatch.setenv("COLUMNS", "300")
    monkeypatch.setattr("sys.stdout.isatty", lambda: True)
    print_verdict(Verdict("not_identifiable", limits=("Nothing [b]moved[/b].",)), FILES)
    printed = capsys.readouterr().out
    assert "these data cannot tell" in printed
    assert "Nothing [b]moved[/b]" in printed


def test_effects_at_many_places_take_one_line_and_few_doubts_are_told():
    (known,) = made_up.ONE.effects
    alike = tuple(dataclasses.replace(known, place=place) for place in "ABC")
    text = text_of(dataclasses.replace(made_up.ONE, effects=alike))
    assert "play (backlash) at 3 places, gap from about 0.0304 rad" in text
    assert text.count("do not rule out") == 2
    assert "And 1 more." in text
    assert "And" not in text_of(dataclasses.replace(made_up.ONE, effects=alike[:2]))


def test_who_is_sure_has_no_doubts():
    (known,) = made_up.ONE.effects
    sure = dataclasses.replace(known, confusable_with=())
    shown = lines(dataclasses.replace(made_up.ONE, effects=(sure,), alternatives=()))
    assert "doubt" not in [label for label, _ in shown]
    assert "doubt" in [label for label, _ in lines(made_up.ONE)]

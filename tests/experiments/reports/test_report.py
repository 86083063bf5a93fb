"""Pages of all verbs: one content, two forms, and nothing from outside."""

import base64
import os
import re
import sys
from pathlib import Path

import pytest
from html_page import Page
from made_up_runs import history

from experiments.diagnose import Diagnose
from experiments.evaluate import Evaluate
from experiments.optimize_gait import OptimizeGait
from experiments.reports.origin import Origin
from experiments.reports.report import (
    Report,
    body_html,
    markdown_table,
    sentence_html,
    write_figure,
)
from experiments.runs.folder import RunFolder
from experiments.runs.options import repeat_command
from experiments.seeing.run_pictures import search_figure
from experiments.seeing.score_page import score_answer, write_page
from experiments.transfer.claims import Claim, claims_answer, write_transfer_page
from experiments.transfer.nao_studies.page import answer_of
from experiments.transfer.nao_studies.study import TransferNao
from groundwalk.errors import RunFolderError
from walk_engine import gaits

FETCHES = (
    r"""(?:src|href|data)=["'](?!data:|#)|url\((?!#)|@import|<script|<link|<iframe"""
)
PIXEL = base64.b64decode(
    "iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAYAAAAfFcSJAAAADUlEQVR42mNk+M9QDwADhgGAWjR9"
    "awAAAABJRU5ErkJggg=="
)


def score(speed_cm_s, falls, trials=10):
    return {
        "speed_cm_s": speed_cm_s,
        "speed_std": 1.0,
        "falls": falls,
        "trials": trials,
    }


SCORES = {
    "sim": {"start": score(22.8, 0), "tuned": score(31.0, 0)},
    "real": {"start": score(20.0, 1), "tuned": score(14.4, 9)},
}


@pytest.fixture(scope="module")
def tuned(tmp_path_factory):
    """A run of optimize-gait as far as its page sees it."""
    path = tmp_path_factory.mktemp("runs") / "tuned"
    folder = RunFolder.create("optimize-gait", OptimizeGait(population=8, out=path))
    folder.write_json("result.json", {**SCORES, "gait": dict(gaits.get("walk2014"))})
    write_figure(search_figure(history(3)), path / "search.png")
    write_page(folder, "Does it <walk>?", SCORES, {"start": gaits.get("start")})
    return path


def test_a_run_has_its_answer_first_then_table_figure_and_origin(tuned):
    page = Page((tuned / "report.html").read_text())
    assert (page.open, page.wrong) == ([], [])
    text = " ".join(" ".join(page.texts).split())
    said = [
        "Does it <walk>?",
        "In the sim, start walks 22.8 cm/s and never falls, tuned walks 31.0",
        "In the real world, start walks 20.0 cm/s and falls in 1 of 10 trials",
        "fall rate, 95 % interval",
        "60% to 98%",
        "The tuned gait",
        "parameter unit start tuned",
        "How this was made",
        "groundwalk optimize-gait --population 8",
        "real_terrain lumps",
        "mujoco 4.0.0",
    ]
    places = [text.find(words) for words in said]
    assert -1 not in places
    assert places == sorted(places)


def test_a_report_loads_nothing(tuned):
    page = (tuned / "report.html").read_text()
    assert re.findall(FETCHES, page) == []
    assert page.count("data:image/png;base64,") == 1
    picture = base64.b64encode((tuned / "search.png").read_bytes()).decode()
    assert picture in page


@pytest.mark.parametrize(
    "loads",
    [
        '<img src="https://a.org/b.png">',
        "<img src='b.png'>",
        '<a href="b.html">',
        "<style>p { background: url(b.png) }</style>",
        "<script>",
    ],
)
def test_what_loads_is_recognised(loads):
    assert re.findall(FETCHES, loads)


def test_markdown_and_html_say_the_same(tuned):
    markdown = (tuned / "result.md").read_text()
    assert markdown.startswith("# Does it <walk>?\n\nIn the sim, start walks 22.8")
    assert "| real | tuned | 14.4 ± 1.0 | 9/10 | 60% to 98% |" in markdown
    assert (
        "![The search: reward and falls over the generations](search.png)" in markdown
    )
    assert "- command: `groundwalk optimize-gait --population 8`" in markdown
    assert "- settings: robot nao, start start, terrain flat" in markdown
    page = Page((tuned / "report.html").read_text())
    cells = re.findall(r"^\| real \| tuned \| (.*) \|$", markdown, re.MULTILINE)[0]
    assert set(cells.split(" | ")) <= set(page.texts)


# Pieces


def test_foreign_html_is_text_and_a_lost_picture_leaves_its_words(tmp_path):
    (tmp_path / "there.png").write_bytes(PIXEL)
    (tmp_path.parent / "above.png").write_bytes(PIXEL)
    text = "<b>x</b>\n\n![a & b](there.png)\n\n![gone](gone.png)\n\n"
    text += "![above](../above.png)\n\n![far](https://a.org/far.png)"
    page = body_html(text, tmp_path)
    assert "&lt;b&gt;x&lt;/b&gt;" in page
    assert page.count("<figure>") == 1
    assert '<figure><img src="data:image/png;base64,' in page
    assert 'alt="a &amp; b"' in page
    assert "<em>gone</em>" in page
    assert "<em>above</em>" in page
    assert "<em>far</em>" in page
    assert re.findall(FETCHES, page) == []
    assert "<p><figure>" not in page


def test_a_sentence_has_no_paragraph():
    assert sentence_html("`a` < 1") == "<code>a</code> &lt; 1"


def test_columns_of_numbers_are_set_to_the_right():
    rows = [["a", "1.5 ± 2", "-"], ["b", "-3", "4"]]
    table = markdown_table(["name", "speed", "falls"], rows)
    assert table[1] == "| --- | ---: | ---: |"
    assert table[3] == "| b | -3 | 4 |"
    assert markdown_table(["name", "x"], [["a", "-"]])[1] == "| --- | --- |"
    assert markdown_table(["name"], []) == ["| name |", "| --- |"]


def test_of_many_gaits_the_surest_is_named():
    many = {f"gait{k}": score(20.0 + k, falls=k % 3) for k in range(7)}
    (said,) = score_answer({"real": many})
    assert "the one of 7 gaits that falls least is gait6: 26.0 cm/s and never" in said


def test_claims_are_counted():
    yes, no = Claim("a", True, ""), Claim("b", False, "")
    assert claims_answer([]) == []
    assert claims_answer([yes, yes]) == ["All that is claimed below came out so."]
    assert claims_answer([yes, no]) == ["Of the 2 claims below, 1 came out so."]
    assert claims_answer([no, no]) == ["Of the 2 claims below, none came out so."]


def cell(method, step, speed, falls):
    return {
        "method": method,
        "step": step,
        "speed_mean": speed,
        "speed_std": 1.0,
        "falls": falls,
        "trials": 40,
    }


def test_the_nao_study_names_its_best_gait_and_the_goal():
    plain = cell("no grounding", 1, 20.0, 38)
    good, bad = cell("SGAT", 2, 19.0, 2), cell("SGAT", 2, 12.0, 2)
    best, goal = answer_of([plain, good])
    assert best.startswith("The best gait is that of SGAT, step 2: 19.0 ± 1.0 cm/s")
    assert best.endswith("plain sim: 20.0 ± 1.0 cm/s, 38 falls of 40.")
    assert goal.startswith("It reaches the goal of 18 cm/s")
    assert answer_of([plain, bad])[1].startswith("It does not reach")


def test_a_studys_page_has_claims_after_the_answer(tmp_path):
    folder = RunFolder.create("transfer-nao", TransferNao(out=tmp_path / "run"))
    claims = [Claim("it works", False, "no")]
    write_transfer_page(folder, "Q?", claims, ["more"], ["An answer."])
    page = (tmp_path / "run" / "result.md").read_text()
    assert page.startswith("# Q?\n\nAn answer.\n\n- **does not hold**: it works: no\n")
    assert "<strong>does not hold</strong>" in (folder.path / "report.html").read_text()


# Where it comes from


@pytest.mark.parametrize(
    ("verb", "config", "command"),
    [
        ("optimize-gait", OptimizeGait(out=Path("x"), json=True), ""),
        ("optimize-gait", OptimizeGait(real_terrain="flat"), " --real-terrain flat"),
        (
            "transfer-nao",
            TransferNao(methods=("GAT",), seed=2),
            " --methods GAT --seed 2",
        ),
        (
            "evaluate",
            Evaluate(("start", "walk2014"), ("sim",)),
            " start walk2014 --worlds sim",
        ),
        (
            "diagnose",
            Diagnose((Path("a b.csv"),), "nao", kp=2.0),
            " 'a b.csv' --robot nao --kp 2.0",
        ),
    ],
)
def test_from_python_the_command_has_what_is_no_default(verb, config, command):
    words = verb.replace("transfer-", "transfer ")
    assert repeat_command(verb, config) == f"groundwalk {words}{command}"


@pytest.mark.parametrize(
    ("started", "program"),
    [
        ("bin/groundwalk", "groundwalk"),
        ("experiments/command_line.py", "groundwalk"),
        ("experiments/evaluate.py", "python -m experiments.evaluate"),
        ("experiments/transfer/nao.py", "python -m experiments.transfer.nao"),
        ("experiments/transfer/__main__.py", "python -m experiments.transfer"),
    ],
)
def test_a_process_of_our_own_says_how_it_was_started(monkeypatch, started, program):
    root = Path(__file__).resolve().parents[3]
    monkeypatch.setattr(sys, "argv", [str(root / started), "start", "--json"])
    told = repeat_command("evaluate", Evaluate(("start",)))
    assert told == f"{program} start --json"


@pytest.mark.parametrize(
    ("given", "told"),
    [("in/a.csv", "in/a.csv"), ("../data/a.csv", "../data/a.csv"), ("nao", "nao")],
)
def test_a_page_names_no_folder_of_the_machine(tmp_path, monkeypatch, given, told):
    """Paths are told from the current folder on, also those of files beside it."""
    monkeypatch.chdir(tmp_path)
    value = os.path.abspath(given) if os.sep in given else given
    settings = {"one": value, "several": [value, value]}
    code = dict.fromkeys(("python", "command", "commit", "changed"), "known")
    page = Origin.of({**code, "packages": {}}, settings).settings
    assert page == {"one": told, "several": f"{told}, {told}"}


def test_older_runs_told_their_arguments_alone(tmp_path):
    provenance = {
        "arguments": ["transfer", "nao"],
        "python": "3.11",
        "packages": {"numpy": "2", "torch": None},
        "commit": None,
        "changed": None,
    }
    origin = Origin.of(provenance, {"seed": 1, "sim": None, "worlds": ["a", "b"]})
    assert origin.command == "groundwalk transfer nao"
    assert origin.settings == {"seed": "1", "worlds": "a, b"}
    assert origin.versions == {"Python": "3.11", "numpy": "2"}
    assert origin.commit == "unknown"
    changed = Origin.of(provenance | {"commit": "abc", "changed": " M x"}, {})
    assert changed.commit.startswith("abc, with changes")
    page = Report("Q?", [], ["text"], origin).to_markdown()
    assert page.startswith("# Q?\n\ntext\n")
    with pytest.raises(RunFolderError, match="is missing"):
        Origin.of_run(RunFolder(tmp_path))

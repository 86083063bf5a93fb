"""What README and docs tell people to type is understood, and the quick of it works."""

import ast
import importlib
import json
import re
import shlex
import sys
from pathlib import Path

import pytest
import tyro

from experiments.command_line import VERBS, choose
from groundwalk.errors import GroundwalkError
from walk_engine import gaits
from worlds import write_recording

ROOT = Path(__file__).resolve().parents[1]
PAGES = (ROOT / "README.md", *sorted((ROOT / "docs").glob("*.md")))
STANDS_FOR = {"DIR": "set", "FOLDER": "data", "NAME": "nao", "RECORDING...": "air.csv"}
STANDS_FOR["GAIT..."] = "start"
LONG = ("tune_gait(", "run_diagnosis(", "GroundingStep(")
"""What no test waits for: the examples' tests do it in a small size."""

QUICK = (
    "groundwalk export nao",
    "groundwalk list",
    "groundwalk transfer toy",
    "groundwalk record --robot nao",
)


def blocks(page, language):
    """The code blocks of a page in one language; "" is what people type."""
    pattern = re.compile(r"^```(\w*)\n(.*?)^```$", re.MULTILINE | re.DOTALL)
    found = pattern.findall(page.read_text())
    return [code for known, code in found if known == language]


def typed(page):
    """The command lines of a page, without what they say of themselves."""
    lines = [line for block in blocks(page, "") for line in block.splitlines()]
    mentions = re.findall(r"`((?:groundwalk|make|python) [^`\n]+)`", page.read_text())
    lines += [line for line in mentions if len(line.split()) > 2 or "make" in line]
    lines = [line.partition(" #")[0].strip() for line in lines]
    lines = [line for line in lines if line and not re.search(r"\bVERB\b|\[", line)]
    return [command for line in lines for command in alternatives(line)]


def alternatives(line):
    """A line with "a|b" in it stands for two."""
    words = [STANDS_FOR.get(word, word) for word in line.split()]
    for k, word in enumerate(words):
        if "|" in word:
            choices = [[*words[:k], one, *words[k + 1 :]] for one in word.split("|")]
            return [one for words in choices for one in alternatives(" ".join(words))]
    return [" ".join(words)]


COMMANDS = sorted({command for page in PAGES for command in typed(page)})


@pytest.fixture
def prepared(tmp_path, monkeypatch):
    """A folder that has what the commands speak of."""
    monkeypatch.chdir(tmp_path)
    found = {"format": 1, "robot": "nao", "base": "fixed", "native": [], "per_tick": []}
    for run in ("of-a-nao", "knee"):
        path = tmp_path / "runs" / run / "corrected.json"
        path.parent.mkdir(parents=True)
        path.write_text(json.dumps(found))
    for run in ("runs/mine", "runs/g1", "runs/lumps", "docs/results/walk"):
        gaits.get("start").save(tmp_path / run / "result.json")
    for room in ("robots", "experiments"):
        monkeypatch.syspath_prepend(ROOT / "tests" / room)
    from made_up_runs import steady
    from made_up_urdf import two_legged

    for name in ("sim", "real", "fall"):
        write_recording(steady(duration_s=0.2), tmp_path / f"{name}.parquet")
    (tmp_path / "my_robot.urdf").write_text(two_legged())
    (tmp_path / "set" / "cases").mkdir(parents=True)
    (tmp_path / "data").mkdir()
    for recording in ("data/air.parquet", "runs/air.parquet"):
        (tmp_path / recording).touch()
    return tmp_path


def options_of(words):
    """The configuration that a command line makes; nothing is done."""
    verbs, name = VERBS, words.pop(0)
    while True:
        verb = verbs[name]
        module = importlib.import_module(f"experiments.{verb.module}")
        config = getattr(module, verb.config)
        if not isinstance(config, dict):
            return tyro.cli(config, args=words)
        verbs, name = config, words.pop(0)


def test_the_pages_have_commands():
    assert len(COMMANDS) > 15
    assert "groundwalk list gaits" in COMMANDS
    assert "make walk" in COMMANDS


@pytest.mark.parametrize("command", COMMANDS)
def test_a_command_is_understood(command, prepared):
    program, *words = shlex.split(command)
    if program == "make":
        targets = re.findall(
            r"^([\w-]+):", (ROOT / "Makefile").read_text(), re.MULTILINE
        )
        assert words[0] in targets or words[0].startswith("results")
    elif program == "python":
        kind, name = words[:2]
        if kind == "-m":
            assert importlib.util.find_spec(name)
        else:
            assert (ROOT / kind).is_file()
    elif program == "groundwalk" and words[1:] != ["--help"]:
        options_of(words)


@pytest.mark.parametrize(
    "command",
    ["groundwalk evaluate --speed 3", "groundwalk evaluate moonwalk", "groundwalk fly"],
)
def test_a_wrong_command_is_noticed(command, prepared, capsys):
    with pytest.raises((SystemExit, KeyError, GroundwalkError)):
        test_a_command_is_understood(command, prepared)


@pytest.mark.parametrize("command", [one for one in COMMANDS if one.startswith(QUICK)])
def test_a_quick_command_works(command, prepared, monkeypatch, capsys):
    words = shlex.split(command)
    monkeypatch.setattr(sys, "argv", words)
    with pytest.raises(SystemExit) as stop:
        choose(VERBS, words[0], words[1:])
    assert not stop.value.code
    assert capsys.readouterr().out or (prepared / words[-1]).exists()


PYTHON = [(page, code) for page in PAGES for code in blocks(page, "python")]


@pytest.mark.parametrize(("page", "code"), PYTHON)
def test_python_in_the_pages_works(page, code, prepared, capsys):
    if not any(call in code for call in LONG) and page.stem in ("README", "python"):
        exec(compile(code, page.name, "exec"), {"__name__": "a_page"})
        return
    imports = (ast.Import, ast.ImportFrom)
    lines = [line for line in ast.parse(code).body if isinstance(line, imports)]
    exec(compile(ast.Module(lines, []), page.name, "exec"), {})

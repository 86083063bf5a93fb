import importlib.util
import json
import os
import signal
import subprocess
import sys
import time

import pytest
from copied_processes import IMPORTED

from experiments.command_line import VERBS, main, one_line, run_verb
from experiments.concealed.run import ConcealedRun
from experiments.evaluate import Evaluate
from experiments.record import Record
from walk_engine import gaits


def groundwalk(*arguments, folder):
    return subprocess.run(
        [sys.executable, "-m", "experiments.command_line", *map(str, arguments)],
        cwd=folder,
        capture_output=True,
        text=True,
        timeout=120,
        check=False,
    )


def write_gait(path, **changes):
    values = dict(gaits.get("start")) | changes
    path.write_text(json.dumps({k: v for k, v in values.items() if v is not None}))
    return path


@pytest.fixture
def bad_input(tmp_path):
    """Command lines that must be refused, and what the one line must say."""
    gait = tmp_path / "gait.json"
    (tmp_path / "taken").mkdir()
    (tmp_path / "taken" / "mine.txt").write_text("precious")
    (tmp_path / "empty.parquet").write_bytes(b"")
    (tmp_path / "wrong.csv").write_text("tine,position.a\n0,1\n")
    (tmp_path / "wrong.json").write_text(
        json.dumps({"format": 1, "robot": "nao", "base": "fixed", "source": ""})
    )

    def with_gait(**changes):
        write_gait(gait, **changes)
        return ["evaluate", gait]

    return {
        "verb": (lambda: ["optimise"], "unknown verb 'optimise'"),
        "robot": (lambda: ["optimize-gait", "--robot", "nap"], "did you mean 'nao'"),
        "terrain": (lambda: ["evaluate", "start", "--terrain", "wave"], "'waves'"),
        "option": (lambda: ["evaluate", "start", "--trails", "3"], "--trials"),
        "number": (lambda: ["optimize-gait", "--population", "many"], "--population"),
        "seed": (lambda: ["evaluate", "start", "--seed", "-1"], "seed is -1"),
        "world": (lambda: ["evaluate", "start", "--worlds", "sin"], "'sim'"),
        "bounds": (lambda: with_gait(hip_height=0.5), "hip_height"),
        "missing": (lambda: with_gait(hip_height=None), "hip_height"),
        "extra": (lambda: with_gait(hip_hight=0.2), "hip_hight"),
        "nan": (lambda: with_gait(hip_height=float("nan")), "hip_height"),
        "no gait": (lambda: ["evaluate", "none.json"], "none.json"),
        "no recording": (lambda: ["visualize", "none.parquet"], "none.parquet"),
        "empty recording": (lambda: ["visualize", "empty.parquet"], "empty.parquet"),
        "wrong column": (lambda: ["visualize", "wrong.csv"], "tine"),
        "folder": (lambda: ["optimize-gait", "--out", "taken"], "taken exists"),
        "resume": (lambda: ["optimize-gait", "--resume", "taken"], "no run folder"),
        "export": (lambda: ["export", "nap", "--format", "urdf"], "did you mean 'nao'"),
        "list": (lambda: ["list", "robot"], "robots"),
    }


def test_bad_input_gets_one_line_and_status_2(bad_input, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    for case, (arguments, expected) in bad_input.items():
        words = ["groundwalk", *map(str, arguments())]
        monkeypatch.setattr(sys, "argv", words)
        with pytest.raises(SystemExit) as stop:
            main()
        said = capsys.readouterr()
        assert stop.value.code == 2, (case, said)
        assert said.out == "", case
        assert said.err.count("\n") == 1, (case, said)
        assert expected in said.err, (case, said)
    assert [p.name for p in (tmp_path / "taken").iterdir()] == ["mine.txt"]
    assert not (tmp_path / "runs").exists()


@pytest.mark.parametrize("case", ["verb", "folder"])
def test_the_command_itself_says_no_more(bad_input, tmp_path, case):
    """As a process of its own, with all that is said while its code is imported."""
    arguments, expected = bad_input[case]
    done = groundwalk(*arguments(), folder=tmp_path)
    assert (done.returncode, done.stdout) == (2, "")
    (line,) = done.stderr.splitlines()
    assert expected in line


def test_help_names_every_verb(tmp_path):
    done = groundwalk("--help", folder=tmp_path)
    assert done.returncode == 0
    assert all(verb in done.stdout for verb in VERBS)


def test_help_shows_a_verbs_own_options_before_those_of_all_runs(tmp_path):
    said = groundwalk("transfer", "toy", "--help", folder=tmp_path).stdout
    places = [said.index(f"--{name}") for name in ("episodes", "seed", "out", "json")]
    assert places == sorted(places)


def test_good_input_is_not_refused(tmp_path):
    done = groundwalk("list", "gaits", folder=tmp_path)
    assert done.returncode == 0
    assert "walk2014" in done.stdout
    assert done.stderr == ""


@pytest.mark.parametrize(
    ("options", "words", "hint"),
    [
        (Evaluate, ["start"], "; --resume DIR continues the run"),
        (ConcealedRun, ["SET"], "; the same command continues where this one stopped"),
        (Record, ["--out", "new.csv"], ""),
    ],
)
def test_ctrl_c_advises_only_what_the_verb_has(
    tmp_path, monkeypatch, capsys, options, words, hint
):
    (tmp_path / "SET" / "cases").mkdir(parents=True)
    monkeypatch.chdir(tmp_path)

    def stopped(config):
        raise KeyboardInterrupt

    with pytest.raises(SystemExit) as stop:
        run_verb(options, stopped, "groundwalk", words)
    assert stop.value.code == 130
    assert capsys.readouterr().err == f"groundwalk: interrupted{hint}\n"


@pytest.mark.slow
def test_ctrl_c_in_the_real_world_says_one_thing(tmp_path):
    words = ["evaluate", "start", "--worlds", "real", "--trials", "1", "--out", "run"]
    run = subprocess.Popen(
        [sys.executable, "-m", "experiments.command_line", *words],
        cwd=tmp_path,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
    )
    while not (tmp_path / "run" / "config.json").exists():
        time.sleep(0.1)
    time.sleep(2)  # its processes are starting, or they walk
    os.killpg(run.pid, signal.SIGINT)
    _, said = run.communicate(timeout=60)
    assert (run.returncode, said.count("\n")) == (130, 1), said


def test_processes_of_tests_begin_with_what_there_is():
    """A server of copies passes over what it cannot import, and says nothing."""
    assert all(importlib.util.find_spec(name) for name in IMPORTED)


def test_a_boxed_report_becomes_one_line():
    report = (
        "╭─ Value error ──╮\n│ Error parsing --x: │\n│ 'q' is bad         │\n"
        "│ ────────────── │\n│ For full helptext, see --help │\n╰────────────────╯\n"
    )
    assert one_line(report) == "Error parsing --x: 'q' is bad"

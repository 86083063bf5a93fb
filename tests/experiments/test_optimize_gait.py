import json
import signal
import sys
import time
from dataclasses import replace
from pathlib import Path

import pytest
from copied_processes import started
from short_walks import shorten_searches

from experiments import command_line
from experiments.optimize_gait import OptimizeGait, main
from experiments.runs.folder import RunFolder, open_run
from experiments.walking.gait_search import SearchPlan, search_gait
from groundwalk.errors import BadValueError, GroundwalkError, RunFolderError
from walk_engine import PARAMETERS, Gait

SMALL = {"population": 4, "generations": 2, "ratings": 1, "trials": 1, "course_m": 0.2}
PATIENCE_S = 300


def history_of(tmp_path, name, **settings):
    plan = SearchPlan(population=4, generations=2, ratings=1, **settings)
    folder = RunFolder(tmp_path / name)
    search_gait(plan, folder)
    return (folder.path / "history.json").read_bytes()


@pytest.mark.slow
@pytest.mark.usefixtures("short_searches")
def test_a_killed_run_resumes_to_the_same_bits(tmp_path, capsys):
    whole, cut = tmp_path / "whole", tmp_path / "cut"
    main(OptimizeGait(**SMALL, out=whole))
    result = json.loads((whole / "result.json").read_text())
    words = [f"--{name.replace('_', '-')}={size}" for name, size in SMALL.items()]
    command = ["optimize-gait", *words, "--out", "cut"]
    run = started(tmp_path, command, before=shorten_searches)
    deadline = time.monotonic() + PATIENCE_S
    while generations(cut) < 1 and time.monotonic() < deadline:
        time.sleep(0.02)
    run.kill()
    run.join()
    assert run.exitcode == -signal.SIGKILL
    assert not (cut / "result.json").exists()
    capsys.readouterr()
    main(OptimizeGait(resume=cut, json=True))
    history = "history.json"
    assert (cut / history).read_bytes() == (whole / history).read_bytes()
    # nothing but the result on standard output
    assert json.loads(capsys.readouterr().out) == result
    check_run_folder(whole, result)


@pytest.fixture(scope="module")
def plain(tmp_path_factory):
    """The history of a search as it is."""
    with pytest.MonkeyPatch.context() as patch:
        shorten_searches(patch)
        return history_of(tmp_path_factory.mktemp("plain"), "run", threads=1)


def generations(folder):
    path = folder / "history.json"
    return len(json.loads(path.read_text())["generations"]) if path.exists() else 0


def check_run_folder(folder: Path, result):
    for world in ("sim", "real"):
        for gait in ("start", "tuned"):
            score = result[world][gait]
            assert set(score) == {"speed_cm_s", "speed_std", "falls", "trials"}
            assert score["trials"] == 1
            assert (folder / "recordings" / f"{world}_{gait}.parquet").exists()
    Gait.from_mapping(result["gait"])
    kept = {
        "config.json",
        "provenance.json",
        "history.json",
        "checkpoint.json",
        "result.json",
        "result.md",
        "report.html",
        "search.png",
        "walk.png",
        "walk.rrd",
    }
    assert kept <= {path.name for path in folder.iterdir()}


@pytest.mark.usefixtures("short_searches")
def test_an_extended_search_has_the_bits_of_a_long_one(tmp_path):
    folder = RunFolder(tmp_path / "extended")
    short = SearchPlan(population=4, generations=1, ratings=2)
    long = replace(short, generations=2)
    search_gait(short, folder)
    longer = search_gait(long, folder)
    whole = RunFolder(tmp_path / "whole")
    assert search_gait(long, whole) == longer
    name = "history.json"
    assert (folder.path / name).read_bytes() == (whole.path / name).read_bytes()


@pytest.mark.usefixtures("short_searches")
def test_the_same_seed_gives_the_same_history_on_any_number_of_threads(plain, tmp_path):
    assert plain == history_of(tmp_path, "two", threads=2)
    assert plain != history_of(tmp_path, "other", threads=1, seed=2)


@pytest.mark.usefixtures("short_searches")
def test_on_uneven_ground_every_generation_walks_on_new_ground(plain, tmp_path):
    uneven = history_of(tmp_path, "uneven", terrain="lumps:amplitude_m=0.004")
    assert uneven == history_of(tmp_path, "again", terrain="lumps:amplitude_m=0.004")
    assert uneven != plain


def corrected(folder, **changes):
    """A folder with what a diagnosis could have found."""
    late = {
        "name": "command_latency",
        "place": "commands",
        "parameters": {"delay": 0.04},
    }
    plain = {"format": 1, "robot": "nao", "base": "fixed", "native": [late]}
    folder.mkdir()
    text = json.dumps({**plain, "per_tick": [], **changes})
    (folder / "corrected.json").write_text(text)
    return folder


@pytest.mark.usefixtures("short_searches")
def test_the_search_walks_in_the_corrected_sim(plain, tmp_path):
    late = history_of(tmp_path, "late", sim=corrected(tmp_path / "found"))
    assert late != plain
    nothing = corrected(tmp_path / "nothing", native=[])
    assert history_of(tmp_path, "same", sim=nothing) == plain


def test_only_the_sim_is_corrected(tmp_path):
    config = OptimizeGait(sim=corrected(tmp_path / "found"))
    assert config.study("sim").correction == tmp_path / "found"
    assert config.study("real").correction is None


def test_a_resumed_run_has_its_corrected_sim_again(tmp_path):
    config = OptimizeGait(sim=corrected(tmp_path / "found"), out=tmp_path / "run")
    RunFolder.create("optimize-gait", config)
    _, resumed = open_run("optimize-gait", OptimizeGait(resume=tmp_path / "run"))
    assert resumed.sim == tmp_path / "found"
    other = corrected(tmp_path / "other")
    again = OptimizeGait(resume=tmp_path / "run", sim=other)
    with pytest.raises(BadValueError, match="sim cannot change"):
        open_run("optimize-gait", again)


def test_a_folder_that_is_no_diagnosis_is_refused_before_anything(
    tmp_path, monkeypatch, capsys
):
    found = corrected(tmp_path / "found", robot="so101")
    for bad, words in (
        (tmp_path / "gone", "gone: no such folder or file"),
        (tmp_path, "is no folder of a diagnosis"),
        (found, "these effects are of 'so101', the robot is 'nao'"),
    ):
        typed = ["optimize-gait", "--sim", str(bad), "--out", str(tmp_path / "run")]
        monkeypatch.setattr(sys, "argv", ["groundwalk", *typed])
        with pytest.raises(SystemExit) as stop:
            command_line.main()
        said = capsys.readouterr().err
        assert stop.value.code == 2
        assert words in said
        assert said.count("\n") == 1
        assert not (tmp_path / "run").exists()


def test_the_history_says_what_the_search_did(plain):
    entry = json.loads(plain)["generations"][0]
    assert len(entry["rewards"]) == 4
    assert 0 <= entry["falls"] <= 4
    assert len(entry["spread"]) == len(PARAMETERS)
    assert set(entry["mean_gait"]) == {parameter.name for parameter in PARAMETERS}


def test_a_damaged_checkpoint_is_named(tmp_path):
    folder = RunFolder(tmp_path)
    (tmp_path / "checkpoint.json").write_bytes(b"\x80\x04 cut off")
    with pytest.raises(RunFolderError, match=r"checkpoint\.json is damaged"):
        search_gait(SearchPlan(population=6, generations=2), folder)


@pytest.mark.parametrize(
    ("settings", "message"),
    [
        ({"robot": "nano"}, "unknown robot 'nano': did you mean 'nao'"),
        ({"start": "stard"}, "unknown gait 'stard': did you mean 'start'"),
        ({"terrain": "lumbs"}, "did you mean 'lumps'"),
        ({"population": 0}, "population is 0"),
        ({"generations": -1}, "generations is -1"),
        ({"seed": -1}, "seed is -1"),
        ({"population": 3}, "population is 3; it must be at least 4"),
        ({"sigma": 0.0}, "sigma is 0.0"),
        ({"trials": 0}, "trials is 0"),
        ({"ratings": 0}, "ratings is 0"),
        ({"course_m": 0.0}, "course_m is 0; it must be positive"),
        ({"course_m": 6.0}, "course_m is 6, but the ground ends at 5 m"),
        ({"threads": -1}, "threads is -1"),
    ],
)
def test_what_no_run_can_do_is_refused_at_once(settings, message):
    with pytest.raises(GroundwalkError, match=message):
        OptimizeGait(**settings)

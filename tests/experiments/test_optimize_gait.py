import json
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest

from experiments.optimize_gait import OptimizeGait, search
from experiments.run_folder import RunFolder
from groundwalk.errors import GroundwalkError, RunFolderError
from walk_engine import PARAMETERS, Gait

SMALL = ["--population", "6", "--generations", "4", "--trials", "1"]
PATIENCE_S = 300


def script(*arguments):
    return [sys.executable, "-m", "experiments.optimize_gait", *arguments]


def history_of(tmp_path, name, **settings):
    config = OptimizeGait(population=6, generations=2, **settings)
    folder = RunFolder(tmp_path / name)
    search(config, folder, np.random.SeedSequence(config.seed))
    return (folder.path / "history.json").read_bytes()


@pytest.mark.slow
def test_a_killed_run_resumes_to_the_same_bits(tmp_path):
    whole, cut = tmp_path / "whole", tmp_path / "cut"
    done = subprocess.run(
        script(*SMALL, "--out", str(whole), "--json"),
        capture_output=True,
        text=True,
        timeout=PATIENCE_S,
        check=True,
    )
    result = json.loads(done.stdout)  # nothing but the result on standard output
    run = subprocess.Popen(script(*SMALL, "--out", str(cut)), stderr=subprocess.DEVNULL)
    deadline = time.monotonic() + PATIENCE_S
    while generations(cut) < 2 and time.monotonic() < deadline:
        time.sleep(0.02)
    run.send_signal(signal.SIGKILL)
    run.wait()
    assert not (cut / "result.json").exists()
    resumed = script("--resume", str(cut), "--json")
    again = subprocess.run(
        resumed, capture_output=True, text=True, timeout=PATIENCE_S, check=True
    )
    history = "history.json"
    assert (cut / history).read_bytes() == (whole / history).read_bytes()
    assert json.loads(again.stdout) == result
    check_run_folder(whole, result)


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
        "checkpoint.pkl",
        "result.json",
        "result.md",
        "search.png",
        "walk.png",
        "walk.rrd",
    }
    assert kept <= {path.name for path in folder.iterdir()}


def test_the_same_seed_gives_the_same_history_on_any_number_of_threads(tmp_path):
    one = history_of(tmp_path, "one", threads=1)
    assert one == history_of(tmp_path, "two", threads=2)
    assert one != history_of(tmp_path, "other", threads=1, seed=2)


def test_on_uneven_ground_every_generation_walks_on_new_ground(tmp_path):
    uneven = history_of(tmp_path, "uneven", terrain="lumps:amplitude_m=0.004")
    assert uneven == history_of(tmp_path, "again", terrain="lumps:amplitude_m=0.004")
    assert uneven != history_of(tmp_path, "flat")


def test_the_history_says_what_the_search_did(tmp_path):
    entry = json.loads(history_of(tmp_path, "run"))["generations"][0]
    assert len(entry["rewards"]) == 6
    assert 0 <= entry["falls"] <= 6
    assert len(entry["spread"]) == len(PARAMETERS)
    assert set(entry["mean_gait"]) == {parameter.name for parameter in PARAMETERS}


def test_a_damaged_checkpoint_is_named(tmp_path):
    folder = RunFolder(tmp_path)
    folder.write_bytes("checkpoint.pkl", b"\x80\x04 cut off")
    seed = np.random.SeedSequence(1)
    with pytest.raises(RunFolderError, match=r"checkpoint\.pkl is damaged"):
        search(OptimizeGait(population=6, generations=2), folder, seed)


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
        ({"threads": -1}, "threads is -1"),
    ],
)
def test_what_no_run_can_do_is_refused_at_once(settings, message):
    with pytest.raises(GroundwalkError, match=message):
        OptimizeGait(**settings)

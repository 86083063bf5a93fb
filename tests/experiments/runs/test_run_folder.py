import json
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

import pytest

from experiments.reports.origin import Origin
from experiments.runs import folder as run_folder
from experiments.runs.folder import CONFIG, RunFolder, open_run
from experiments.runs.gait_files import load_gait, load_gaits
from experiments.runs.options import DefaultInt, RunOptions
from groundwalk.errors import BadValueError, GroundwalkError, RunFolderError
from walk_engine import gaits


@dataclass(frozen=True)
class Config(RunOptions):
    size: int = DefaultInt(3)
    names: tuple[str, ...] = ("a",)
    robot: str = "nao"


@dataclass(frozen=True)
class NoResume:
    out: Path | None = None
    seed: int = 1


HOLD = """
import sys, time
from pathlib import Path
from experiments.runs.folder import FolderLock
lock = FolderLock.of(Path(sys.argv[1]))
print("locked", flush=True)
time.sleep(60)
"""


def test_a_run_describes_itself(tmp_path):
    config = Config(size=5, out=tmp_path / "run")
    folder, same = open_run("verb", config)
    assert same is config
    stored = folder.read_json(CONFIG)
    assert (stored["verb"], stored["size"], stored["names"]) == ("verb", 5, ["a"])
    provenance = folder.read_json("provenance.json")
    assert provenance["packages"]["mujoco"] == "4.0.0"


def test_an_existing_folder_is_never_touched(tmp_path):
    (tmp_path / "run").mkdir()
    (tmp_path / "run" / "mine.txt").write_text("precious")
    with pytest.raises(RunFolderError, match=r"exists already.*--resume"):
        open_run("verb", Config(out=tmp_path / "run"))
    assert [p.name for p in (tmp_path / "run").iterdir()] == ["mine.txt"]


def test_only_runs_that_can_be_resumed_are_told_so(tmp_path):
    with pytest.raises(RunFolderError) as refused:
        RunFolder.create("verb", NoResume(out=tmp_path))
    assert "--resume" not in str(refused.value)


def test_two_processes_do_not_write_into_one_folder(tmp_path):
    path = tmp_path / "run"
    open_run("verb", Config(out=path))
    other = subprocess.Popen(
        [sys.executable, "-c", HOLD, path], stdout=subprocess.PIPE, text=True
    )
    with other:
        assert other.stdout.readline() == "locked\n"
        with pytest.raises(RunFolderError, match=f"in use by process {other.pid}"):
            open_run("verb", Config(resume=path))
        other.kill()
    folder, _ = open_run("verb", Config(resume=path))  # a dead process holds nothing
    again, _ = open_run("verb", Config(resume=path))  # nor does this process
    assert folder.path == again.path


def test_files_of_a_run_are_found_from_any_folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("me.toml").touch()
    _, config = open_run("verb", Config(robot="me.toml", out=tmp_path / "run"))
    monkeypatch.chdir("/")
    assert config.robot == str(tmp_path / "me.toml")
    _, resumed = open_run("verb", Config(resume=tmp_path / "run"))
    assert resumed.robot == config.robot
    monkeypatch.chdir(tmp_path)
    _, same = open_run("verb", Config(robot="me.toml", resume=tmp_path / "run"))
    assert same.robot == config.robot
    origin = Origin.of_run(RunFolder.at(tmp_path / "run"))
    assert origin.settings["robot"] == "me.toml"  # no more of the path than is needed


@pytest.mark.parametrize("more", [3, 5])  # three is the default
def test_what_may_grow_continues_beyond_the_end(tmp_path, more):
    path = tmp_path / "run"
    folder, _ = open_run("verb", Config(size=2, out=path))
    folder.write_json("result.json", {})
    _, kept = open_run("verb", Config(resume=path), may_grow="size")
    assert (kept.size, folder.has("result.json")) == (2, True)
    with pytest.raises(BadValueError, match="size cannot change from 2 to 1"):
        open_run("verb", Config(size=1, resume=path), may_grow="size")
    _, grown = open_run("verb", Config(size=more, resume=path), may_grow="size")
    assert (grown.size, folder.has("result.json")) == (more, False)
    assert folder.read_json(CONFIG)["size"] == more


def test_a_run_folder_is_the_gait_that_it_found(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    RunFolder(Path("mine")).write_json(
        "result.json", {"gait": dict(gaits.get("start"))}
    )
    assert load_gait("mine") == gaits.get("start")
    assert list(load_gaits(["walk2014", "mine"])) == ["walk2014", "mine"]
    Path("start").mkdir()
    assert load_gait("start") == gaits.get("start")  # a gait's name comes first
    Path("empty").mkdir()
    with pytest.raises(GroundwalkError, match="empty"):
        load_gait("empty")


def test_the_default_folder_is_named_after_verb_and_seed(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    folder, _ = open_run("verb", Config(seed=7))
    assert folder.path.parts[:2] == ("runs", "verb")
    assert folder.path.name.endswith("_s7")


def test_resuming_takes_the_stored_settings(tmp_path):
    open_run("verb", Config(size=5, names=("x", "y"), out=tmp_path / "run"))
    _, config = open_run("verb", Config(resume=tmp_path / "run", json=True))
    assert (config.size, config.names, config.json) == (5, ("x", "y"), True)


def test_resuming_with_another_setting_is_refused(tmp_path):
    open_run("verb", Config(size=5, out=tmp_path / "run"))
    with pytest.raises(BadValueError, match="size cannot change from 5 to 6"):
        open_run("verb", Config(size=6, resume=tmp_path / "run"))
    _, same = open_run("verb", Config(size=5, resume=tmp_path / "run"))
    assert same.size == 5


def test_what_is_no_run_cannot_be_resumed(tmp_path):
    with pytest.raises(RunFolderError, match="no run folder"):
        open_run("verb", Config(resume=tmp_path / "nowhere"))
    open_run("other", Config(out=tmp_path / "run"))
    with pytest.raises(RunFolderError, match="a run of other, not of verb"):
        open_run("verb", Config(resume=tmp_path / "run"))


@pytest.mark.parametrize("content", ["{", "[1]", "\x00"])
def test_broken_files_are_named(tmp_path, content):
    folder = RunFolder(tmp_path)
    (tmp_path / "result.json").write_text(content)
    with pytest.raises(RunFolderError, match=r"result\.json"):
        folder.read_json("result.json")


def test_json_written_is_json_read(tmp_path):
    folder = RunFolder(tmp_path)
    folder.write_json("a.json", {"x": [1, 2.5, None]})
    assert folder.read_json("a.json") == {"x": [1, 2.5, None]}
    assert json.loads((tmp_path / "a.json").read_text())
    assert folder.has("a.json")
    assert not folder.has("b.json")


def test_an_option_that_came_later_has_its_default_when_resumed(tmp_path):
    folder, _ = open_run("verb", Config(out=tmp_path / "run"))
    stored = folder.read_json("config.json")
    del stored["size"]
    folder.write_json("config.json", stored)
    _, config = open_run("verb", Config(resume=tmp_path / "run"))
    assert config.size == Config.size


def test_the_code_that_goes_on_is_written_down(tmp_path, monkeypatch):
    of_code = {"python": "3", "packages": {}}
    for commit, told in (
        ("a", "a"), ("a", "a"), ("b", "a; resumed at b"), ("b", "a; resumed at b"),
        ("a", "a; resumed at b"), ("c", "a; resumed at b; resumed at c"),
    ):  # fmt: skip
        now = of_code | {"commit": commit, "changed": ""}
        monkeypatch.setattr(run_folder, "_code", lambda now=now: now)
        there = (tmp_path / "run").exists()
        where = {"resume" if there else "out": tmp_path / "run"}
        folder, _ = open_run("verb", Config(**where))
        assert Origin.of_run(folder).commit == told

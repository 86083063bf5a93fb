import json
from dataclasses import dataclass

import pytest

from experiments.reports.origin import Origin
from experiments.runs import folder as run_folder
from experiments.runs.folder import CONFIG, RunFolder, open_run
from experiments.runs.options import RunOptions
from groundwalk.errors import BadValueError, RunFolderError


@dataclass(frozen=True)
class Config(RunOptions):
    size: int = 3
    names: tuple[str, ...] = ("a",)


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
    of_code = {"python": "3", "packages": {}, "arguments": []}
    for commit, told in (
        ("a", "a"), ("a", "a"), ("b", "a; resumed at b"), ("b", "a; resumed at b"),
        ("a", "a; resumed at b"), ("c", "a; resumed at b; resumed at c"),
    ):  # fmt: skip
        now = of_code | {"commit": commit, "changed": ""}
        monkeypatch.setattr(run_folder, "provenance", lambda now=now: now)
        there = (tmp_path / "run").exists()
        where = {"resume" if there else "out": tmp_path / "run"}
        folder, _ = open_run("verb", Config(**where))
        assert Origin.of_run(folder).commit == told

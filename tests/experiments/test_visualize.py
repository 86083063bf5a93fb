import json
import subprocess
import sys

import numpy as np
import pytest
from made_up_runs import history, steady
from rerun.chunk import RrdReader

from experiments import visualize
from experiments.runs.folder import RunFolder
from experiments.visualize import Visualize, default_out, gather, main
from groundwalk.errors import BadRecordingError, BadValueError, RunFolderError
from worlds import Recording, RecordingMetadata, write_recording


@pytest.fixture
def recording(tmp_path):
    path = tmp_path / "glide.parquet"
    write_recording(steady(), path)
    return path


@pytest.fixture
def run(tmp_path):
    folder = RunFolder(tmp_path / "run")
    folder.write_json("config.json", {"verb": "optimize-gait"})
    folder.write_json("history.json", {"generations": history(2)})
    for name in ("sim_tuned", "real_tuned"):
        write_recording(steady(), folder.path / "recordings" / f"{name}.parquet")
    return folder.path


@pytest.fixture
def unfinished(run):
    for path in (run / "recordings").iterdir():
        path.unlink()
    return run


def scenes_in(path):
    """First parts of the paths of all robots in a Rerun file."""
    chunks = RrdReader(path).stream().to_chunks()
    paths = {chunk.entity_path for chunk in chunks}
    return {path.partition("/robot/")[0] for path in paths if "/robot/" in path}


def test_a_recording_is_written_beside_itself(recording, capsys):
    main(Visualize((recording,)))
    written = recording.with_suffix(".rrd")
    assert capsys.readouterr().out.split() == [str(written)]
    assert scenes_in(written) == {"/glide"}


def test_a_run_shows_all_its_recordings_and_its_search(run, capsys):
    main(Visualize((run,), json=True))
    told = json.loads(capsys.readouterr().out)
    assert told == {
        "rrd": str(run / "walk.rrd"),
        "overlays": [],
        "searches": [str(run / "search.rrd")],
        "pictures": [str(run / "search.png")],
    }
    assert (run / "search.png").is_file()
    assert scenes_in(run / "walk.rrd") == {"/sim/tuned", "/real/tuned"}


def test_several_are_shown_side_by_side(run, recording, tmp_path, capsys):
    out = tmp_path / "all.rrd"
    main(Visualize((recording, run, recording), out=out))
    assert str(out) in capsys.readouterr().out
    runs = {"/run/sim/tuned", "/run/real/tuned"}
    assert scenes_in(out) == {"/glide", "/glide-2"} | runs


def test_a_file_of_ours_is_renewed(recording, capsys):
    for _ in range(2):
        main(Visualize((recording,)))
    assert scenes_in(recording.with_suffix(".rrd")) == {"/glide"}


def test_a_file_of_somebody_else_is_not(recording):
    other = recording.with_suffix(".rrd")
    other.write_bytes(b"RRF2 of another application")
    with pytest.raises(BadValueError, match=r"is no file of groundwalk"):
        main(Visualize((recording,)))
    assert other.read_bytes() == b"RRF2 of another application"


def test_default_places(run, recording, tmp_path):
    assert default_out((run,)) == run / "walk.rrd"
    assert default_out((recording,)) == tmp_path / "glide.rrd"
    assert default_out((run, recording)) == tmp_path / "comparison.rrd"


def test_an_unfinished_run_shows_its_search(unfinished, capsys):
    main(Visualize((unfinished,), json=True))
    told = json.loads(capsys.readouterr().out)
    assert told == {
        "rrd": None,
        "overlays": [],
        "searches": [str(unfinished / "search.rrd")],
        "pictures": [str(unfinished / "search.png")],
    }


def test_an_unfinished_run_has_no_recordings_to_write(unfinished, tmp_path):
    with pytest.raises(RunFolderError, match="no recordings"):
        main(Visualize((unfinished,), out=tmp_path / "new.rrd"))
    assert not list(tmp_path.rglob("*.rrd"))


def test_the_viewer_gets_walks_and_search(run, monkeypatch):
    opened = []
    monkeypatch.setattr(visualize, "open_viewer", opened.extend)
    main(Visualize((run,), open=True))
    assert opened == [run / "walk.rrd", run / "search.rrd"]


def test_any_run_folder_with_recordings_can_be_shown(tmp_path):
    """A stress test keeps its worst rollouts; it has no search and no gaits' names."""
    folder = RunFolder(tmp_path / "stress")
    folder.write_json("config.json", {"verb": "terrain-stress"})
    for name in ("real_stairs_worst_1", "bumps"):
        write_recording(steady(), folder.path / "recordings" / f"{name}.parquet")
    main(Visualize((folder.path,)))
    shown = {"/real/stairs_worst_1", "/bumps"}
    assert scenes_in(folder.path / "walk.rrd") == shown


def test_a_study_of_several_robots_shows_the_run_of_each(tmp_path, capsys):
    folder = RunFolder(tmp_path / "study")
    folder.write_json("config.json", {"verb": "humanoids"})
    for robot in ("nao", "g1"):
        path = folder.path / robot / "recordings" / "sim_tuned.parquet"
        write_recording(steady(), path)
    main(Visualize((folder.path,)))
    assert scenes_in(folder.path / "walk.rrd") == {"/g1/sim/tuned", "/nao/sim/tuned"}


def test_a_diagnosis_shows_the_overlay_that_it_has_written(
    tmp_path, monkeypatch, capsys
):
    folder = RunFolder(tmp_path / "diagnosis")
    folder.write_json("config.json", {"verb": "diagnose"})
    overlay = folder.path / "overlay.rrd"
    overlay.write_bytes(b"RRF")
    opened = []
    monkeypatch.setattr("experiments.visualize.open_viewer", opened.append)
    main(Visualize((folder.path,), open=True))
    assert opened == [[overlay]]
    assert capsys.readouterr().out.split() == [str(overlay)]


ARM = """<mujoco><worldbody><body pos="0 0 0.1"><joint name="shoulder" axis="0 1 0"/>
<geom type="capsule" fromto="0 0 0 0 0 0.4" size="0.04"/><body pos="0 0 0.4">
<joint name="push" type="slide" axis="0 0 1"/><geom type="box" size=".03 .03 .1"/>
</body></body></worldbody></mujoco>"""


@pytest.fixture
def arm(tmp_path):
    """A recording of an arm whose model lies beside it: a quarter turn, 5 cm out."""
    (tmp_path / "arm.xml").write_text(ARM)
    columns = {"time": [0.0, 0.01]}
    for joint, places in {"shoulder": [0, np.pi / 2], "push": [0, 0.05]}.items():
        columns[f"position.{joint}"] = columns[f"command.{joint}"] = places
    metadata = RecordingMetadata("arm.xml", "fixed", "a test")
    path = tmp_path / "swing.parquet"
    write_recording(Recording(columns, metadata), path)
    return path


def test_a_recording_of_any_model_is_shown_with_its_robot(arm):
    main(Visualize((arm,)))
    written = arm.with_suffix(".rrd")
    assert scenes_in(written) == {"/swing"}
    (place,) = (
        batch.column("Transform3D:translation")
        for chunk in RrdReader(written).stream().to_chunks()
        if chunk.entity_path == "/swing/robot/push"
        for batch in [chunk.to_record_batch()]
        if "Transform3D:translation" in batch.schema.names
    )
    last_m = place.flatten().flatten().to_numpy().reshape(-1, 3)[-1]
    np.testing.assert_allclose(last_m, [0.45, 0, 0.1], atol=1e-6)


def test_a_robot_that_is_no_model_is_named(tmp_path):
    path = tmp_path / "odd.parquet"
    write_recording(steady(robot="noa"), path)
    with pytest.raises(BadRecordingError, match="did you mean 'nao'"):
        main(Visualize((path,)))


def test_a_run_that_has_nothing_at_all(unfinished):
    (unfinished / "history.json").unlink()
    with pytest.raises(RunFolderError, match="no recordings"):
        main(Visualize((unfinished,)))


def test_a_folder_that_is_no_run(tmp_path):
    with pytest.raises(RunFolderError, match="is no run folder"):
        main(Visualize((tmp_path,)))


def test_the_viewer_gets_what_was_written(recording, monkeypatch, capsys):
    opened = []
    monkeypatch.setattr(visualize, "open_viewer", opened.extend)
    main(Visualize((recording,)))
    assert opened == []
    main(Visualize((recording,), open=True))
    assert opened == [recording.with_suffix(".rrd")]


@pytest.mark.parametrize(
    ("paths", "out", "error", "words"),
    [
        ((), None, BadValueError, "no run folder and no recording"),
        (("not there",), None, BadRecordingError, "not there: there is no such"),
        (("glide.parquet",), "glide.parquet", BadValueError, "exists already"),
        (("glide.parquet",), "glide.png", BadValueError, r"must end with \.rrd"),
    ],
)
def test_bad_input(recording, paths, out, error, words):
    folder = recording.parent
    out = out and folder / out
    with pytest.raises(error, match=words):
        Visualize(tuple(folder / path for path in paths), out=out)


def test_a_file_that_is_no_recording_is_named(tmp_path):
    path = tmp_path / "notes.txt"
    path.write_text("hello")
    with pytest.raises(BadRecordingError, match=r"notes\.txt: a recording is"):
        gather((path,))


def test_the_script_tells_in_one_line_what_is_wrong(tmp_path):
    command = [sys.executable, "-m", "experiments.visualize", "nothing.parquet"]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 2
    assert done.stdout == ""
    (line,) = done.stderr.splitlines()
    assert "nothing.parquet: there is no such run folder or recording" in line

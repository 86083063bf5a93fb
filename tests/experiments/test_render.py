import io
import subprocess
import sys

import numpy as np
import pytest
from made_up_runs import steady
from PIL import Image

from experiments.render import Render, main
from experiments.runs.folder import RunFolder
from experiments.seeing.film import GIF_BYTES, Film, film_bytes, window_s
from experiments.seeing.scenes import make_scenes
from groundwalk.errors import BadRecordingError, BadValueError, GroundwalkError
from worlds import write_recording

SMALL = {"width": 64, "height": 64}


@pytest.fixture
def recording(tmp_path):
    path = tmp_path / "glide.parquet"
    write_recording(steady(duration_s=1.0, end="fall"), path)
    return path


@pytest.fixture
def run(tmp_path):
    folder = RunFolder(tmp_path / "run")
    folder.write_json("config.json", {"verb": "evaluate"})
    for name in ("sim_start", "real_start"):
        path = folder.path / "recordings" / f"{name}.parquet"
        write_recording(steady(duration_s=1.0), path)
    return folder.path


def test_a_strip_has_a_row_for_each_walk(run, tmp_path, capsys):
    out = tmp_path / "strip.png"
    main(Render((run,), out=out, frames=3, **SMALL))
    assert capsys.readouterr().out.split() == [str(out)]
    with Image.open(out) as picture:
        assert picture.size == (3 * 64, 2 * (64 + 26))


def test_a_film_shows_walks_side_by_side_at_even_times(run, tmp_path):
    out = tmp_path / "film.gif"
    main(Render((run,), out=out, start=0.2, duration=0.4, rate=10, **SMALL))
    with Image.open(out) as film:
        assert film.size == (2 * 64, 64 + 26)
        assert film.n_frames == 5
        assert film.info["duration"] == 100
        assert film.info["loop"] == 0
    assert out.stat().st_size < GIF_BYTES


def test_only_some_of_a_run(run, tmp_path):
    out = tmp_path / "strip.png"
    main(Render((run,), out=out, only=("real",), frames=2, **SMALL))
    with Image.open(out) as picture:
        assert picture.size == (2 * 64, 64 + 26)
    as_file = Render((run,), out=tmp_path / "file.png", only=("real_start",), **SMALL)
    main(as_file)
    nothing = Render((run,), out=tmp_path / "no.png", only=("grounded",), **SMALL)
    with pytest.raises(GroundwalkError, match="no recordings with grounded"):
        main(nothing)


def test_the_last_moment_of_a_fall_is_red(recording):
    film = Film(
        make_scenes({"sim": steady(duration_s=1, end="fall")}),
        (90, 64),
        None,
        1.0,
        False,
    )
    before, after = (film.titled(0, time_s)[:26].astype(int) for time_s in (0.5, 1.2))

    def has_red(title):
        return (title[..., 0] > title[..., 1] + 100).any()

    assert not has_red(before)
    assert has_red(after)


def scenes(*durations_s, end=None):
    recordings = {
        f"walk{k}": steady(duration_s=duration_s, end=end)
        for k, duration_s in enumerate(durations_s)
    }
    return make_scenes(recordings)


def test_a_part_is_the_middle_or_the_first_fall():
    assert window_s(scenes(10.0), 3.0) == pytest.approx((3.5, 6.5))
    assert window_s(scenes(10.0, 4.0, end="fall"), 2.0) == pytest.approx((2.5, 4.5))
    assert window_s(scenes(1.0), 3.0) == pytest.approx((0.0, 1.0))


def test_without_ffmpeg_the_message_says_what_to_do(recording, tmp_path, monkeypatch):
    monkeypatch.setenv("PATH", str(tmp_path))
    with pytest.raises(GroundwalkError, match=r"ffmpeg.* or write a \.gif"):
        main(Render((recording,), out=tmp_path / "film.mp4", **SMALL))
    assert not (tmp_path / "film.mp4").exists()


def test_ffmpeg_gets_every_frame(tmp_path, monkeypatch):
    program = tmp_path / "ffmpeg"
    program.write_text('#!/bin/sh\nfor last; do :; done\ncat > "$last"\n')
    program.chmod(0o755)
    monkeypatch.setenv("PATH", f"{tmp_path}:/usr/bin:/bin")
    film = Film(scenes(1.0), (65, 64), 0.0, 0.1, False)
    frames = np.frombuffer(film_bytes(film, 10.0, ".mp4"), np.uint8)
    assert frames.size == 2 * 64 * 90 * 3
    program.write_text("#!/bin/sh\necho no such codec >&2\nexit 1\n")
    with pytest.raises(GroundwalkError, match="no such codec"):
        film_bytes(film, 10.0, ".mp4")


@pytest.mark.parametrize(
    ("options", "error", "words"),
    [
        ({"paths": ()}, BadValueError, "no run folder and no recording"),
        ({"paths": ("not there",)}, BadRecordingError, "not there: there is no such"),
        ({"out": "film.avi"}, BadValueError, r"must end with \.png, \.gif or \.mp4"),
        ({"out": "glide.parquet"}, BadValueError, "must end with"),
        ({"duration": 0.0}, BadValueError, "duration is 0"),
        ({"frames": 0}, BadValueError, "frames is 0"),
        ({"width": 10**6}, BadValueError, "width is"),
        ({"start": float("nan")}, BadValueError, "start is nan"),
    ],
)
def test_bad_input(recording, options, error, words):
    folder = recording.parent
    whole = {"paths": ("glide.parquet",), "out": "new.png"} | options
    paths = tuple(folder / path for path in whole.pop("paths"))
    with pytest.raises(error, match=words):
        Render(paths, **{**whole, "out": folder / whole["out"]})


def test_nothing_is_overwritten(recording):
    other = recording.with_suffix(".png")
    other.write_bytes(b"mine")
    with pytest.raises(BadValueError, match="exists already"):
        Render((recording,), out=other)


def test_no_engine_and_no_display_is_needed():
    code = (
        "import sys, experiments.render; "
        "sys.exit(any(name in sys.modules for name in ('pybullet', 'rerun', 'torch')))"
    )
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0


def test_a_gif_that_would_be_too_large_gets_fewer_colours(monkeypatch):
    from experiments.seeing import film as render_film

    frames = [np.random.default_rng(1).integers(0, 256, (40, 40, 3), np.uint8)] * 2

    def colours(most_bytes):
        monkeypatch.setattr(render_film, "GIF_BYTES", most_bytes)
        with Image.open(io.BytesIO(render_film.gif_bytes(frames, 10))) as film:
            return len(film.convert("RGB").getcolors())

    assert 16 >= colours(1) < colours(10**6)

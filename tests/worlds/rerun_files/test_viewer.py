import sys

import pytest

from groundwalk.errors import BadRecordingError, GroundwalkError
from worlds.rerun_files.viewer import open_viewer


@pytest.fixture
def recording(tmp_path):
    path = tmp_path / "walk.rrd"
    path.write_bytes(b"RRF2")
    return path


@pytest.fixture
def no_programs(tmp_path, monkeypatch):
    """A Python in a folder of its own, and nothing on the PATH."""
    folder = tmp_path / "bin"
    folder.mkdir()
    monkeypatch.setattr(sys, "executable", str(folder / "python"))
    monkeypatch.setenv("PATH", str(tmp_path / "nothing"))
    return folder


def test_the_viewer_listens_on_the_loopback_only(recording, no_programs, tmp_path):
    program = no_programs / "rerun"
    heard = tmp_path / "heard"
    program.write_text(f'#!/bin/sh\necho "$@" > {heard}\n')
    program.chmod(0o755)
    assert open_viewer([recording]).wait(30) == 0
    assert heard.read_text() == f"--bind 127.0.0.1 --port auto {recording}\n"


def test_without_the_program_the_message_says_what_to_do(recording, no_programs):
    with pytest.raises(GroundwalkError, match=r"install rerun-sdk, .*walk\.rrd"):
        open_viewer([recording])


def test_a_file_that_is_not_there_is_named(recording):
    missing = recording.with_name("missing.rrd")
    with pytest.raises(BadRecordingError, match=r"missing\.rrd: no such file"):
        open_viewer([recording, missing])

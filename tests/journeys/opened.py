"""Opens what a command wrote, as the one who reads it would."""

import json
import xml.etree.ElementTree as ElementTree

import PIL.Image

from experiments.planned_files import read_planned
from worlds import read_recording

RERUN_MAGIC = b"RRF2"


def _json(path):
    assert json.loads(path.read_text()), path


def _html(path):
    text = path.read_text()
    assert "</html>" in text, path
    assert "{{" not in text, f"{path}: a template's field is left open"
    assert "<h1" in text, path


def _markdown(path):
    text = path.read_text()
    assert text.startswith("# "), path
    assert "## " in text, path


def _picture(path):
    with PIL.Image.open(path) as picture:
        shades = picture.convert("L").getextrema()
    assert shades[0] < shades[1], f"{path}: nothing is drawn"


def _recording(path):
    assert read_recording(path).duration_s > 0, path


def _csv(path):
    """A recording, or commands to play, which have no positions."""
    header = path.read_text().partition("\n")[0]
    if "position." in header:
        _recording(path)
        return
    joints = [name.removeprefix("command.") for name in header.split(",")[1:]]
    time_s, command_rad = read_planned(path, joints)
    assert command_rad.shape == (len(time_s), len(joints)), path


def _rerun(path):
    content = path.read_bytes()
    assert content.startswith(RERUN_MAGIC), path
    assert len(content) > 1000, path


def _xml(path):
    root = ElementTree.parse(path).getroot()
    assert root.tag in ("robot", "mujoco"), path


def _python(path):
    compile(path.read_text(), path.name, "exec")


def _text(path):
    assert path.read_text().strip(), path


OPENERS = {
    ".json": _json, ".html": _html, ".md": _markdown, ".png": _picture,
    ".gif": _picture, ".parquet": _recording, ".csv": _csv, ".rrd": _rerun,
    ".urdf": _xml, ".xml": _xml, ".sha256": _text,
    ".py": _python,
}  # fmt: skip


def open_all(folder, patterns):
    """Open every file that the patterns name; each must name one at least."""
    for pattern in patterns:
        found = sorted(folder.glob(pattern))
        assert found, f"{pattern} was not written"
        for path in found:
            OPENERS[path.suffix](path)

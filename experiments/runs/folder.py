"""A run's folder: describes itself, resumes itself, and is never overwritten."""

import dataclasses
import datetime
import json
import platform
import subprocess
import sys
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Any, Self, TypeVar

from experiments.runs.options import RunOptions, options_of
from experiments.runs.repeat_command import repeat_command
from groundwalk import __version__, json_data
from groundwalk.errors import BadValueError, RunFolderError
from groundwalk.files import write_bytes, write_text

CONFIG, PROVENANCE, RESULT = "config.json", "provenance.json", "result.json"
CHECKPOINT, HISTORY, RECORDINGS = "checkpoint.pkl", "history.json", "recordings"
FREE_WHEN_RESUMED = frozenset({"out", "resume", "json", "threads"})
PACKAGES = (
    "mujoco", "pybullet", "cma", "numpy", "scipy", "rerun-sdk", "pyarrow", "torch",
)  # fmt: skip
_CODE = ("commit", "changed")
_SOURCES = (":(top)", ":(top,exclude)docs/results")
"""What runs, for git: results that were just written anew change nothing of it."""

Config = TypeVar("Config", bound=RunOptions)


class RunFolder:
    """Where a run keeps its configuration, state and results."""

    def __init__(self, path: Path) -> None:
        """Use `create` or `at`."""
        self.path = path

    @classmethod
    def create(cls, verb: str, config: Any) -> Self:
        """A new folder with the resolved configuration and where the code comes from.

        Args:
          verb: what runs, as on the command line.
          config: its configuration, a dataclass with `out` and `seed`; where `out` is
            None, the folder is `runs/<verb>/<date>_<time>_s<seed>`.

        Raises:
          RunFolderError: the folder is there already.
        """
        path = config.out
        if path is None:
            now = datetime.datetime.now().strftime("%Y-%m-%d_%H-%M-%S")
            path = Path("runs", verb, f"{now}_s{config.seed}")
        check_free(path)
        folder = cls(path)
        folder.write_json(CONFIG, {"verb": verb, **to_plain(config)})
        command = {"command": repeat_command(verb, config)}
        folder.write_json(PROVENANCE, command | provenance())
        return folder

    @classmethod
    def at(cls, path: Path, verb: str | None = None) -> Self:
        """The folder of an earlier run.

        Raises:
          RunFolderError: it is not there, or not of this verb.
        """
        if not (path / CONFIG).is_file():
            raise RunFolderError(f"{path} is no run folder: it holds no {CONFIG}")
        folder = cls(path)
        there = folder.read_json(CONFIG).get("verb")
        if verb not in (None, there):
            raise RunFolderError(f"{path} holds a run of {there}, not of {verb}")
        return folder

    def note_resumed(self) -> None:
        """Write down the code that goes on, if it is not the one that began."""
        began = self.read_json(PROVENANCE)
        known = [began, *began.get("resumed", [])]
        now = {key: value for key, value in provenance().items() if key in _CODE}
        if all(now != {key: one.get(key) for key in _CODE} for one in known):
            began["resumed"] = [*known[1:], now]
            self.write_json(PROVENANCE, began)

    def write_json(self, name: str, content: Any) -> None:
        """Write a file of plain values at once."""
        self.write_text(name, json.dumps(content, indent=1) + "\n")

    def write_text(self, name: str, content: str) -> None:
        """Write a file at once."""
        write_text(self.path / name, content)

    def write_bytes(self, name: str, content: bytes) -> None:
        """Write a file at once."""
        write_bytes(self.path / name, content)

    def read_json(self, name: str) -> dict[str, Any]:
        """Read a file of plain values.

        Raises:
          RunFolderError: it is not there or cannot be read.
        """
        path = self.path / name
        try:
            content = json.loads(path.read_text())
        except FileNotFoundError:
            raise RunFolderError(
                f"{path} is missing: the run did not get there"
            ) from None
        except (json.JSONDecodeError, UnicodeDecodeError) as error:
            raise RunFolderError(f"{path} cannot be read: {error}") from None
        if not isinstance(content, dict):
            raise RunFolderError(f"{path} must hold a table")
        return content

    def has(self, name: str) -> bool:
        """Whether a file of that name is there."""
        return (self.path / name).exists()


def check_free(path: Path | None) -> None:
    """Refuse a folder that is there already: no run is overwritten.

    Raises:
      RunFolderError: it is.
    """
    if path is not None and path.exists():
        raise RunFolderError(
            f"{path} exists already: choose another --out, or continue it with "
            f"--resume {path}"
        )


def check_new(path: Path, suffix: str = "") -> None:
    """Refuse a path at which no new file can be made.

    Args:
      path: as given with --out.
      suffix: what its name must end with.

    Raises:
      BadValueError: there is something already, or the name ends otherwise.
    """
    if path.exists():
        raise BadValueError(f"{path} exists already: choose another --out")
    if not path.name.endswith(suffix):
        raise BadValueError(f"{path} must end with {suffix}")


def open_run(verb: str, config: Config) -> tuple[RunFolder, Config]:
    """The folder of a run that begins or goes on, and its configuration.

    Args:
      verb: what runs, as on the command line.
      config: a frozen dataclass. When a run is resumed, what it was started with
        counts.

    Raises:
      RunFolderError: the folder is in the way, or is none to resume.
      BadValueError: a resumed run is asked for something else than it was started with.
    """
    if config.resume is None:
        return RunFolder.create(verb, config), config
    folder = RunFolder.at(config.resume, verb)
    stored = folder.read_json(CONFIG)
    changes: dict[str, Any] = {}
    for field in options_of(config):
        if field.name in FREE_WHEN_RESUMED:
            continue
        given = getattr(config, field.name)
        before = field.default  # of an option that the run's version did not have
        if field.name in stored:
            kind: Any = field.type
            before = json_data.from_plain(kind, stored[field.name], field.name)
        if given not in (field.default, before):
            raise BadValueError(
                f"{field.name} cannot change from {before} to {given} when a run is "
                "resumed; leave it out"
            )
        changes[field.name] = before
    folder.note_resumed()
    return folder, dataclasses.replace(config, **changes)


def to_plain(config: Any) -> dict[str, Any]:
    """A configuration as values that JSON knows; paths become text."""
    plain = json_data.to_plain(config)
    return {one.name: plain[one.name] for one in options_of(config)}


def provenance() -> dict[str, Any]:
    """Versions and commit of the code that runs, and on what."""
    return {
        "groundwalk": __version__,
        "python": platform.python_version(),
        "platform": platform.platform(),
        "arguments": sys.argv[1:],
        "packages": {name: _version(name) for name in PACKAGES},
        "commit": _git("rev-parse", "HEAD"),
        "changed": _git("status", "--porcelain", "--", *_SOURCES),
    }


def _version(package: str) -> str | None:
    try:
        return version(package)
    except PackageNotFoundError:
        return None


def _git(*arguments: str) -> str | None:
    """What git says of the folder that holds this code; None outside a repository."""
    try:
        answer = subprocess.run(
            ["git", *arguments],
            cwd=Path(__file__).parent,
            capture_output=True,
            text=True,
            check=True,
        )
    except (OSError, subprocess.CalledProcessError):
        return None
    return answer.stdout.strip()

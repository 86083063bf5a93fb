"""The locked folder of a run: configuration, state and results; never overwritten."""

import dataclasses
import datetime
import fcntl
import json
import os
import platform
import subprocess
import sys
import weakref
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Any, ClassVar, Self, TypeVar

from experiments.runs.options import RunOptions, options_of, repeat_command
from groundwalk import __version__, json_data
from groundwalk.errors import BadValueError, RunFolderError
from groundwalk.files import write_text

LOCK = ".lock"
"""Name of the lock file in a run folder; it holds the ID of the process."""


class FolderLock:
    """Keeps other processes out of a folder for as long as this object lives.

    The operating system releases the lock when the process dies, so that the folder of
    a killed run can be used at once. One process can lock the same folder repeatedly.
    """

    _held: ClassVar["weakref.WeakValueDictionary[Path, FolderLock]"] = (
        weakref.WeakValueDictionary()
    )

    def __init__(self, folder: Path) -> None:
        """Lock a folder. Call `of` instead: it reuses a lock of this process."""
        file = os.open(folder / LOCK, os.O_RDWR | os.O_CREAT)
        try:
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            process = os.read(file, 20).decode() or "another"
            os.close(file)
            raise RunFolderError(
                f"{folder} is in use by process {process}: wait until it ends, or "
                "choose another folder"
            ) from None
        except OSError:
            pass  # a file system without locks, such as some network folders
        weakref.finalize(self, os.close, file)
        os.ftruncate(file, 0)
        os.write(file, str(os.getpid()).encode())

    @classmethod
    def of(cls, folder: Path) -> Self:
        """Lock a folder that exists; RunFolderError if another process has it."""
        key = folder.resolve()
        lock = cls._held.get(key)
        if not isinstance(lock, cls):
            lock = cls._held[key] = cls(folder)
        return lock


CONFIG, PROVENANCE, RESULT = "config.json", "provenance.json", "result.json"
CHECKPOINT, HISTORY, RECORDINGS = "checkpoint.json", "history.json", "recordings"
FREE_WHEN_RESUMED = frozenset({"out", "resume", "json", "threads"})
PACKAGES = (
    "mujoco", "pybullet", "cma", "numpy", "scipy", "rerun-sdk", "pyarrow", "torch",
)  # fmt: skip
FILE_ENDS = frozenset({".toml", ".urdf", ".xml", ".json"})
"""Endings by which an option's text, such as --robot, is known to be a file name."""

_SOURCES = (":(top)", ":(top,exclude)docs/results")
"""Files that git checks for uncommitted changes: all but the stored results, which do
not change the code (a pathspec of git)."""

Config = TypeVar("Config", bound=Any)


class RunFolder:
    """The folder in which a run keeps its configuration, state and results.

    Example:
      >>> scores = RunFolder.at(Path("runs/mine")).read_json("result.json")
    """

    def __init__(self, path: Path) -> None:
        """Use a folder without any check; `create` and `at` check it."""
        self.path = path
        self._lock: FolderLock | None = None

    def lock(self) -> None:
        """Keep other processes out of the folder for as long as this object lives."""
        self._lock = FolderLock.of(self.path)

    @classmethod
    def create(cls, verb: str, config: Any) -> Self:
        """Make a new folder; write the configuration and the code's version into it.

        `config` is a dataclass of options with `out` and `seed`; if `out` is None, the
        folder is `runs/<verb>/<date>_<time>_s<seed>`.
        """
        path = config.out
        if path is None:
            now = datetime.datetime.now().strftime("%Y-%m-%d_%H-%M-%S")
            path = Path("runs", verb, f"{now}_s{config.seed}")
        check_free(path, resumable=isinstance(config, RunOptions))
        path.mkdir(parents=True)
        folder = cls(path)
        folder.lock()
        folder.write_json(CONFIG, {"verb": verb, **to_plain(with_whole_paths(config))})
        folder.write_json(PROVENANCE, provenance(verb, config))
        return folder

    @classmethod
    def at(cls, path: Path, verb: str | None = None) -> Self:
        """Open the folder of an earlier run, made by the verb if one is given."""
        if not (path / CONFIG).is_file():
            raise RunFolderError(f"{path} is no run folder: it holds no {CONFIG}")
        folder = cls(path)
        there = folder.read_json(CONFIG).get("verb")
        if verb not in (None, there):
            raise RunFolderError(f"{path} holds a run of {there}, not of {verb}")
        return folder

    def note_resumed(self) -> None:
        """Add the version of the code that resumes the run to its provenance.json."""
        began = self.read_json(PROVENANCE)
        known = [began, *began.get("resumed", [])]
        now = _code()
        if all(now != {key: one.get(key) for key in now} for one in known):
            began["resumed"] = [*known[1:], now]
            self.write_json(PROVENANCE, began)

    def write_json(self, name: str, content: Any) -> None:
        """Write a JSON file into the folder; after an error no partial file remains."""
        self.write_text(name, json.dumps(content, indent=1) + "\n")

    def write_text(self, name: str, content: str) -> None:
        """Write a text file; after an error no partial file remains."""
        write_text(self.path / name, content)

    def read_json(self, name: str) -> dict[str, Any]:
        """Read a JSON file whose content is an object (a dict); else RunFolderError."""
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
        """Whether the folder holds a file of that name."""
        return (self.path / name).exists()


def check_free(path: Path | None, resumable: bool = False) -> None:
    """Refuse a folder (None: a new one) that exists already: no run is overwritten.

    The message of the RunFolderError advises the option --resume if `resumable`.
    """
    if path is not None and path.exists():
        resume = f", or continue it with --resume {path}" if resumable else ""
        raise RunFolderError(f"{path} exists already: choose another --out{resume}")


def check_new(path: Path, suffix: str = "") -> None:
    """Refuse the path of an output file that exists or does not end with `suffix`."""
    if path.exists():
        raise BadValueError(f"{path} exists already: choose another --out")
    if not path.name.endswith(suffix):
        raise BadValueError(f"{path} must end with {suffix}")


def open_run(verb: str, config: Config, may_grow: str = "") -> tuple[RunFolder, Config]:
    """Create the folder of a new run, or open the one that is resumed.

    The folder is locked: no other process can open the run until this one ends or
    forgets the folder.

    `config` is a frozen dataclass of options; a resumed run keeps those that it was
    started with, and refuses others. The option `may_grow` may be larger when the run
    is resumed: the result is then deleted, so that the run continues beyond its former
    end. The result is the folder, and the options to use, with absolute paths.
    """
    config = with_whole_paths(config)
    if config.resume is None:
        return RunFolder.create(verb, config), config
    folder = RunFolder.at(config.resume, verb)
    folder.lock()
    stored = folder.read_json(CONFIG)
    changes: dict[str, Any] = {}
    grows = False
    for field in options_of(config):
        if field.name in FREE_WHEN_RESUMED:
            continue
        given = getattr(config, field.name)
        before = field.default  # of an option that the run's version did not have
        if field.name in stored:
            kind: Any = field.type
            before = json_data.from_plain(kind, stored[field.name], field.name)
        changes[field.name] = before
        if given is field.default or given in (before, _whole(before)):
            continue
        if field.name == may_grow and given > before:
            changes[field.name] = stored[field.name] = given
            grows = True
        elif given != field.default:
            raise BadValueError(
                f"{field.name} cannot change from {before} to {given} when a run is "
                "resumed; leave it out"
            )
    if grows:
        (folder.path / RESULT).unlink(missing_ok=True)
        folder.write_json(CONFIG, stored)
    folder.note_resumed()
    return folder, dataclasses.replace(config, **changes)


def with_whole_paths(config: Config) -> Config:
    """Make all file paths of a frozen dataclass of options absolute.

    The files are then found from any folder. `out` and `resume` stay as they are.
    """
    changes = {}
    for field in options_of(config):
        value = getattr(config, field.name)
        if field.name not in FREE_WHEN_RESUMED and _whole(value) != value:
            changes[field.name] = _whole(value)
    return dataclasses.replace(config, **changes) if changes else config


def _whole(value: Any) -> Any:
    """Make a path, or a text that names an existing file, an absolute path."""
    if isinstance(value, tuple):
        return tuple(map(_whole, value))
    if isinstance(value, Path):
        return Path(os.path.abspath(value))
    if isinstance(value, str):
        is_file = Path(value).suffix in FILE_ENDS or os.sep in value
        return os.path.abspath(value) if is_file and Path(value).exists() else value
    return value


def to_plain(config: Any) -> dict[str, Any]:
    """Options by name, as values that JSON can store; paths become texts."""
    plain = json_data.to_plain(config)
    return {one.name: plain[one.name] for one in options_of(config)}


def provenance(verb: str, config: Any) -> dict[str, Any]:
    """Command that repeats a run, platform, versions of the code and its packages."""
    return {
        "command": repeat_command(verb, config),
        "groundwalk": __version__,
        "python": platform.python_version(),
        "platform": platform.platform(),
        "arguments": sys.argv[1:],
        "packages": {name: _version(name) for name in PACKAGES},
        **_code(),
    }


def _code() -> dict[str, str | None]:
    """Git commit of the code, and its files with uncommitted changes."""
    changed = _git("status", "--porcelain", "--", *_SOURCES)
    return {"commit": _git("rev-parse", "HEAD"), "changed": changed}


def _version(package: str) -> str | None:
    try:
        return version(package)
    except PackageNotFoundError:
        return None


def _git(*arguments: str) -> str | None:
    """Output of a git command in the folder of this code; None outside a repository."""
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

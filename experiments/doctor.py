"""`groundwalk doctor`: says what is installed, what is missing, and how to fix it.

The checks are of Python, packages, robot files, viewer and folder. They use only the
standard library, so that they work when every package is missing.
"""

import argparse
import dataclasses
import enum
import importlib.metadata
import json
import os
import re
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from importlib.metadata import PackageNotFoundError
from pathlib import Path

from experiments.reports.tables import print_table

TESTED_PYTHON = (3, 11)

PINS = Path(__file__).resolve().parents[1] / "constraints.txt"
"""File with the tested package versions; an installed groundwalk does not have it."""

IMPORTS = {
    "absl-py": "absl",
    "example-robot-data": "",  # files only
    "mujoco": "mujoco.batch",
    "markdown-it-py": "markdown_it",
    "pyyaml": "yaml",
    "rerun-sdk": "rerun",
    "sb3-contrib": "sb3_contrib",
}
"""Module whose import checks a package, where it is not named like the package; ""
for a package without a module."""


class State(enum.StrEnum):
    """Severity of a finding of `groundwalk doctor`."""

    OK = "ok"
    NOTE = "note"
    """A package works in another version than tested, or is optional and missing."""
    FAIL = "fail"


@dataclass(frozen=True)
class Finding:
    """The result of one check of `groundwalk doctor`.

    Attributes:
      name: the thing that was checked, such as a package.
      state: severity.
      found: the version or file found, or a word such as "missing".
      advice: what the user should do; "" for nothing.
    """

    name: str
    state: State
    found: str
    advice: str = ""


def check_python(version: tuple[int, int]) -> Finding:
    """Check whether groundwalk supports this major and minor version of Python."""
    found = ".".join(map(str, version))
    if version == TESTED_PYTHON:
        return Finding("Python", State.OK, found)
    state = State.NOTE if version > TESTED_PYTHON else State.FAIL
    return Finding("Python", state, found, "3.11 is tested: make PYTHON=python3.11 env")


def import_problem(module: str) -> str:
    """Import a module, and return the last line of the error; "" if it works.

    Another process does it, because a physics engine may print from C, or crash.
    """
    done = subprocess.run(
        [sys.executable, "-c", f"import {module}"],
        capture_output=True,
        text=True,
        errors="replace",
    )
    if done.returncode == 0:
        return ""
    said = done.stderr.strip().splitlines()
    return said[-1] if said else f"exit status {done.returncode}"


def check_package(
    requirement: str,
    tested: str | None,
    find_version: Callable[[str], str] = importlib.metadata.version,
    find_problem: Callable[[str], str] = import_problem,
) -> Finding:
    """Check that a package is installed, new enough, and can be imported.

    Args:
      requirement: name and lowest version, such as "mujoco>=4.0".
      tested: the version that groundwalk is tested with; None if not known.
      find_version: returns a package's version or raises PackageNotFoundError.
      find_problem: imports a module and returns the error's text, "" if it works.
    """
    name, least = requirement.split(">=")
    wanted = f"{name}=={tested}" if tested else f"'{requirement}'"
    install = f"pip install {wanted}"
    try:
        version = find_version(name)
    except PackageNotFoundError:
        return Finding(name, State.FAIL, "not installed", install)
    found = f"{version} (needs >={least}, tested {tested or 'unknown'})"
    if _numbers(version) < _numbers(least):
        return Finding(name, State.FAIL, found, install)
    module = IMPORTS.get(name, name)
    if problem := module and find_problem(module):
        reinstall = f"pip install --force-reinstall {wanted}"
        return Finding(name, State.FAIL, f"{version}: {problem}", reinstall)
    public, _, _ = version.partition("+")  # "2.13.0+cpu" is a build of 2.13.0
    if tested and public != tested:
        return Finding(name, State.NOTE, found, install)
    return Finding(name, State.OK, found)


def check_packages() -> list[Finding]:
    """Check all packages that groundwalk requires."""
    try:
        declared = importlib.metadata.requires("groundwalk") or []
    except PackageNotFoundError:
        return [Finding("groundwalk", State.FAIL, "not installed", "make env")]
    pins = _pins(PINS)
    required = [line for line in declared if ";" not in line]  # none of the extras
    tested = [pins.get(line.split(">=")[0]) for line in required]
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        return list(pool.map(check_package, required, tested))


def check_robot_files(files: Sequence[Path]) -> Finding:
    """Check that `files`, all that the package example-robot-data lists, exist."""
    install = "pip install --force-reinstall --no-deps example-robot-data"
    urdfs = [file for file in files if file.suffix == ".urdf"]
    meshes = [file for file in files if file.suffix.lower() in {".dae", ".obj", ".stl"}]
    lost = sum(not file.is_file() for file in urdfs + meshes)
    found = f"{len(urdfs)} URDFs and {len(meshes)} meshes, {lost} of them lost"
    state = State.OK if urdfs and meshes and not lost else State.FAIL
    advice = install if state is State.FAIL else ""
    return Finding("robot files", state, found, advice)


def check_viewer(path: str) -> Finding:
    """Check that Rerun's viewer is in a folder of `path` (as the variable PATH)."""
    viewer = shutil.which("rerun", path=path)
    if viewer is None:
        advice = "to open recordings here: pip install rerun-sdk"
        return Finding("Rerun viewer", State.NOTE, "not found", advice)
    return Finding("Rerun viewer", State.OK, viewer)


def check_folder(folder: Path) -> Finding:
    """Check that files can be written into a folder, by writing one."""
    try:
        with tempfile.TemporaryFile(dir=folder):
            return Finding("this folder", State.OK, "can be written to")
    except OSError as error:
        advice = "go to a folder that can be written to"
        return Finding("this folder", State.FAIL, str(error.strerror), advice)


def examine() -> list[Finding]:
    """Run all checks on this machine."""
    beside = str(Path(sys.executable).parent)
    return [
        check_python(sys.version_info[:2]),
        *check_packages(),
        check_robot_files(_files_of("example-robot-data")),
        check_viewer(os.pathsep.join([beside, os.environ.get("PATH", "")])),
        Finding("cores", State.OK, str(os.cpu_count())),
        check_folder(Path.cwd()),
    ]


def _numbers(version: str) -> list[int]:
    return [int(number) for number in re.findall(r"\d+", version)]


def _pins(path: Path) -> dict[str, str]:
    if not path.is_file():
        return {}
    lines = path.read_text().splitlines()
    return dict(line.split("==") for line in lines if "==" in line)


def _files_of(package: str) -> list[Path]:
    try:
        files = importlib.metadata.files(package) or []
    except PackageNotFoundError:
        return []
    return [Path(str(file.locate())) for file in files]


COLOURS = {State.OK: "green", State.NOTE: "yellow", State.FAIL: "red"}


@dataclass(frozen=True)
class DoctorConfig:
    """Say what is installed, what is missing and what to do about it."""

    json: bool = False
    """Print the findings as JSON."""


def print_findings(findings: Sequence[Finding]) -> None:
    """Print the findings as a table, one line each; in colours on a terminal."""
    rows = [(one.state, one.name, one.found, one.advice) for one in findings]
    colours = [COLOURS[one.state] for one in findings]
    print_table(("", "what", "found", "what to do"), rows, colours)


def main(config: DoctorConfig) -> int:
    """Print the findings of all checks; the exit status is 1 if one fails."""
    findings = examine()
    works = all(finding.state is not State.FAIL for finding in findings)
    if config.json:
        rows = [dataclasses.asdict(finding) for finding in findings]
        print(json.dumps({"works": works, "findings": rows}, indent=2))
    else:
        print_findings(findings)
    return 0 if works else 1


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=DoctorConfig.__doc__)
    parser.add_argument("--json", action="store_true", help="findings as JSON")
    sys.exit(main(DoctorConfig(**vars(parser.parse_args()))))

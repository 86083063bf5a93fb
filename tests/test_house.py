"""The house itself: what is pinned, which Python will do, what may be in git."""

import re
import subprocess
import tomllib
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text())
CONSTRAINTS = (ROOT / "constraints.txt").read_text().splitlines()
LIMIT_BYTES = 1_000_000


# Versions


def direct_dependencies():
    project = PROJECT["project"]
    extras = project["optional-dependencies"].values()
    return [*project["dependencies"], *(line for extra in extras for line in extra)]


def test_every_line_of_the_constraints_is_an_exact_version():
    lines = [line for line in CONSTRAINTS if not line.startswith("#")]
    exact = re.compile(r"[A-Za-z0-9._-]+==[0-9][0-9A-Za-z.]*")
    assert [line for line in lines if not exact.fullmatch(line)] == []
    names = [line.split("==")[0].lower() for line in lines]
    assert len(names) == len(set(names))


def test_every_direct_dependency_is_pinned():
    pinned = {line.split("==")[0] for line in CONSTRAINTS}
    lower_bound = re.compile(r"([a-z0-9-]+)>=[0-9.]+")  # what the doctor can read
    names = [lower_bound.fullmatch(line)[1] for line in direct_dependencies()]
    assert set(names) <= pinned


@pytest.mark.parametrize(
    "pin",
    [
        "mujoco==4.0.0",
        "pybullet==3.2.7",
        "cma==4.5.0",
        "example-robot-data==6.0.0",
        "rerun-sdk==0.41.0",
        "torch==2.13.0",
    ],
)
def test_the_versions_that_the_results_stand_on(pin):
    assert pin in CONSTRAINTS


# The Python that makes the environment


def check_python(tmp_path, says, compiler):
    """Let the check meet a Python of some version, and a compiler or none."""
    (tmp_path / "python").write_text(f"#!/bin/sh\n{says}\n")
    (tmp_path / "python").chmod(0o755)
    (tmp_path / "tools").mkdir()
    if compiler:
        (tmp_path / "tools" / compiler).touch(mode=0o755)
    return subprocess.run(
        ["/bin/sh", ROOT / ".ci" / "check-python", tmp_path / "python"],
        env={"PATH": str(tmp_path / "tools")},
        capture_output=True,
        text=True,
    )


@pytest.mark.parametrize(
    ("says", "compiler", "status", "words"),
    [
        ("echo 3.11", None, 0, None),
        ("echo 3.13", "clang++", 0, "will be compiled"),
        ("echo 3.13", None, 1, "no C++ compiler"),
        ("echo 3.10", "c++", 1, "needs Python 3.11"),
        ("echo 2.7", "c++", 1, "needs Python 3.11"),
        ("exit 127", "c++", 1, "not there"),
    ],
)
def test_what_a_python_is_told(tmp_path, says, compiler, status, words):
    done = check_python(tmp_path, says, compiler)
    told = (done.stdout + done.stderr).splitlines()
    assert done.returncode == status
    assert len(told) == (words is not None)
    assert words is None or words in told[0]


# Files


def files_of_the_project():
    """Everything that git has, or would take."""
    if not (ROOT / ".git").exists():
        pytest.skip("no git checkout")
    command = ["git", "ls-files", "-z", "--cached", "--others", "--exclude-standard"]
    listed = subprocess.run(command, cwd=ROOT, capture_output=True, check=True)
    names = listed.stdout.decode().split("\0")
    return [ROOT / name for name in names if (ROOT / name).is_file()]


def names_a_place(text):
    """Whether a text holds a path that only exists on some machine."""
    places = rf"{re.escape(str(ROOT))}/|/(?:home|root|Users|work)/[\w.]"
    return re.search(rf"(?<![\w.~/-])(?:{places})", text) is not None


def test_files_are_small():
    sizes = {path: path.stat().st_size for path in files_of_the_project()}
    assert len(sizes) > 20
    assert [path for path, size in sizes.items() if size > LIMIT_BYTES] == []


def test_no_file_names_a_place_on_this_machine():
    guilty = [
        path
        for path in files_of_the_project()
        if names_a_place(path.read_bytes().decode(errors="ignore"))
    ]
    assert guilty == []


def test_places_are_recognised():
    assert names_a_place(f"see {ROOT}/README.md")
    assert names_a_place("see " + "/".join(["", "home", "someone", "notes"]))
    assert not names_a_place(f"see docs{ROOT}/README.md")
    assert not names_a_place("see worlds/home/base and https://a.org/home/b")

"""Who may import whom, and that it is noticed when somebody does not care."""

import os
import re
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text())
HEAVY = {"mujoco", "pybullet", "rerun", "rosbags", "cma", "torch", "matplotlib"}


def lint_imports(folder):
    command = [Path(sys.executable).with_name("lint-imports"), "--no-logo"]
    environment = os.environ | {"COLUMNS": "200"}
    return subprocess.run(
        [*command, "--no-cache"],
        cwd=folder,
        env=environment,
        capture_output=True,
        text=True,
    )


@pytest.fixture
def small_house(tmp_path):
    """Empty rooms under our own contracts, with the imports that are allowed."""
    files = {
        "terrain/field.py": "import groundwalk",
        "robots/model.py": "def model():\n    import mujoco",
        "worlds/rerun_files/log.py": "import rerun, terrain",
        "worlds/foreign/bags.py": "import rosbags",
        "worlds/real/world.py": "def real():\n    import pybullet, robots",
        "walk_engine/engine.py": "from robots import model",
        "sgat/models/transition_models.py": "import torch, worlds",
        "experiments/walking/search.py": "import cma, sgat, walk_engine, worlds",
    }
    (tmp_path / "pyproject.toml").write_bytes((ROOT / "pyproject.toml").read_bytes())
    for package in PROJECT["tool"]["importlinter"]["root_packages"]:
        (tmp_path / package).mkdir()
        (tmp_path / package / "__init__.py").touch()
    for contract in PROJECT["tool"]["importlinter"]["contracts"]:
        for room in contract.get("containers", ()):
            for shelf in re.findall(r"[\w.]+", " ".join(contract["layers"])):
                folder = tmp_path / room
                for part in shelf.split("."):
                    folder = folder / part
                    folder.mkdir(exist_ok=True)
                    (folder / "__init__.py").touch()
    for name, code in files.items():
        path = tmp_path / name
        for folder in path.relative_to(tmp_path).parents:
            (tmp_path / folder).mkdir(exist_ok=True)
            (tmp_path / folder / "__init__.py").touch()
        path.write_text(f"{code}\n")
    return tmp_path


def test_the_contracts_know_every_room():
    rooms = {path.parent.name for path in ROOT.glob("*/__init__.py")}
    rooms -= {"tests", "benchmarks"}
    tool = PROJECT["tool"]
    assert set(tool["importlinter"]["root_packages"]) == rooms
    assert set(tool["hatch"]["build"]["targets"]["wheel"]["packages"]) == rooms
    assert set(tool["mypy"]["packages"]) >= rooms
    (layers,) = (
        contract["layers"]
        for contract in tool["importlinter"]["contracts"]
        if contract["name"] == "imports point one way"
    )
    assert set(re.findall(r"\w+", " ".join(layers))) >= rooms


def test_allowed_imports_pass(small_house):
    done = lint_imports(small_house)
    assert done.returncode == 0, done.stdout


FORBIDDEN = (
    ("groundwalk", "terrain"),
    ("robots", "worlds"),
    ("robots", "terrain"),
    ("terrain", "robots"),
    ("walk_engine", "worlds"),
    ("worlds", "walk_engine"),
    ("worlds", "experiments"),
    ("terrain", "mujoco"),
    ("walk_engine", "mujoco"),
    ("experiments", "mujoco"),
    ("robots", "pybullet"),
    ("experiments", "pybullet"),
    ("experiments", "cma"),
    ("worlds", "rerun"),
    ("experiments", "rerun"),
    ("experiments", "rosbags"),
    ("worlds", "rosbags"),
    ("worlds", "sgat"),
    ("sgat", "experiments"),
    ("sgat", "mujoco"),
    ("worlds", "torch"),
    ("experiments", "torch"),
)


def test_forbidden_imports_are_caught(small_house):
    for importer, imported in FORBIDDEN:
        hidden = f"def inside():\n    import {imported}\n"
        (small_house / importer / f"wrong_{imported}.py").write_text(hidden)
    done = lint_imports(small_house)
    assert done.returncode == 1
    missed = [
        (importer, imported)
        for importer, imported in FORBIDDEN
        if not re.search(rf"{importer}\.wrong_{imported}\W+{imported}", done.stdout)
    ]
    assert missed == [], done.stdout


@pytest.mark.parametrize(
    ("room", "lower", "higher"),
    [("sgat", "models", "walks"), ("experiments", "seeing", "optimize_gait")],
)
def test_shelves_are_layered(small_house, room, lower, higher):
    (small_house / room / higher / "thing.py").touch()
    wrong = small_house / room / lower / "wrong.py"
    wrong.write_text(f"def inside():\n    import {room}.{higher}.thing\n")
    done = lint_imports(small_house)
    assert done.returncode == 1
    found = re.search(rf"{room}\.{lower}\.wrong\W+{room}\.{higher}", done.stdout)
    assert found, done.stdout


def heavy_imports_after(code):
    code += "\nimport sys\nprint('', *sys.modules, sep='\\n')"
    done = subprocess.run(
        [sys.executable, "-c", code],
        cwd=ROOT,
        capture_output=True,
        text=True,
        check=True,
    )
    return HEAVY & set(done.stdout.splitlines())


def test_importing_is_light():
    light = (
        "groundwalk", "terrain", "robots", "walk_engine", "worlds", "sgat",
        "experiments.command_line",
    )  # fmt: skip
    assert heavy_imports_after(f"import {', '.join(light)}") == set()


def test_asking_the_command_for_help_is_light():
    code = """
import sys
from experiments.command_line import main
sys.argv = ["groundwalk", "--help"]
try:
    main()
except SystemExit as stop:
    assert not stop.code
"""
    assert heavy_imports_after(code) == set()


def test_heavy_imports_are_noticed():
    assert heavy_imports_after("import mujoco") == {"mujoco"}

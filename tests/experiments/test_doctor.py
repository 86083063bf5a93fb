import importlib
import json
import sys
import tomllib
from functools import partial
from importlib.metadata import PackageNotFoundError
from pathlib import Path

import pytest

from experiments import doctor
from experiments.doctor import (
    DoctorConfig,
    Finding,
    State,
    check_folder,
    check_package,
    check_packages,
    check_python,
    check_robot_files,
    check_viewer,
    import_problem,
    main,
    print_findings,
)

PYPROJECT = Path(__file__).parents[2] / "pyproject.toml"
MISSING = Finding("mujoco", State.FAIL, "not installed", "pip install mujoco==4.0.0")
FINE = Finding("numpy", State.OK, "2.4.6")
UNTESTED = Finding("Python", State.NOTE, "3.13", "[bold]use 3.11[/]")


def absent(name):
    raise PackageNotFoundError(name)


def no_problem(module):
    return ""


@pytest.mark.parametrize(
    ("version", "state"),
    [
        ((3, 11), State.OK),
        ((3, 13), State.NOTE),
        ((4, 0), State.NOTE),
        ((3, 9), State.FAIL),
    ],
)
def test_python(version, state):
    assert check_python(version).state is state


def test_a_missing_package_is_named_with_what_to_do():
    finding = check_package("mujoco>=4.0", "4.0.0", absent, no_problem)
    assert finding == MISSING


def test_a_missing_package_without_a_tested_version():
    finding = check_package("mujoco>=4.0", None, absent, no_problem)
    assert finding.advice == "pip install 'mujoco>=4.0'"


@pytest.mark.parametrize(
    ("version", "state"),
    [
        ("4.0.0", State.OK),
        ("4.10.1", State.NOTE),
        ("3.10.0", State.FAIL),
        ("3.9", State.FAIL),
    ],
)
def test_versions(version, state):
    finding = check_package("mujoco>=4.0", "4.0.0", lambda _: version, no_problem)
    assert finding.state is state
    assert version in finding.found
    assert bool(finding.advice) == (state is not State.OK)


def test_without_pins_every_new_enough_version_is_fine():
    finding = check_package("mujoco>=4.0", None, lambda _: "5.1", no_problem)
    assert finding.state is State.OK


def test_a_package_that_cannot_be_imported():
    asked = []

    def broken(module):
        asked.append(module)
        return "ImportError: no libGL"

    finding = check_package("rerun-sdk>=0.41", "0.41.0", lambda _: "0.41.0", broken)
    assert asked == ["rerun"]
    assert finding.state is State.FAIL
    assert "no libGL" in finding.found


def test_importing_is_tried_for_real():
    assert import_problem("json") == ""
    assert "no_such_module" in import_problem("no_such_module")


def test_a_crash_while_importing_does_not_take_the_doctor_along(tmp_path, monkeypatch):
    (tmp_path / "crashes.py").write_text("import os; os.abort()")
    monkeypatch.setenv("PYTHONPATH", str(tmp_path))
    assert "exit status" in import_problem("crashes")


def test_only_what_is_required_is_looked_at(monkeypatch):
    declared = ["json>=1", "no-such>=1.0", "pytest>=1; extra == 'dev'"]
    monkeypatch.setattr("importlib.metadata.requires", lambda _: declared)
    assert [finding.name for finding in check_packages()] == ["json", "no-such"]


def test_groundwalk_itself_may_be_missing(monkeypatch):
    monkeypatch.setattr("importlib.metadata.requires", absent)
    (finding,) = check_packages()
    assert (finding.name, finding.state) == ("groundwalk", State.FAIL)


@pytest.mark.parametrize(
    ("text", "pins"),
    [("# tested\nnumpy==2.4.6\n", {"numpy": "2.4.6"}), (None, {})],
)
def test_pins_are_read_where_there_are_any(tmp_path, monkeypatch, text, pins):
    path = tmp_path / "constraints.txt"
    if text is not None:
        path.write_text(text)
    tested = {}
    monkeypatch.setattr(doctor, "PINS", path)
    monkeypatch.setattr("importlib.metadata.requires", lambda _: ["numpy>=2.4"])
    monkeypatch.setattr(
        doctor, "check_package", lambda line, pin: tested.update({line: pin})
    )
    check_packages()
    assert tested == {"numpy>=2.4": pins.get("numpy")}


def test_robot_files(tmp_path):
    urdf, mesh = tmp_path / "a.urdf", tmp_path / "a.STL"
    urdf.touch()
    assert check_robot_files([urdf, mesh]).state is State.FAIL
    mesh.touch()
    assert check_robot_files([urdf, mesh]).state is State.OK
    assert check_robot_files([urdf]).state is State.FAIL
    assert check_robot_files([]).state is State.FAIL


def test_viewer(tmp_path):
    assert check_viewer(str(tmp_path)).state is State.NOTE
    viewer = tmp_path / "rerun"
    viewer.touch(mode=0o755)
    assert check_viewer(str(tmp_path)) == Finding("Rerun viewer", State.OK, str(viewer))


def test_folder(tmp_path):
    assert check_folder(tmp_path).state is State.OK
    assert list(tmp_path.iterdir()) == []
    assert check_folder(tmp_path / "not there").state is State.FAIL


@pytest.mark.parametrize(
    ("findings", "status"),
    [([FINE, UNTESTED], 0), ([FINE, MISSING], 1)],
)
def test_exit_status(monkeypatch, capsys, findings, status):
    monkeypatch.setattr(doctor, "examine", lambda: findings)
    assert main(DoctorConfig()) == status
    assert main(DoctorConfig(json=True)) == status
    capsys.readouterr()


def test_plain_lines(capsys):
    print_findings([FINE, MISSING])
    _, fine, missing = capsys.readouterr().out.splitlines()
    assert fine.split() == ["ok", "numpy", "2.4.6"]
    assert missing.startswith("fail")
    assert missing.endswith("not installed  pip install mujoco==4.0.0")


def test_a_terminal_gets_a_table_with_the_same_texts(monkeypatch, capsys):
    monkeypatch.setattr(doctor, "examine", lambda: [MISSING, UNTESTED])
    monkeypatch.setattr(sys.stdout, "isatty", lambda: True)
    monkeypatch.setenv("COLUMNS", "200")
    main(DoctorConfig())
    out = capsys.readouterr().out
    assert "what to do" in out
    assert MISSING.advice in out
    assert UNTESTED.advice in out


def test_json(monkeypatch, capsys):
    monkeypatch.setattr(doctor, "examine", lambda: [FINE, MISSING])
    main(DoctorConfig(json=True))
    told = json.loads(capsys.readouterr().out)
    assert told["works"] is False
    assert told["findings"][1] == {
        "name": "mujoco",
        "state": "fail",
        "found": "not installed",
        "advice": "pip install mujoco==4.0.0",
    }


def imported_here(module):
    """As `import_problem`, but most of it is there already."""
    importlib.import_module(module)
    return ""


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore")
def test_this_very_machine_works(monkeypatch, capsys):
    project = tomllib.loads(PYPROJECT.read_text())["project"]
    required = project["dependencies"]
    monkeypatch.setattr("importlib.metadata.requires", lambda _: required)
    in_place = partial(check_package, find_problem=imported_here)
    monkeypatch.setattr(doctor, "check_package", in_place)
    status = main(DoctorConfig())
    out = capsys.readouterr().out
    assert status == 0, out
    assert len(out.splitlines()) == len(required) + 6

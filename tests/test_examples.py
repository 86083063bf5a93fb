"""Every example does what it says, in a small size."""

import importlib.util
import inspect
import os
import re
import subprocess
import sys
from pathlib import Path

import matplotlib.image
import numpy as np
import pytest

from experiments.walking.trials import TrialRules, course
from groundwalk.errors import UnknownNameError

ROOT = Path(__file__).resolve().parents[1]
EXAMPLES = sorted((ROOT / "examples").glob("*.py"))


def example(name):
    """An example's module."""
    spec = importlib.util.spec_from_file_location(
        name, ROOT / "examples" / f"{name}.py"
    )
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.fixture(autouse=True)
def elsewhere(tmp_path, monkeypatch):
    """What an example leaves behind is not left in the repository."""
    monkeypatch.chdir(tmp_path)


def test_every_example_is_run_here_and_told_about():
    here = Path(__file__).read_text()
    told = (ROOT / "docs" / "python.md").read_text()
    assert len(EXAMPLES) >= 5
    for path in EXAMPLES:
        assert f'example("{path.stem}")' in here
        assert f"examples/{path.name}" in told


def test_errors_of_an_example_are_one_line():
    done = subprocess.run(
        [sys.executable, ROOT / "examples" / "your_own_robot.py", "--robot", "no.urdf"],
        env=os.environ | {"PYTHONPATH": str(ROOT)},
        capture_output=True,
        text=True,
    )
    assert done.returncode == 2
    assert done.stderr == "groundwalk: no.urdf: no such file\n"


def test_the_command_that_an_example_states_has_all_options():
    for path in EXAMPLES:
        module = example(path.stem)
        (line,) = re.findall(r"^ *python examples/\S+(.*)$", module.__doc__, re.M)
        given = set(re.findall(r"--(\w+)", line))
        parameters = inspect.signature(module.main).parameters.values()
        needed = {one.name for one in parameters if one.default is one.empty}
        assert needed <= given <= {one.name for one in parameters}, path.name


def test_tune_a_gait(tmp_path, monkeypatch):
    for name in ("SEARCH_TRIAL", "RATED"):
        short = TrialRules(limit_s=2.0)
        monkeypatch.setattr(f"experiments.walking.gait_search.{name}", short)
    monkeypatch.setattr("experiments.optimize_gait.course", lambda _: course(0.2))
    gait = example("tune_a_gait").main(tmp_path / "run", 4, 1, 1)
    assert len(gait) == 16
    assert "walks" in (tmp_path / "run" / "report.html").read_text()


def test_your_own_ground(tmp_path, capsys):
    walked = example("your_own_ground").main
    waves = walked(limit_s=2.5)
    steep = np.tile(np.linspace(0, 1, 200), (120, 1))  # rises along +x
    matplotlib.image.imsave(tmp_path / "hill.png", steep, cmap="gray")
    uphill = walked(tmp_path / "hill.png", height_m=2.0, limit_s=2.5)
    assert uphill.distance_m[0] < waves.distance_m[0]  # what is walked on counts
    assert capsys.readouterr().out.count("cm/s") == 2


def test_your_own_robot(tmp_path, capsys):
    walked = example("your_own_robot").main
    heavy = walked(limit_s=1.0)
    nao = walked(ROOT / "robots" / "nao.toml", limit_s=1.0)
    assert heavy.distance_m[0] != nao.distance_m[0]
    masses = [
        float(line.split(" kg")[0]) for line in capsys.readouterr().out.split("\n")[:2]
    ]
    assert masses[0] - masses[1] == pytest.approx(1.05, abs=0.011)


def test_your_own_recording(tmp_path):
    verdict = example("your_own_recording").main(tmp_path / "dirt", duration=3)
    (found,) = verdict.effects
    assert (found.name, found.place) == ("coulomb_friction", "swing")
    assert found.parameters["torque"].value == pytest.approx(0.15, rel=0.1)
    assert (tmp_path / "dirt" / "diagnosis" / "report.html").exists()


@pytest.mark.slow
def test_custom_effect(tmp_path, capsys):
    module = example("custom_effect")
    verdict = module.main(tmp_path / "water", duration=3)
    (found,) = verdict.effects
    assert (found.name, found.place) == ("water_drag", "swing")
    assert found.parameters["coefficient"].value == pytest.approx(0.3, rel=0.1)
    assert "water drag at the joint swing" in capsys.readouterr().out
    from diagnosis.effects.library import effect

    with pytest.raises(UnknownNameError, match="water_drag"):
        effect("water_drag")  # known within the block alone

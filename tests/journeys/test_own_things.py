"""Journeys with things of a user's own, which no page and no other test knows."""

import json

import matplotlib.image
import mujoco
import numpy as np
import pytest
from kinds_of_steps import Run, below
from own_things import arm_mjcf, arm_urdf, wedge_stl, write_csv
from small import DIAGNOSED
from travel import ROOT, take

pytestmark = pytest.mark.slow


def found_in(folder):
    """Effects of a diagnosis, as (name, place)."""
    verdict = json.loads((folder / "diagnosis.json").read_text())
    return [(effect["name"], effect["place"]) for effect in verdict["effects"]]


def test_an_arm_of_six_joints_with_csv_and_json(tmp_path):
    (tmp_path / "six.urdf").write_text(arm_urdf())
    model = mujoco.MjModel.from_xml_string(arm_urdf())
    for seed in (1, 2):
        path = tmp_path / f"{seed}.csv"
        write_csv(path, "six.urdf", model, seed, 3.0, {"axis_2": 1.5})
    writes = below("runs/six", (*DIAGNOSED, "corrected.xml", "corrected.json"))
    step = Run(writes=writes, says="axis_2")
    take(
        tmp_path,
        "groundwalk diagnose 1.csv 2.csv --robot six.urdf --out runs/six",
        step,
    )
    assert found_in(tmp_path / "runs" / "six") == [("coulomb_friction", "axis_2")]


def test_an_arm_with_meshes_as_mjcf(tmp_path):
    (tmp_path / "two.xml").write_text(arm_mjcf())
    (tmp_path / "wedge.stl").write_bytes(wedge_stl())
    model = mujoco.MjModel.from_xml_path(str(tmp_path / "two.xml"))
    write_csv(tmp_path / "sway.csv", "two.xml", model, 3, 5.0, {"elbow": 0.4})
    writes = below("runs/two", (*DIAGNOSED, "corrected.xml", "corrected.json"))
    step = Run(writes=writes, says="elbow")
    take(tmp_path, "groundwalk diagnose sway.csv --out runs/two", step)
    assert found_in(tmp_path / "runs" / "two") == [("coulomb_friction", "elbow")]
    corrected = tmp_path / "runs" / "two" / "corrected.xml"
    assert mujoco.MjModel.from_xml_path(str(corrected)).dof_frictionloss[1] > 0.2


def test_ground_from_a_picture(tmp_path):
    hill = np.tile(np.linspace(0, 1, 200), (120, 1))  # rises along +x
    matplotlib.image.imsave(tmp_path / "hill.png", hill, cmap="gray")
    example = ROOT / "examples" / "your_own_ground.py"
    command = f"python {example} --image hill.png --height-m 0.05 --limit-s 1"
    take(tmp_path, command, Run(says="cm/s"))


def test_a_recording_of_an_arm_is_shown(tmp_path):
    (tmp_path / "six.urdf").write_text(arm_urdf())
    model = mujoco.MjModel.from_xml_string(arm_urdf())
    write_csv(tmp_path / "own.csv", "six.urdf", model, 4, 1.0, {})
    step = Run(writes=("own.rrd",))
    take(tmp_path, "groundwalk visualize own.csv --out own.rrd", step)

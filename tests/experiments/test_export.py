import subprocess
import sys

import mujoco
import numpy as np
import pytest

from experiments.command_line import run_verb
from experiments.export import Export, main
from groundwalk.errors import BadValueError, UnknownNameError
from robots.engine_models.mjcf import mujoco_spec

MASS_KG = 5.3053540
"""All of the maker's masses, added by hand."""

LOAD_IN_PYBULLET = """
import sys
import pybullet as bullet
bullet.connect(bullet.DIRECT)
robot = bullet.loadURDF(sys.argv[1])
links = range(-1, bullet.getNumJoints(robot))
print(len(links), sum(bullet.getDynamicsInfo(robot, link)[0] for link in links))
"""


@pytest.fixture
def exported(tmp_path):
    """Function: the path of an exported model."""

    def export(form):
        path = tmp_path / f"nao.{form}"
        main(Export("nao", form, path))
        return path

    return export


def test_mjcf_loads_in_mujoco(exported):
    model = mujoco.MjModel.from_xml_path(str(exported("mjcf")))
    assert model.body_mass.sum() == pytest.approx(MASS_KG, rel=1e-9)
    assert (model.nu, model.nq) == (20, 27)


def test_mjcf_moves_like_the_model_that_the_sim_uses(exported, nao, crouch):
    def fallen(model):
        data = mujoco.MjData(model)
        data.qpos[7:] = crouch
        data.ctrl[:] = crouch + 0.1
        mujoco.mj_step(model, data, 50)
        return data.qpos

    ours = mujoco_spec(nao).compile()
    theirs = mujoco.MjModel.from_xml_path(str(exported("mjcf")))
    # Six digits are written of each number.
    np.testing.assert_allclose(fallen(theirs), fallen(ours), atol=1e-4)
    assert not np.allclose(fallen(ours)[7:], crouch, atol=1e-2)


def test_urdf_loads_in_pybullet(exported):
    command = [sys.executable, "-c", LOAD_IN_PYBULLET, str(exported("urdf"))]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    links, mass_kg = done.stdout.split()[-2:]
    assert int(links) == 21
    assert float(mass_kg) == pytest.approx(MASS_KG, rel=1e-9)


def test_urdf_loads_in_mujocos_own_importer(exported):
    spec = mujoco.MjSpec.from_file(str(exported("urdf")))
    spec.compiler.fusestatic = False  # else the root, fixed to the world, is lost
    model = spec.compile()
    assert model.body_mass.sum() == pytest.approx(MASS_KG, rel=1e-9)
    assert model.njnt == 20


@pytest.mark.parametrize(("form", "start"), [("mjcf", "<mujoco"), ("urdf", "<?xml")])
def test_without_a_file_the_model_goes_to_standard_output(
    exported, capsys, form, start
):
    main(Export("nao", form))
    text = capsys.readouterr().out
    assert text.startswith(start)
    assert text == exported(form).read_text()


def test_no_file_is_overwritten(tmp_path):
    path = tmp_path / "mine.xml"
    path.write_text("precious")
    with pytest.raises(BadValueError, match=r"mine\.xml exists already"):
        Export("nao", "mjcf", path)
    assert path.read_text() == "precious"


def test_an_unknown_robot():
    with pytest.raises(UnknownNameError, match="did you mean 'nao'"):
        Export("noa", "mjcf")


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["nao", "--format", "sdf"], ["sdf", "mjcf", "urdf"]),
        (["nao"], ["--format"]),
    ],
)
def test_what_no_option_can_be_is_told_in_one_line(capsys, arguments, words):
    with pytest.raises(SystemExit) as stop:
        run_verb(Export, main, arguments=arguments)
    said = capsys.readouterr()
    assert (stop.value.code, said.out) == (2, "")
    (line,) = said.err.splitlines()
    assert [word for word in words if word not in line] == []


def test_the_script_tells_in_one_line_what_is_wrong():
    command = [sys.executable, "-m", "experiments.export", "noa", "--format", "urdf"]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert (done.returncode, done.stdout) == (2, "")
    (line,) = done.stderr.splitlines()
    assert "unknown robot 'noa'" in line
    assert "did you mean 'nao'?" in line

"""What is taken out of model files; MuJoCo says what they then mean."""

import mujoco
import pytest
from made_up_data import ARM, CARRIAGE, PUBLISHED, write_arm

from experiments.concealed.doctored.models import RealModel, published
from experiments.concealed.doctored.robots import REAL_SETS
from groundwalk.errors import BadModelError

URDF = """<robot name="r"><link name="base"/><link name="arm">
<inertial><origin xyz="0.1 0 0"/><mass value="0.5"/>
<inertia ixx="0.01" iyy="0.02" izz="0.02" ixy="0" ixz="0" iyz="0"/></inertial>
<visual><geometry><mesh filename="package://x/missing.stl"/></geometry></visual></link>
<joint name="j" type="revolute"><parent link="base"/><child link="arm"/>
<axis xyz="0 1 0"/><limit lower="-1" upper="1" effort="1" velocity="1"/></joint>
</robot>"""


def read(tmp_path, text, name):
    (tmp_path / name).write_text(text)
    real = REAL_SETS["so101"]
    return RealModel.read(tmp_path, type(real)("", name, 1.0, ()))


@pytest.mark.parametrize(
    ("text", "name", "link", "mass"),
    [
        (URDF, "m.urdf", "arm", 0.5),
        (ARM, "m.xml", "link03", 0.6),
        (CARRIAGE, "m.xml", "carriage", 95.11),
    ],
)
def test_a_link_gets_lighter_by_a_point_mass(tmp_path, text, name, link, mass):
    model = read(tmp_path, text, name)
    before = mujoco.MjModel.from_xml_string(model.text)
    assert model.mass_kg(link) == mass
    model.take_mass(link, 0.25 * mass)
    after = mujoco.MjModel.from_xml_string(model.text)
    assert after.body(link).mass[0] == pytest.approx(0.75 * mass)
    assert after.body(link).ipos == pytest.approx(before.body(link).ipos)
    if link != "carriage":  # which only slides: its geometry gives the inertia
        assert after.body(link).inertia == pytest.approx(before.body(link).inertia)


def test_shapes_of_a_urdf_are_left_out(tmp_path):
    model = read(tmp_path, URDF, "m.urdf")
    assert (model.file, "mesh" in model.text) == ("nominal.urdf", False)


def test_a_joint_gets_published_values_and_loses_some(tmp_path):
    write_arm(tmp_path)
    model = RealModel.read(tmp_path, REAL_SETS["z1"])
    values = published(tmp_path / "labelled" / "z1_arm" / "truth.json")
    assert set(values) == set(PUBLISHED)
    model.give(values)
    model.give({"joint3": {"damping": 0.05}})
    found = mujoco.MjModel.from_xml_string(model.text)
    assert found.dof_damping.tolist() == [0.4, 0.05]
    assert found.dof_frictionloss.tolist() == [0.4, 0.4]
    assert found.dof_armature.tolist() == [0.0001, 0.0001]


def test_models_that_are_not_there_are_told(tmp_path):
    with pytest.raises(BadModelError, match="cannot be read"):
        RealModel.read(tmp_path, REAL_SETS["z1"])
    with pytest.raises(BadModelError, match="no body wing"):
        read(tmp_path, ARM, "m.xml").mass_kg("wing")
    with pytest.raises(BadModelError, match="no mass of base"):
        read(tmp_path, URDF, "m.urdf").mass_kg("base")

import pytest

from diagnosis.plant.differences import differences
from diagnosis.plant.load import load_plant

ARM = """
<mujoco>
  <worldbody>
    <body name="upper">
      <joint name="shoulder" axis="0 1 0" {joint}/>
      <geom type="capsule" fromto="0 0 0 0 0 -.3" size=".02" mass="{upper}"/>
      <body name="fore" pos="0 0 -.3">
        <joint name="{second}" axis="0 1 0"/>
        <geom type="capsule" fromto="0 0 0 0 0 {reach}" size=".02" mass=".5"/>
      </body>
    </body>
  </worldbody>
</mujoco>
"""


@pytest.fixture
def arm(tmp_path):
    """A function that loads the arm with other numbers."""

    def loaded(**numbers):
        usual = {"joint": "", "upper": 1.0, "second": "elbow", "reach": -0.2}
        path = tmp_path / "arm.xml"
        path.write_text(ARM.format(**usual | numbers))
        return load_plant(path, "fixed")

    return loaded


@pytest.mark.parametrize(
    ("numbers", "told"),
    [
        ({}, ()),
        ({"upper": 1.0 + 1e-8}, ()),
        ({"joint": 'armature="0.02"'}, ("rotor inertia (armature) at 1 joint",)),
        ({"joint": 'frictionloss="0.1"'}, ("dry friction at 1 joint",)),
        ({"upper": 1.1}, ("mass at 1 body", "inertia at 1 body")),
        ({"reach": -0.3}, ("inertia at 1 body", "centre of mass at 1 body")),
    ],
)
def test_the_quantities_that_differ_are_told(arm, numbers, told):
    assert differences(arm(), arm(**numbers)) == told
    assert differences(arm(**numbers), arm()) == told


def test_a_joint_that_only_one_model_has_is_told(arm):
    told = ("joint 'elbow', which only one has",)
    assert differences(arm(), arm(second="wrist")) == told

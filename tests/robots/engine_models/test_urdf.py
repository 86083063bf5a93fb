"""The URDF as text; what PyBullet makes of it is in test_models_agree."""

from xml.etree import ElementTree

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from robots.engine_models.urdf import urdf
from robots.sole import CONTACT_RADIUS_M, contact_points


@pytest.fixture(scope="module")
def robot(nao):
    return ElementTree.fromstring(urdf(nao))


def numbers(text):
    return np.array([float(word) for word in text.split()])


def test_no_link_is_without_mass(robot, nao):
    masses = [
        float(link.find("inertial/mass").get("value")) for link in robot.iter("link")
    ]
    assert len(masses) == 21
    assert min(masses) > 0.05
    assert sum(masses) == pytest.approx(nao.mass_kg, rel=1e-12)


def test_tree_is_the_descriptions(robot, nao):
    joints = robot.findall("joint")
    assert [joint.get("name") for joint in joints] == list(nao.joints)
    for element, joint in zip(joints, nao.links, strict=True):
        parent = nao.root if joint.parent < 0 else nao.links[joint.parent].link
        assert element.get("type") == "revolute"
        assert element.find("parent").get("link") == parent.name
        assert element.find("child").get("link") == joint.link.name
        np.testing.assert_array_equal(
            numbers(element.find("origin").get("xyz")), joint.origin_m
        )
        np.testing.assert_array_equal(
            numbers(element.find("axis").get("xyz")), joint.axis
        )


def test_second_of_the_coupled_joints_mimics_the_first(robot):
    mimics = {
        joint.get("name"): joint.find("mimic").get("joint")
        for joint in robot.findall("joint")
        if joint.find("mimic") is not None
    }
    assert mimics == {"RHipYawPitch": "LHipYawPitch"}


def test_only_the_soles_can_touch(robot, nao):
    for link in robot.iter("link"):
        collisions = link.findall("collision")
        assert bool(collisions) == (link.get("name") in ("LFoot", "RFoot"))
        for shape in collisions:
            radius = float(shape.find("geometry/sphere").get("radius"))
            assert radius == CONTACT_RADIUS_M
    for name, foot in zip(("LFoot", "RFoot"), nao.feet, strict=True):
        shapes = robot.findall(f"link[@name='{name}']/collision/origin")
        places = np.array([numbers(shape.get("xyz")) for shape in shapes])
        np.testing.assert_array_equal(places[:, :2], contact_points(foot))
        np.testing.assert_allclose(places[:, 2], -0.04511 + 0.01, atol=1e-15)


def test_shapes_point_where_they_shall(robot, nao):
    """A cylinder runs along its own z axis; roll, pitch and yaw turn that."""
    for link in (nao.root, *(joint.link for joint in nao.links)):
        rods = [shape for shape in link.shapes if shape.start_m != shape.end_m]
        visuals = [
            visual
            for visual in robot.findall(f"link[@name='{link.name}']/visual")
            if visual.find("geometry/cylinder") is not None
        ]
        for shape, visual in zip(rods, visuals, strict=True):
            start, end = np.array(shape.start_m), np.array(shape.end_m)
            length = float(visual.find("geometry/cylinder").get("length"))
            origin = visual.find("origin")
            turn = Rotation.from_euler("xyz", numbers(origin.get("rpy")))
            half = turn.apply([0, 0, length / 2])
            middle = numbers(origin.get("xyz"))
            np.testing.assert_allclose(middle + half, end, atol=1e-12)
            np.testing.assert_allclose(middle - half, start, atol=1e-12)

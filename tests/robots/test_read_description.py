"""Reading a robot from TOML: what is fixed becomes part of what carries it."""

import tomllib
from importlib import resources

import numpy as np
import pytest
from scipy.spatial import ConvexHull

from groundwalk.errors import UnknownNameError
from robots.catalog import read_description

NAO_TOML = (resources.files("robots") / "nao.toml").read_text()


def tensor(values):
    xx, yy, zz, xy, xz, yz = values
    return np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])


def second_moments(mass, com, inertia):
    """(4, 4) mass, first and second moments about the frame's origin; they add up."""
    homogeneous = np.append(com, 1.0)
    moments = mass * np.outer(homogeneous, homogeneous)
    moments[:3, :3] += np.trace(inertia) / 2 * np.eye(3) - inertia
    return moments


def of_link(inertial):
    return second_moments(inertial.mass_kg, inertial.com_m, inertial.inertia_kg_m2)


def of_table(values, offset=(0, 0, 0)):
    com = np.array(values["com"]) + offset
    return second_moments(values["mass"], com, tensor(values["inertia"]))


@pytest.fixture(scope="module")
def table():
    return tomllib.loads(NAO_TOML)


@pytest.fixture
def read(tmp_path):
    """Function: the description of a changed text."""

    def read_text(*changes):
        text = NAO_TOML
        for old, new in changes:
            assert text.count(old) >= 1
            text = text.replace(old, new, 1)
        path = tmp_path / "changed.toml"
        path.write_text(text)
        return read_description(path)

    return read_text


def test_head_is_part_of_the_torso(nao, table):
    """Neck and head sit 126.5 mm above the torso's origin."""
    joints, neck = table["joint"], (0, 0, 0.1265)
    expected = (
        of_table(table["torso"])
        + of_table(joints["HeadYaw"], neck)
        + of_table(joints["HeadPitch"], neck)
    )
    np.testing.assert_allclose(of_link(nao.root.inertial), expected, rtol=1e-12)
    parts = (table["torso"], joints["HeadYaw"], joints["HeadPitch"])
    assert len(nao.root.shapes) == sum(len(part["shapes"]) for part in parts)


@pytest.mark.parametrize(("side", "hand_z_m"), [("L", -0.01231), ("R", -0.01213)])
def test_wrist_and_hand_are_part_of_the_forearm(nao, table, side, hand_z_m):
    joints = table["joint"]
    wrist = np.array([0.05595, 0, 0])
    expected = (
        of_table(joints[f"{side}ElbowRoll"])
        + of_table(joints[f"{side}WristYaw"], wrist)
        + of_table(joints[f"{side}Hand"], wrist + np.array([0.05775, 0, hand_z_m]))
    )
    forearm = nao.links[nao.joints.index(f"{side}ElbowRoll")].link
    np.testing.assert_allclose(
        of_link(forearm.inertial), expected, rtol=1e-12, atol=1e-18
    )
    fingers = forearm.shapes[2]
    np.testing.assert_allclose(
        fingers.end_m, wrist + joints[f"{side}WristYaw"]["shapes"][1]["to"]
    )


def test_shapes_have_the_shell_s_colour_or_their_own(nao, read):
    head = nao.root.shapes[-7:]
    assert [shape.colour for shape in head[:3]] == ["shell", "accent", "accent"]
    with pytest.raises(UnknownNameError, match="'pink'"):
        read(('colour = "dark"', 'colour = "pink"'))


def test_links_without_anything_fixed_stay_as_they_are(nao, table):
    for joint in nao.links:
        if not joint.name.endswith("ElbowRoll"):
            expected = of_table(table["joint"][joint.name])
            np.testing.assert_allclose(of_link(joint.link.inertial), expected)


def test_moving_joint_behind_a_fixed_one(nao, read):
    """With the knee fixed, the ankle hangs on the thigh, a whole leg below the hip."""
    stiff = read(
        (
            "axis = [0, 1, 0]\nrange = [-0.0923279, 2.11255]",
            "axis = [0, 1, 0]\nfixed = true",
        )
    )
    assert "LKneePitch" not in stiff.joints
    assert len(stiff.joints) == 19
    ankle = stiff.links[stiff.joints.index("LAnklePitch")]
    assert stiff.joints[ankle.parent] == "LHipPitch"
    np.testing.assert_allclose(ankle.origin_m, [0, 0, -0.2029], atol=1e-15)
    assert stiff.mass_kg == pytest.approx(nao.mass_kg, rel=1e-12)


def test_axes_become_unit_vectors(nao, table):
    given = np.array(table["joint"]["LHipYawPitch"]["axis"])
    assert np.linalg.norm(given) != 1.0
    axis = nao.links[0].axis
    assert np.linalg.norm(axis) == pytest.approx(1.0, abs=1e-15)
    np.testing.assert_allclose(np.cross(axis, given), 0, atol=1e-15)


def test_soles_are_the_convex_hull(nao, table):
    for foot, name in zip(nao.feet, ("left", "right"), strict=True):
        points = np.array(table["foot"][name]["outline"])
        hull = ConvexHull(points)
        assert len(foot.outline_m) == len(hull.vertices) < len(points)
        assert ConvexHull(foot.outline_m).volume == pytest.approx(hull.volume)
        edges = np.roll(foot.outline_m, -1, axis=0) - foot.outline_m
        after = np.roll(edges, -1, axis=0)
        turning = edges[:, 0] * after[:, 1] - edges[:, 1] * after[:, 0]
        assert (np.sign(turning) == np.sign(turning[0])).all()  # in order


@pytest.mark.parametrize(
    ("change", "name", "nearest"),
    [
        (('parent = "LHipRoll"', 'parent = "LHipRol"'), "LHipRol", "LHipRoll"),
        (('parent = "LWristYaw"', 'parent = "LWrist"'), "LWrist", "LWristYaw"),
        (('motor = "leg_pitch"', 'motor = "leg_pitsch"'), "leg_pitsch", "leg_pitch"),
        (('joints = ["LHipYawPitch"', 'joints = ["LHipYaw"'), "LHipYaw", None),
        (('joint = "LAnkleRoll"\nsole', 'joint = "LToe"\nsole'), "LToe", None),
    ],
)
def test_names_that_stand_for_nothing(read, change, name, nearest):
    with pytest.raises(UnknownNameError, match=f"{name!r}") as raised:
        read(change)
    assert nearest is None or nearest in str(raised.value)

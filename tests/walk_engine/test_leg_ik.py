import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from leg_fk import forward
from scipy.spatial.transform import Rotation

from robots.leg_geometry import LegGeometry
from walk_engine.legs import inverse

SLANT = math.sqrt(0.5)
NAO = LegGeometry((0.0, 0.05, -0.085), (0.0, SLANT, -SLANT), 0.1, 0.1029, 0.04519)
UPRIGHT = LegGeometry((0.01, 0.08, -0.02), (0.0, 0.0, 1.0), 0.3, 0.25, 0.06)

angles = st.tuples(
    st.floats(-0.8, 0.7),  # yaw
    st.floats(-0.6, 0.6),  # roll
    st.floats(-1.2, 0.4),  # pitch
    st.floats(0.03, 2.1),  # knee
    st.floats(-0.3, 0.3),  # tilt
)


def chained(leg, q):
    """Forward kinematics by one SciPy rotation after another."""
    x, y = np.array([1.0, 0, 0]), np.array([0, 1.0, 0])
    hip = Rotation.from_rotvec(q[0] * np.array(leg.yaw_axis))
    thigh = hip * Rotation.from_rotvec(q[1] * x) * Rotation.from_rotvec(q[2] * y)
    shin = thigh * Rotation.from_rotvec(q[3] * y)
    foot = shin * Rotation.from_rotvec(q[4] * y) * Rotation.from_rotvec(q[5] * x)
    ankle = np.array(leg.hip_m)
    ankle = ankle + thigh.apply([0, 0, -leg.thigh_m]) + shin.apply([0, 0, -leg.tibia_m])
    return ankle, foot.as_matrix()


def solved(leg, yaw, ankle, tilt=0.0):
    return inverse(leg, np.array(yaw), np.array(ankle), np.array(tilt))


@pytest.mark.parametrize("leg", [NAO, UPRIGHT], ids=["nao", "upright"])
@given(q=st.tuples(*[st.floats(-2.5, 2.5)] * 6))
def test_forward_agrees_with_a_chain_of_rotations(leg, q):
    ankle, foot = forward(leg, np.array(q))
    expected_ankle, expected_foot = chained(leg, q)
    assert np.allclose(ankle, expected_ankle, atol=1e-12)
    assert np.allclose(foot, expected_foot, atol=1e-12)


@pytest.mark.parametrize("leg", [NAO, UPRIGHT], ids=["nao", "upright"])
@settings(max_examples=300)
@given(q=angles)
def test_inverse_undoes_forward_and_levels_the_sole(leg, q):
    yaw, roll, pitch, knee, tilt = q
    ankle, _ = chained(leg, (yaw, roll, pitch, knee, 0.0, 0.0))
    found = solved(leg, yaw, ankle, tilt)
    assert np.allclose(found[:4], (yaw, roll, pitch, knee), atol=1e-9)
    reached, foot = chained(leg, found)
    assert np.allclose(reached, ankle, atol=1e-9)
    assert np.allclose(foot[:, 2], (-math.sin(tilt), 0, math.cos(tilt)), atol=1e-9)


def test_arrays_of_any_shape_are_solved_one_by_one():
    rng = np.random.default_rng(3)
    q = rng.uniform(-0.5, 0.5, (6, 2, 5))
    q[3] = rng.uniform(0.1, 1.5, (2, 5))
    ankle, foot = forward(NAO, q)
    assert ankle.shape == (3, 2, 5)
    assert foot.shape == (3, 3, 2, 5)
    found = inverse(NAO, q[0], ankle, np.zeros((2, 5)))
    for index in np.ndindex(2, 5):
        one = solved(NAO, q[0][index], ankle[(slice(None), *index)])
        assert np.allclose(found[(slice(None), *index)], one, atol=1e-12)


@pytest.mark.parametrize(
    ("hip_height", "com", "behind", "lift", "expected"),
    [
        (0.248, 0.00, 0.0, 0.0, (-0.0302, 0.0596, -0.0294)),
        (0.230, 0.01, 0.0, 0.0, (-0.3746, 0.8446, -0.4699)),
        (0.230, 0.01, -0.0345, 0.0, (-0.5437, 0.8116, -0.2678)),
        (0.230, 0.01, 0.0345, 0.0, (-0.1263, 0.7145, -0.5882)),
        (0.230, 0.01, 0.0, 0.01, (-0.4810, 1.0595, -0.5785)),
        (0.210, 0.01, 0.0, 0.0, (-0.5699, 1.2405, -0.6707)),
        (0.235, 0.01, 0.0, 0.0, (-0.3102, 0.7150, -0.4048)),
    ],
)
def test_published_angles_straight(hip_height, com, behind, lift, expected):
    below = hip_height - NAO.ankle_height_m - lift
    found = solved(NAO, 0.0, (-(behind + com), 0.05, -0.085 - below))
    assert np.allclose(found, (0, 0, *expected, 0), atol=5.1e-5)


@pytest.mark.parametrize(
    ("toe_out", "expected", "foot_yaw"),
    [
        (0.2, (-0.2, 0.0179, -0.2343, 0.8446, -0.4694, -0.0077), 0.1435),
        (-0.2, (0.2, 0.0024, -0.5161, 0.8446, -0.4694, 0.0076), -0.1413),
    ],
)
def test_published_angles_turned(toe_out, expected, foot_yaw):
    found = solved(NAO, -toe_out, (-0.01, 0.05, -0.085 - (0.23 - 0.04519)))
    assert np.allclose(found, expected, atol=1.1e-4)
    _, foot = chained(NAO, found)
    assert math.atan2(foot[1, 0], foot[0, 0]) == pytest.approx(foot_yaw, abs=1e-4)


@given(
    yaw=st.floats(-1, 1),
    offset=st.tuples(*[st.floats(-2, 2)] * 3),
    tilt=st.floats(-0.5, 0.5),
)
def test_any_target_gives_finite_angles_on_its_line(yaw, offset, tilt):
    hip, offset = np.array(NAO.hip_m), np.array(offset)
    found = solved(NAO, yaw, hip + offset, tilt)
    assert np.isfinite(found).all()
    reached = chained(NAO, found)[0] - hip
    distance = np.linalg.norm(offset)
    if distance < 1e-5:
        return
    wanted = np.clip(distance, abs(0.1 - 0.1029) + 1e-6, 0.2029 - 1e-6)
    assert np.allclose(reached, offset * wanted / distance, atol=1e-8)


@pytest.mark.parametrize("offset", [(0, 0, 0), (1e-200, 0, 0), (0, 0, 1e-9)])
def test_the_hip_itself_as_target_folds_the_leg(offset):
    found = solved(NAO, 0.3, np.array(NAO.hip_m) + offset)
    assert np.isfinite(found).all()
    assert found[3] > 3.0


def test_a_target_too_far_straightens_the_leg():
    found = solved(NAO, 0.0, (0.0, 0.05, -1.0))
    assert np.allclose(found, 0.0, atol=0.01)

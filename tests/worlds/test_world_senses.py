"""What robots measure in both worlds, against statics and the torso's own path."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

G_M_S2 = 9.81


def in_torso(orientation, vectors):
    return Rotation.from_quat(orientation, scalar_first=True).inv().apply(vectors)


def test_at_rest(nao, settled):
    last = {name: array[-1] for name, array in settled.items()}
    assert np.abs(last["velocity_rad_s"]).max() < 2e-2
    assert np.abs(last["gyroscope_rad_s"]).max() < 2e-2
    up = in_torso(last["base_orientation"], [0, 0, G_M_S2])
    np.testing.assert_allclose(last["accelerometer_m_s2"], up, atol=0.05)
    weight_n = 5.305 * G_M_S2
    np.testing.assert_allclose(last["foot_force_n"].sum(axis=1), weight_n, rtol=0.01)


def test_foot_forces_are_centred_below_the_centre_of_mass(nao, settled, link_frames):
    """Of a robot at rest; found with SciPy's kinematics and the sensors' places."""
    joints = settled["position_rad"][-1]
    turns, places = link_frames(nao, joints)
    masses = [nao.root.inertial.mass_kg]
    centres = [np.tile(nao.root.inertial.com_m, (3, 1))]
    for joint, turn, place in zip(nao.links, turns, places, strict=True):
        masses.append(joint.link.inertial.mass_kg)
        centres.append(place + turn @ joint.link.inertial.com_m)
    centre = np.average(centres, axis=0, weights=masses)
    sensors = []
    for foot in nao.feet:
        corners = np.c_[foot.sensors_m, np.full(4, foot.sole_height_m)]
        sensors.append(
            places[foot.joint][:, None]
            + np.einsum("nij,kj->nki", turns[foot.joint], corners)
        )
    torso = Rotation.from_quat(settled["base_orientation"][-1], scalar_first=True)
    sensors = np.concatenate(sensors, axis=1)
    force = settled["foot_force_n"][-1]
    pressed = np.einsum("nk,nki->ni", force, sensors) / force.sum(axis=1)[:, None]
    apart_mm = 1e3 * torso.apply(pressed - centre)[:, :2]
    assert np.abs(apart_mm).max() < 2.0
    left, forward = centre[1] - centre[0], centre[2] - centre[0]
    assert abs(left[1]) < 1e-2  # the torso itself is what moved
    assert abs(forward[0]) < 1e-2


def test_sensors_feel_a_lean(settled):
    crouched, left, forward = settled["foot_force_n"][-1]
    left_foot, front = slice(0, 4), [0, 1, 4, 5]
    assert crouched[left_foot].sum() == pytest.approx(crouched.sum() / 2, rel=0.02)
    assert left[left_foot].sum() > 1.1 * crouched[left_foot].sum()
    assert forward[front].sum() > 1.2 * crouched[front].sum()
    left_of_each, right_of_each = [0, 2, 4, 6], [1, 3, 5, 7]
    assert left[left_of_each].sum() > 1.2 * left[right_of_each].sum()


def test_inertial_sensors_feel_a_fall(world, topple, roll):
    """They agree with what the torso's path says, differentiated from tick to tick."""
    pose = np.tile(topple, (3, 1))
    rollout = roll(world, pose, [pose] * 33)
    turns = Rotation.from_quat(rollout["base_orientation"][:, 0], scalar_first=True)
    place_m = rollout["base_position_m"][:, 0] + turns.apply([-0.008, 0.00606, 0.027])
    gravity = np.array([0, 0, G_M_S2])
    specific = np.diff(place_m, n=2, axis=0) / 0.01**2 + gravity
    expected = turns[1:-1].inv().apply(specific)
    falling = slice(8, 27)  # between the jolts of the start and of the legs' end
    measured = rollout["accelerometer_m_s2"][1:-1, 0]
    np.testing.assert_allclose(measured[falling], expected[falling], atol=0.2)
    assert expected[falling][-1, 2] < G_M_S2 - 3
    spin = (turns[:-2].inv() * turns[2:]).as_rotvec() / 0.02
    gyroscope = rollout["gyroscope_rad_s"][1:-1, 0]
    np.testing.assert_allclose(gyroscope[falling], spin[falling], atol=0.05)
    assert spin[falling][-1, 1] < -1.0  # backwards

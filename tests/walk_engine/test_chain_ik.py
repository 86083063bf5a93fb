"""Numerical inverse kinematics against the closed form and another forward chain."""

import numpy as np
import pytest

import robots
from robots import biped
from walk_engine import Velocity, WalkEngine, gaits
from walk_engine.chain_ik import ChainLegs
from walk_engine.engine_config import EngineConfig
from walk_engine.legs import Legs, inverse

N = 40
SIGNS = {"left": 1.0, "right": -1.0}


def targets(leg, seed=0):
    """Ankles (3, 2, n) mirrored, toes, tilts and what is added to the ankles."""
    draw = np.random.default_rng(seed)
    length = leg.thigh_m + leg.tibia_m
    away = draw.uniform(-0.15, 0.15, (3, 2, N)) * length
    away[2] = -draw.uniform(0.8, 0.95, (2, N)) * length
    ankle = np.reshape(leg.hip_m, (3, 1, 1)) + away
    toe, tilt = draw.uniform(-0.3, 0.3, (2, N)), draw.uniform(-0.1, 0.2, (2, N))
    return ankle, toe, tilt, np.zeros((2, 2, N))


@pytest.mark.parametrize("name", ["g1", "icub", "simple_humanoid", "talos"])
def test_feet_are_where_they_shall_be(name, link_frames):
    """Followed with SciPy's rotations, with toes turned and torsos that lean."""
    description = robots.get(name)
    body = biped(description)
    ankle, toe, tilt, none = targets(body.leg)
    angles = np.zeros((N, body.joints))
    pair = Legs(body).angles(ankle, toe, tilt, none)
    for columns, found in zip((body.left_leg, body.right_leg), pair, strict=True):
        angles[:, list(columns)] = found.T
    turns, places = link_frames(description, angles)
    for k, side in enumerate(SIGNS.values()):
        last = description.feet[k].joint
        place, turn = places[last], turns[last]
        lean = np.stack([-np.sin(tilt[k]), np.zeros(N), np.cos(tilt[k])], axis=1)
        np.testing.assert_allclose(turn[:, :, 2], lean, atol=1e-6)
        yaw = np.arctan2(turn[:, 1, 0], turn[:, 1, 1])
        np.testing.assert_allclose(yaw, side * toe[k], atol=1e-6)
        wanted = ankle[:, k].T * [1, side, 1]
        reached = place - np.einsum("nij,j->ni", turn, body.chains[k].foot_m)
        np.testing.assert_allclose(reached, wanted, atol=1e-6)


def test_another_start_leads_to_the_closed_form():
    """The axes of Talos meet, so that `inverse` is exact for level, straight feet."""
    body = biped(robots.get("talos"))
    ankle, _, _, none = targets(body.leg)
    still = np.zeros((2, N))
    closed = inverse(body.leg, still, ankle, still)[:, 0]
    left, _ = Legs(body).angles(ankle, still, still, none)
    np.testing.assert_allclose(left, closed, atol=1e-9)
    start = np.stack([closed, closed], axis=1)
    start += np.random.default_rng(1).uniform(-0.2, 0.2, start.shape)
    solver = ChainLegs((body.chains[0],) * 2, body.leg.thigh_m + body.leg.tibia_m)
    places = np.stack([ankle[:, 0].T] * 2)
    level = np.broadcast_to(np.eye(3), (2, N, 3, 3))
    found = solver.angles(start, places, level)
    np.testing.assert_allclose(found[:, 1], closed, atol=1e-5)


def test_a_target_out_of_reach_is_finite():
    body = biped(robots.get("g1"))
    ankle, toe, tilt, none = targets(body.leg)
    ankle[2] -= 1.0
    for angles in Legs(body).angles(ankle, toe, tilt, none):
        assert np.isfinite(angles).all()
        assert np.abs(angles).max() < 7


def test_robots_do_not_influence_each_other():
    body = biped(robots.get("g1"))
    ankle, toe, tilt, none = targets(body.leg)
    together = Legs(body).angles(ankle, toe, tilt, none)
    one = np.s_[..., 7:8]
    parts = (part[one].copy() for part in (ankle, toe, tilt, none))
    for all_of_them, alone in zip(together, Legs(body).angles(*parts), strict=True):
        np.testing.assert_array_equal(all_of_them[one], alone)


def test_ankles_take_feedback_by_their_own_signs():
    """iCub's right ankle rolls about -x: the same feedback is a negative angle."""
    body = biped(robots.get("icub"))
    ankle, toe, tilt, none = targets(body.leg)
    added = none + 0.1
    before = Legs(body).angles(ankle, toe, tilt, none)
    after = Legs(body).angles(ankle, toe, tilt, added)
    left, right = (b - a for a, b in zip(before, after, strict=True))
    np.testing.assert_allclose(left[4:], [[0.1] * N, [0.1] * N])
    np.testing.assert_allclose(right[4:], [[0.1] * N, [-0.1] * N])


def test_a_gait_means_the_same_to_a_larger_robot():
    """Lengths by the legs, times by the pendulum: the hips, and when the foot is up."""
    body = biped(robots.get("talos"))
    engine = WalkEngine(body, [gaits.get("start")])
    period_s = 0.23 * body.scale.time
    force = np.zeros((1, 8))
    force[:, :4] = 100.0
    changes = []
    side = engine.support[0]
    for tick in range(400):
        engine.step(Velocity.forward(), np.zeros((1, 3)), force)
        if engine.support[0] != side:
            changes.append(tick)
            side = engine.support[0]
    # Without a change of weight a step lasts three periods.
    steps_s = np.diff(changes)[1:] * 0.01
    np.testing.assert_allclose(steps_s, 3 * period_s, atol=0.011)


def test_constants_by_their_units():
    scale = robots.get("talos").scale
    scaled = EngineConfig().scaled(scale)
    assert scaled.max_left_m_s == pytest.approx(0.2 * scale.speed)
    assert scaled.max_turn_rad_s == pytest.approx(0.87 / scale.time)
    assert scaled.posture_s == pytest.approx(0.5 * scale.time)
    assert scaled.sensor_start_n == pytest.approx(0.980665 * scale.weight)
    assert (scaled.stretch, scaled.lift_slope_left) == (0.9996, 0.02)
    assert EngineConfig().scaled(robots.get("nao").scale) == EngineConfig()

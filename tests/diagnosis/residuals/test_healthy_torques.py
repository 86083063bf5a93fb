"""Torque errors of a healthy robot, with differences between its recordings."""

import numpy as np
import pytest
from scipy.stats import multivariate_normal

from diagnosis.residuals.torques import healthy_torques
from diagnosis.residuals.torques.healthy_torques import HealthyTorques
from diagnosis.residuals.torques.joint_errors import COLUMNS, JointErrors, Means

K, JOINTS, BLOCKS = len(COLUMNS), 6, 80
ROBOT, BETWEEN, LEFT = 0.3, 0.1, 0.05


def means(seed, recordings, robot, between=BETWEEN, added=0.0, alike=0.0):
    """Means of recordings whose coefficients scatter around those of a robot (j, k).

    `added` is what the torque of the first joint lacks in proportion to its last
    column.
    """
    random = np.random.default_rng(seed)
    n = recordings * BLOCKS
    columns = random.standard_normal((n, JOINTS, K))
    recording = np.repeat(np.arange(recordings), BLOCKS)
    own = between * random.standard_normal((recordings, JOINTS, K))
    own[:, :, healthy_torques.STEADY] = 0
    missing = np.einsum("njk,njk->nj", columns, robot + own[recording])
    noise = LEFT * random.standard_normal((n, JOINTS))
    for row in range(1, n):
        if recording[row] == recording[row - 1]:
            fresh = np.sqrt(1 - alike**2) * noise[row]
            noise[row] = alike * noise[row - 1] + fresh
    missing += noise
    missing[:, 0] += added * columns[:, 0, -1]
    torque = np.ones((n, JOINTS))
    block = np.tile(np.arange(BLOCKS), recordings)
    names = tuple(f"{seed} {i}" for i in range(recordings))
    return Means(missing, columns, torque, recording, block, names)


@pytest.fixture(scope="module")
def robot():
    return ROBOT * np.random.default_rng(7).standard_normal((JOINTS, K))


def whitened(found, other):
    left = other.missing - found.torque(other.columns)
    matrices = found.whitening(other)
    return np.stack([matrices[j] @ left[:, j] for j in range(JOINTS)])


@pytest.mark.parametrize("alike", [0.0, 0.6])
def test_what_made_the_recordings_is_learned(robot, alike):
    found = HealthyTorques.of(means(0, 8, robot, alike=alike))
    assert found.alike == pytest.approx(alike, abs=0.1)
    np.testing.assert_allclose(np.sqrt(found.left), LEFT, rtol=0.2)
    rest = np.delete(np.sqrt(found.between), healthy_torques.STEADY, axis=1)
    np.testing.assert_allclose(rest, BETWEEN, rtol=0.3)
    spread = np.sqrt(np.einsum("jkk->jk", found.unknown))
    wrong = (found.mean - robot) / spread
    assert np.sqrt(np.mean(wrong**2)) == pytest.approx(1.0, abs=0.25)


def test_new_recordings_of_the_robot_are_white(robot):
    found = HealthyTorques.of(means(0, 8, robot))
    white = whitened(found, means(1, 3, robot))
    assert np.mean(white**2) == pytest.approx(1.0, abs=0.1)
    # those of another robot are not
    other = whitened(found, means(1, 3, -robot))
    assert np.mean(other**2) > 2


def test_what_never_moved_before_is_no_evidence(robot):
    """As the command of a joint that stood still in the healthy recordings."""
    healthy, other = means(0, 8, robot), means(1, 3, robot)
    healthy.columns[:, 2, -1] = 0
    other.columns[:, 2, -1] *= 1e3
    other.missing[:, 2] += 0.5 * other.columns[:, 2, -1]  # 10,000 noises
    white = whitened(HealthyTorques.of(healthy), other)
    assert np.mean(white[2] ** 2) < 1.3
    white = whitened(HealthyTorques.of(means(0, 8, robot)), other)
    assert np.mean(white[2] ** 2) > 100


@pytest.mark.parametrize("factor", [0.5, 2.0])
def test_how_far_what_is_unknown_reaches_does_not_matter(monkeypatch, factor, robot):
    monkeypatch.setattr(healthy_torques, "FAR", factor * healthy_torques.FAR)
    test_what_never_moved_before_is_no_evidence(robot)


def test_evidence_is_the_density_of_the_whole_covariance(robot):
    one = means(0, 2, robot)
    for j in range(JOINTS):
        x = one.columns[:, j]
        joint = JointErrors.of(one, j)
        usual = np.full(K, 0.04)
        between, left = np.full(K, 0.01), np.array([0.002, 0.003])
        expected = joint.expected(usual, between, left, 0.5)
        x = x / joint.size
        same = one.recording[:, None] == one.recording
        apart = np.abs(one.block[:, None] - one.block)
        scale = np.sqrt(left[one.recording])
        noise = scale[:, None] * scale * 0.5**apart
        covariance = (x * usual) @ x.T + same * ((x * between) @ x.T + noise)
        density = multivariate_normal(cov=covariance).logpdf(one.missing[:, j])
        constant = 0.5 * len(x) * np.log(2 * np.pi)
        assert expected.evidence == pytest.approx(density + constant, rel=1e-8)


CONSTANTS = "USUAL", "USUAL_COUNT", "BETWEEN", "BETWEEN_COUNT", "ALIKE_COUNT", "LEAST"


@pytest.mark.parametrize("name", [*CONSTANTS, "ROUNDS"])
@pytest.mark.parametrize("factor", [0.5, 2.0])
def test_a_factor_of_two_in_a_constant_hardly_matters(monkeypatch, robot, name, factor):
    value = getattr(healthy_torques, name)
    monkeypatch.setattr(healthy_torques, name, type(value)(factor * value))
    healthy, same = means(0, 3, robot), means(1, 3, robot)
    changed = means(1, 3, robot, added=0.05)
    as_before = HealthyTorques.of(healthy, same).evidence
    unseen = HealthyTorques.of(healthy, changed).evidence
    # the change shows: without it the same recordings are far likelier
    assert 20 < as_before - unseen < 200
    found = HealthyTorques.of(healthy, same)
    assert np.mean(whitened(found, same) ** 2) == pytest.approx(1.0, abs=0.25)


def test_more_noise_in_one_recording_is_not_taken_for_more_in_all(robot):
    other = means(1, 3, robot)
    other.missing[other.recording == 1] += 0.5 * np.random.default_rng(
        2
    ).standard_normal((BLOCKS, JOINTS))
    found = HealthyTorques.of(means(0, 3, robot), other)
    quiet, loud = (np.sqrt(found.left_in[other.names[i]]) for i in (0, 1))
    np.testing.assert_allclose(quiet, LEFT, rtol=0.3)
    np.testing.assert_allclose(loud, np.hypot(LEFT, 0.5), rtol=0.3)

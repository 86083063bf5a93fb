"""When torques are compared, and how motions are smoothed for them."""

from dataclasses import replace

import numpy as np
import pytest
from joint_rigs import PENDULUM, SLED, plant_of, servo_of, ticks, trace_of
from torque_arm import arm, moved

from diagnosis.residuals.torques import torque_evidence
from diagnosis.residuals.torques.torque_evidence import (
    block_s,
    cutoff_hz,
    torques_tell,
    with_motions,
    with_used_torques,
)
from diagnosis.traces.trace import driven_by_torques


def sled(friction_n, duration_s=6.0):
    """A sled that a force moves, of whose friction its model does not know."""
    plant = plant_of(SLED)
    time_s = ticks(duration_s)
    velocity = 0.5 * np.cos(3 * time_s)
    force = -2.0 * 1.5 * np.sin(3 * time_s) + friction_n * np.sign(velocity)
    position = np.sin(3 * time_s) / 6
    return plant, trace_of(plant, time_s, position, torque_nm=force)


def test_torques_tell_where_no_servo_is_known():
    plant, trace = sled(0.1)
    assert "no servo is known" in torques_tell(plant, [trace], held=False)
    assert not torques_tell(plant, [replace(trace, torque_nm=None)], held=False)
    zero = np.zeros_like(trace.torque_nm)
    assert not torques_tell(plant, [replace(trace, torque_nm=zero)], held=False)
    targets = replace(trace, command_torque_nm=trace.torque_nm)
    assert not torques_tell(plant, [targets], held=False)
    known = replace(trace, servo=servo_of(1, 10.0, 1.0), command_rad=trace.position_rad)
    assert not torques_tell(plant, [known], held=True)


@pytest.mark.parametrize(("friction_n", "tells"), [(0.1, False), (50.0, True)])
def test_beside_a_known_servo_a_replay_counts_while_it_stays_near(friction_n, tells):
    plant, trace = sled(friction_n)
    known = replace(trace, servo=servo_of(1, 10.0, 1.0), command_rad=trace.position_rad)
    why = torques_tell(plant, [driven_by_torques(known)], held=True)
    assert ("leaves the recorded motion" in why) is tells


@pytest.mark.parametrize("factor", [0.5, 2.0])
def test_how_far_is_far_hardly_matters(monkeypatch, factor):
    monkeypatch.setattr(torque_evidence, "FAR", factor * torque_evidence.FAR)
    for friction_n, tells in ((0.1, False), (50.0, True)):
        plant, trace = sled(friction_n)
        assert bool(torques_tell(plant, [driven_by_torques(trace)], True)) is tells


def test_noisier_motion_is_smoothed_more():
    highest = [cutoff_hz(arm(), [moved(noise_rad=noise)]) for noise in (1e-6, 1e-3)]
    # the motion has frequencies up to 4 rad/s, and friction none
    assert 4 / (2 * np.pi) < highest[1] < highest[0] / 2
    assert highest[0] == pytest.approx(25.0)


def test_a_motion_is_that_of_the_joints():
    plant, trace = arm(), moved(noise_rad=1e-4)
    (smoothed,) = with_motions(plant, [trace])
    truth = moved(noise_rad=0.0)
    motion, rows = smoothed.motion, slice(100, -100)
    wrong = (motion.position_rad - truth.position_rad)[rows]
    assert wrong.std() < 0.7e-4
    rate = np.gradient(truth.position_rad, truth.time_s, axis=0)
    assert (motion.velocity_rad_s - rate)[rows].std() < 5e-3
    part = smoothed.part(100, 300)
    np.testing.assert_array_equal(part.motion.counts, motion.counts[100:300])
    np.testing.assert_array_equal(part.of([1]).motion.noise_nm, motion.noise_nm[1:2])


def test_joints_at_rest_say_nothing():
    trace = moved()
    still = trace.position_rad.copy()
    still[200:600, 1] = still[200, 1]
    (smoothed,) = with_motions(arm(), [replace(trace, position_rad=still)])
    counts = smoothed.motion.counts
    assert not counts[220:580, 1].any()
    assert counts[220:580, 0].mean() > 0.5


def test_the_noise_is_that_of_torques_and_of_smoothed_accelerations():
    """Torques of the nominal model, plus noise: what is left has the stated size."""
    plant, trace = arm(), moved(noise_rad=1e-3)
    (smoothed,) = with_motions(plant, [trace])
    motion = smoothed.motion
    assert (motion.left_nm < 2 * motion.noise_nm).all()
    # torques are known to 2 % at best
    (quiet,) = with_motions(plant, [moved(noise_rad=0.0)])
    size = np.sqrt(np.mean(quiet.torque_nm**2, axis=0))
    assert (quiet.motion.noise_nm >= 0.02 * size - 1e-9).all()
    assert (quiet.motion.noise_nm < motion.noise_nm + 1e-9).all()


def test_blocks_grow_where_errors_last():
    plant, trace = arm(), moved()
    short_s = block_s(plant, [trace], 25.0)
    drift = 2.0 * np.sin(0.6 * trace.time_s)[:, None] * np.ones(3)
    wrong = replace(trace, torque_nm=trace.torque_nm + drift)
    long_s = block_s(plant, [wrong], 25.0)
    assert short_s == pytest.approx(0.02)
    # but no longer than an eighth of the period of quick motion, here of 4 rad/s
    assert 2 * short_s < long_s < 2 * np.pi / 4 / 2


def test_large_torques_are_those_measured():
    plant, trace = arm(), moved(duration_s=2.0)
    used = with_used_torques(plant, [trace]).used_nm
    np.testing.assert_array_equal(used, np.abs(trace.torque_nm).max(axis=0))


def test_a_pendulum_that_swings_freely_is_replayed():
    plant = plant_of(PENDULUM)
    time_s = ticks(3.0)
    trace = trace_of(plant, time_s, np.sin(time_s), command_torque_nm=0 * time_s)
    assert not torques_tell(plant, [trace], held=False)

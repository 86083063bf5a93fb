"""Planned motions keep a model's limits, as an own simulation of them shows."""

from dataclasses import replace

import mujoco
import numpy as np
import pytest
from joint_rigs import GRAVITY, LINKS_KG, LINKS_M, plant_of, servo_of
from made_up_traces import arm

from diagnosis.motions.plan import MOST_RAD, TORQUE_USED, Limits, planned
from groundwalk.errors import BadValueError

STRONG_NM = 8.0


def limited(torque_nm=STRONG_NM, low=-1.0, high=0.6):
    """The arm with limits of torque, and of the elbow's range."""
    plant = arm(limit=torque_nm)
    spec = plant.spec.copy()
    elbow = spec.joint("elbow")
    elbow.range = np.degrees([low, high])  # the unit of the file
    elbow.limited = mujoco.mjtLimited.mjLIMITED_TRUE
    return replace(plant, spec=spec)


def followed(plant, trace):
    """(T, j) positions and torques of the arm, by MuJoCo itself and the servo's law."""
    model = plant.model
    model.opt.timestep = 1e-3
    data = mujoco.MjData(model)
    data.qpos[:] = trace.command_rad[0]
    servo, found = plant.servo, []
    for command in trace.command_rad:
        for _ in range(10):
            nm = servo.torque(command - data.qpos, data.qvel)
            data.qfrc_applied[:] = nm
            mujoco.mj_step(model, data)
            found.append((data.qpos.copy(), nm))
    position, torque_nm = map(np.array, zip(*found, strict=True))
    return position, torque_nm


@pytest.fixture(scope="module")
def plans():
    plant = limited()
    return plant, planned(plant, Limits.of(plant))


def test_every_motion_is_planned(plans):
    assert [one.motion.name for one in plans[1]] == [
        "slow_ramps", "holds", "chirp", "reversals", "steps", "sweeps",
    ]  # fmt: skip


def test_an_own_simulation_stays_within_all_limits(plans):
    plant, motions = plans
    for one in motions:
        position, torque_nm = followed(plant, one.trace)
        assert (position[:, 1] > -1.0).all()
        assert (position[:, 1] < 0.6).all()
        assert np.abs(torque_nm).max() < STRONG_NM
        speed = np.abs(np.diff(position, axis=0)).max() / 1e-3
        assert speed < 5.5  # the model states none: 5 rad/s
        moved = np.ptp(position, axis=0)
        assert (moved > 0.05).all()


def test_motions_begin_in_the_middle_of_the_range(plans):
    for one in plans[1]:
        assert one.trace.command_rad[0] == pytest.approx([0.0, -0.2])
        half = np.abs(one.trace.command_rad - [0.0, -0.2]).max(axis=0)
        assert half[0] <= MOST_RAD + 1e-9
        assert half[1] <= 0.9 * 0.8 + 1e-9


def test_weak_servos_get_smaller_motions():
    """Servos that cannot hold the arm as far from hanging as motions would go."""
    weight_nm = GRAVITY * (LINKS_KG[0] * LINKS_M[0] + LINKS_KG[1] * sum(LINKS_M))
    limit_nm = 0.4 * weight_nm
    weak = limited(torque_nm=limit_nm)
    strong = planned(limited(), Limits.of(limited()))
    found = {one.motion.name: one for one in planned(weak, Limits.of(weak))}
    for one in strong:
        if one.motion.name in found:
            assert (found[one.motion.name].share <= one.share).all()
    position, torque_nm = followed(weak, found["holds"].trace)
    assert found["holds"].share[0] < 1.0
    assert np.abs(torque_nm).max() <= limit_nm * TORQUE_USED * 1.05
    assert np.isfinite(position).all()


@pytest.mark.slow
def test_servos_that_hold_nothing_get_no_motion():
    plant = limited(torque_nm=1e-3)
    assert planned(plant, Limits.of(plant)) == []


def test_without_servos_nothing_can_be_planned():
    plant = replace(limited(), servo=servo_of(2))
    with pytest.raises(BadValueError, match="--kp"):
        Limits.of(plant)


def test_a_user_may_ask_for_slow_motions():
    plant = limited()
    for one in planned(plant, Limits.of(plant, most_rad_s=0.5)):
        if not one.motion.sudden:
            speed = np.abs(np.diff(one.trace.command_rad, axis=0)).max() * 100
            assert speed <= 0.26  # half, to rounding of ticks


def test_a_model_without_a_range_gets_one(plans):
    plant = plant_of('<body name="wheel"><joint name="hinge" axis="0 0 1"/>'
                     '<inertial pos="0 0 0" mass="1" diaginertia="1 1 .02"/></body>',
                     kp=10.0, kd=0.5, limit=3.0)  # fmt: skip
    limits = Limits.of(plant)
    assert limits.amplitude_rad == pytest.approx([MOST_RAD])

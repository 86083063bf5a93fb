"""Targets that jump within a step, by more than takes a servo to its limit."""

import numpy as np
import pytest
from joint_rigs import INERTIA, WHEEL, exact, integrated, plant_of, run_from, trace_of

LIMIT_NM, KP, STEP_S = 1.0, 20.0, 0.004
TIME_S = np.arange(12) * 0.01


def jumping(plant, at_s, jump_rad):
    """A target that jumps in the third row, which is as late as one likes."""
    time_s = TIME_S.copy()
    time_s[2] = at_s
    target = np.where(time_s >= at_s, jump_rad, 0.0)
    return run_from(trace_of(plant, time_s, command_rad=target))


@pytest.mark.parametrize("at_s", [0.0201, 0.0213, 0.0227, 0.0239])
def test_a_servo_at_its_limit_pushes_from_the_jump_on(at_s):
    """x = 1/2 (limit / inertia) t^2: a step that is 1 ms late would miss 4 mrad."""
    plant = plant_of(WHEEL, kp=KP, limit=LIMIT_NM)
    found = exact(plant, jumping(plant, at_s, 2.0), step_s=STEP_S)[:, 0]
    wanted = 0.5 * LIMIT_NM / INERTIA * np.clip(TIME_S - at_s, 0, None) ** 2
    np.testing.assert_allclose(found[3:], wanted[3:], atol=4e-4)
    # the servo at the mean target, at its limit from the step's begin on
    early = 0.5 * LIMIT_NM / INERTIA * (TIME_S[-1] - 0.02) ** 2
    if at_s > 0.0213:
        assert abs(early - wanted[-1]) > 5e-3


@pytest.mark.parametrize("jump_rad", [0.07, -0.3])
def test_a_jump_that_brings_a_servo_to_its_limit_for_a_while(jump_rad):
    plant = plant_of(WHEEL, kp=KP, kd=0.3, limit=LIMIT_NM)
    run = jumping(plant, 0.0227, jump_rad)
    target = run.trace.command_rad[:, 0]

    def law(_, state, k):
        torque = KP * (target[k] - state[0]) - 0.3 * state[1]
        return [state[1], np.clip(torque, -LIMIT_NM, LIMIT_NM) / INERTIA]

    wanted = integrated(law, run.trace.time_s, [0.0, 0.0])[:, 0]
    found = exact(plant, run, step_s=STEP_S)[:, 0]
    np.testing.assert_allclose(found, wanted, atol=2e-3 * abs(jump_rad))


def test_slow_setpoints_do_not_jump():
    """A servo that takes its target there slowly follows as one that is told to."""
    plant = plant_of(WHEEL, kp=KP, kd=0.3, limit=LIMIT_NM)
    slow = ("speed_limit", "hinge", 2.0)
    jump = jumping(plant, 0.0227, 1.0)
    found = exact(plant, jump, slow, step_s=STEP_S)[:, 0]

    def law(time_s, state, k):
        target = 2.0 * max(time_s - 0.0227, 0.0)
        torque = KP * (target - state[0]) - 0.3 * state[1]
        return [state[1], np.clip(torque, -LIMIT_NM, LIMIT_NM) / INERTIA]

    wanted = integrated(law, jump.trace.time_s, [0.0, 0.0])[:, 0]
    np.testing.assert_allclose(found, wanted, atol=3e-3)


@pytest.mark.parametrize("limit_nm", [0.5, 100.0])
def test_a_joint_apart_from_its_motor_coasts(limit_nm):
    """However much the servo would brake it, and whether it could."""
    plant = plant_of(WHEEL, kp=KP, kd=1.0, limit=limit_nm, emf=0.1)
    trace = trace_of(plant, TIME_S, command_rad=np.zeros(len(TIME_S)))
    run = run_from(trace, velocity_rad_s=2.0)
    wide = ("backlash", "hinge", 1.0)
    found = exact(plant, run, wide, step_s=STEP_S)[:, 0]
    np.testing.assert_allclose(found, 2.0 * TIME_S, atol=2e-3)
    braked = exact(plant, run, step_s=STEP_S)[:, 0]
    assert braked[-1] < 0.8 * found[-1]


def strongly_damped(jump_rad):
    """Where a wheel goes whose damping stops it within one step, and where it should.

    The target jumps at the begin of a step.
    """
    kd = INERTIA / STEP_S
    plant = plant_of(WHEEL, kp=KP, kd=kd, limit=LIMIT_NM)
    run = jumping(plant, 0.02, jump_rad)
    target = run.trace.command_rad[:, 0]

    def law(_, state, k):
        torque = KP * (target[k] - state[0]) - kd * state[1]
        return [state[1], np.clip(torque, -LIMIT_NM, LIMIT_NM) / INERTIA]

    wanted = integrated(law, run.trace.time_s, [0.0, 0.0])[:, 0]
    return exact(plant, run, step_s=STEP_S)[:, 0], wanted


def test_what_is_just_above_the_limit_moves_as_what_is_just_below():
    """MuJoCo leaves the damping out where a step begins with a servo at its limit."""
    just = LIMIT_NM / KP
    below, above = (strongly_damped(k * just)[0] for k in (0.999, 1.001))
    np.testing.assert_allclose(above, below, rtol=3e-3, atol=1e-9)


@pytest.mark.parametrize("asked", [1.05, 1.5, 1.9, 2.5, 5.0])
def test_strong_damping_at_the_limit(asked):
    found, wanted = strongly_damped(asked * LIMIT_NM / KP)
    assert abs(found - wanted).max() < 0.006 * abs(wanted).max()


@pytest.mark.parametrize("share", [0.0, 0.25, 0.9])
def test_a_damped_servo_at_its_limit_moves_alike_wherever_in_a_step_it_jumps(share):
    """A jump that is a little later moves the joint a little later, and not another."""
    plant = plant_of(WHEEL, kp=200.0, kd=6.0, limit=LIMIT_NM)
    at_s = 0.02 + share * STEP_S
    runs = [jumping(plant, at_s + late, 1.0) for late in (0.0, 1e-7)]
    first, second = (exact(plant, run, step_s=STEP_S)[:, 0] for run in runs)
    np.testing.assert_allclose(first, second, atol=1e-5)
    wanted = 0.5 * LIMIT_NM / INERTIA * np.clip(TIME_S - at_s, 0, None) ** 2
    np.testing.assert_allclose(first[3:6], wanted[3:6], rtol=0.05, atol=2e-4)

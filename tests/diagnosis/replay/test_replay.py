"""Replays of one joint against closed forms and an integrator of another library."""

import mujoco
import numpy as np
import pytest
from joint_rigs import (
    ARM,
    INERTIA,
    PENDULUM,
    WHEEL,
    arm_law,
    exact,
    integrated,
    plant_of,
    replayed,
    run_from,
    servo_of,
    smooth_command,
    trace_of,
)
from wheel_rig import (
    COMMAND,
    EMF,
    HINGE,
    KD,
    KP,
    LIMIT,
    TIME_S,
    TOLERANCE,
    commanded,
    driven,
    servo_law,
    wheel,
)

from diagnosis.effects.parts import PlacedEffect
from diagnosis.replay.replay import replay
from diagnosis.residuals.replays import variants_of

# The servo


@pytest.mark.parametrize("limit", [np.inf, LIMIT])
def test_a_servo_follows_its_law(limit):
    plant = wheel(limit=limit)
    truth = integrated(servo_law(limit=limit), TIME_S, [0.1, 2.0])
    found = exact(plant, commanded(plant, position_rad=0.1, velocity_rad_s=2.0))
    assert np.abs(found[:, 0] - truth[:, 0]).max() < TOLERANCE


def test_a_saturated_servo_pushes_evenly_and_back_emf_is_beside_the_limit():
    """v = (L / emf) (1 - exp(-emf t / I)) while the error is large."""
    plant = wheel(kp=1.0, kd=0.0, limit=LIMIT, emf=0.1)
    run = commanded(plant, np.full(len(TIME_S), 50.0))
    _, velocity = replayed(plant, run, step_s=1e-4)
    rate = 0.1 / INERTIA
    wanted = LIMIT / 0.1 * (1 - np.exp(-rate * TIME_S))
    np.testing.assert_allclose(velocity[:, 0], wanted, atol=2e-3)


def test_each_trace_has_its_own_servo():
    plant = wheel()
    other = wheel(kp=1.0, kd=0.02, emf=0.15, limit=LIMIT)
    runs = [commanded(plant), commanded(other)]
    truth = integrated(
        servo_law(kp=1.0, kd=0.02, emf=0.15, limit=LIMIT), TIME_S, [0, 0]
    )
    own = integrated(servo_law(), TIME_S, [0, 0])
    coarse, fine = (replay(runs, variants_of(plant, [()]), h) for h in (1e-3, 5e-4))
    for k, wanted in enumerate((own, truth)):
        found = 2 * fine[k].position_rad[0] - coarse[k].position_rad[0]
        assert np.abs(found[:, 0] - wanted[:, 0]).max() < TOLERANCE


def test_the_error_is_of_the_first_order():
    plant = wheel()
    truth = integrated(servo_law(), TIME_S, [0, 0])[:, 0]
    coarse, fine = (
        np.abs(replayed(plant, commanded(plant), step_s=h)[0][:, 0] - truth).max()
        for h in (4e-3, 1e-3)
    )
    assert fine < coarse / 3


def test_rows_may_be_uneven():
    random = np.random.default_rng(1)
    time_s = 3.0 + np.cumsum(random.uniform(0.004, 0.016, 80))
    command = smooth_command(time_s - 3.0)
    plant = wheel()
    truth = integrated(servo_law(command), time_s, [0, 0])
    found = exact(plant, commanded(plant, command, time_s))
    assert np.abs(found[:, 0] - truth[:, 0]).max() < TOLERANCE


def test_velocities_are_those_of_the_positions():
    plant = wheel()
    truth = integrated(servo_law(), TIME_S, [0, 0])
    _, velocity = replayed(plant, commanded(plant), step_s=1e-4)
    assert np.abs(velocity[:, 0] - truth[:, 1]).max() < 5e-3
    assert np.abs(truth[:, 1]).max() > 1


def test_one_row_is_where_it_began():
    """Of a window's last row, say; nothing lasts, so that no torque has a mean."""
    plant = wheel()
    run = commanded(plant, np.zeros(1), np.zeros(1), position_rad=0.1)
    (found,) = replay([run], variants_of(plant, [()]), 1e-3)
    assert found.position_rad[0] == pytest.approx(np.array([[0.1]]))
    assert found.servo_nm[0] == pytest.approx(np.zeros((1, 1)))


def test_a_missing_command_is_the_one_before_it():
    plant = wheel()
    gaps = COMMAND.copy()
    gaps[20:26] = np.nan
    held = COMMAND.copy()
    held[20:26] = COMMAND[19]
    truth = integrated(servo_law(held), TIME_S, [0, 0])
    found = exact(plant, commanded(plant, gaps))
    assert np.abs(found[:, 0] - truth[:, 0]).max() < TOLERANCE


def test_two_links_move_each_other():
    plant = plant_of(ARM, kp=8.0, kd=0.2)
    command = np.stack([COMMAND, -1.5 * COMMAND], axis=1)
    law = arm_law(lambda t, q, v, k: 8.0 * (command[k] - q) - 0.2 * v)
    truth = integrated(law, TIME_S, [0, 0, 0, 0])[:, :2]
    run = commanded(plant, command)
    assert np.abs(exact(plant, run) - truth).max() < 3e-5
    assert np.abs(replayed(plant, run, step_s=2e-3)[0] - truth).max() > 3e-4


# Torques instead of positions


def test_a_torque_turns_a_wheel():
    """q = T t^2 / (2 I), v = T t / I."""
    plant, run = driven(np.full(len(TIME_S), 0.1))
    position, velocity = replayed(plant, run, step_s=1e-4)
    np.testing.assert_allclose(velocity[:, 0], 0.1 * TIME_S / INERTIA, atol=1e-6)
    wanted = 0.1 * TIME_S**2 / 2 / INERTIA
    np.testing.assert_allclose(position[:, 0], wanted, atol=3e-4)


@pytest.mark.parametrize("channel", ["torque_nm", "command_torque_nm"])
def test_where_torques_drive_no_servo_pulls(channel):
    """The servo's law has no command then; back-EMF is the motor's, and stays."""
    plant = wheel()
    trace = trace_of(plant, TIME_S, **{channel: np.full(len(TIME_S), 0.1)})
    found = exact(plant, run_from(trace, position_rad=0.2))[:, 0]
    rate = EMF / INERTIA
    wanted = 0.2 + 0.1 / EMF * (TIME_S - (1 - np.exp(-rate * TIME_S)) / rate)
    np.testing.assert_allclose(found, wanted, atol=TOLERANCE)


# Batches


def test_variants_and_runs_do_not_touch_each_other():
    plant = plant_of(ARM, kp=8.0, kd=0.2)
    command = np.stack([COMMAND, -COMMAND], axis=1)
    models = [
        (),
        (PlacedEffect("backlash", "elbow", (0.05,)),),
        (PlacedEffect("coulomb_friction", "shoulder", (0.3,)),),
        (PlacedEffect("command_latency", "commands", (0.0071,)),),
        (PlacedEffect("joint_elasticity", "elbow", (30.0, 0.05)),),
        (PlacedEffect("drag", "lower", (3.0,)),),
        (PlacedEffect("external_force", "lower", (3.0, 0, 0, 0.1, 0.1)),),
        (PlacedEffect("speed_limit", "elbow", (1.0,)),),
        (PlacedEffect("servo_fade", "elbow", (0.05,)),),
        (PlacedEffect("stribeck_friction", "elbow", (0.1, 0.1, 0.1)),),
    ]
    short = slice(0, 40)
    runs = [
        commanded(plant, command),
        commanded(plant, command[short] + 0.1, 7 + TIME_S[short], velocity_rad_s=0.3),
    ]
    together = replay(runs, variants_of(plant, models))
    for k, run in enumerate(runs):
        for row, model in enumerate(models):
            (alone,) = replay([run], variants_of(plant, [model]))
            for name in ("position_rad", "velocity_rad_s"):
                np.testing.assert_allclose(
                    getattr(together[k], name)[row],
                    getattr(alone, name)[0],
                    atol=1e-9,
                    err_msg=str(model),
                )


def test_what_blows_up_stays_alone(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)  # MuJoCo writes a log
    plant = plant_of(WHEEL, kp=KP, kd=KD)
    burst = (PlacedEffect("servo_gain", HINGE, (1e9,)),)
    (result,) = replay([commanded(plant)], variants_of(plant, [(), burst, ()]))
    (alone,) = replay([commanded(plant)], variants_of(plant, [()]))
    assert not np.abs(result.position_rad[1, -1]).max() < 1e3  # or not a number
    for row in (0, 2):
        np.testing.assert_allclose(result.position_rad[row], alone.position_rad[0])


def test_a_replay_leaves_the_plant_as_it_was():
    plant = wheel(limit=LIMIT)
    size = mujoco.mj_sizeModel(plant.model)
    before, after = (np.zeros(size, np.uint8) for _ in range(2))
    mujoco.mj_saveModel(plant.model, None, before)
    replayed(plant, commanded(plant), ("servo_gain", HINGE, 0.5))
    mujoco.mj_saveModel(plant.model, None, after)
    np.testing.assert_array_equal(before, after)


def test_fading_servos_leave_springs_of_other_rows_alone():
    plant = plant_of(PENDULUM, kp=KP, kd=KD, armature=0.01)
    run = commanded(plant, 1 + COMMAND, position_rad=1.0)
    soft = PlacedEffect("joint_elasticity", HINGE, (20.0, 0.1))
    fade = PlacedEffect("servo_fade", HINGE, (0.5,))
    models = [(soft,), (fade,), (soft, fade), ()]
    (result,) = replay([run], variants_of(plant, models))
    (alone,) = replay([run], variants_of(plant, models[:1]))
    np.testing.assert_allclose(result.position_rad[0], alone.position_rad[0])
    # what fading does to a joint on a spring is near what it does to a rigid one
    on_spring = result.position_rad[2] - result.position_rad[0]
    rigid = result.position_rad[1] - result.position_rad[3]
    assert np.abs(rigid).max() > 0.04
    assert np.abs(on_spring - rigid).max() < 0.35 * np.abs(rigid).max()


def test_threads_change_nothing():
    plant = plant_of(ARM, kp=8.0, kd=0.2)
    run = commanded(plant, np.stack([COMMAND, -COMMAND], axis=1))
    models = [
        (PlacedEffect("servo_gain", "elbow", (x,)),) for x in (0.5, 1.0, 1.5, 2.0)
    ]
    (one,) = replay([run], variants_of(plant, models), threads=1)
    (two,) = replay([run], variants_of(plant, models), threads=2)
    np.testing.assert_array_equal(one.position_rad, two.position_rad)


def test_servos_of_zero_do_nothing():
    plant = plant_of(WHEEL)
    assert plant.servo.kp_nm_rad == servo_of(1).kp_nm_rad
    found, _ = replayed(plant, commanded(plant, velocity_rad_s=1.0))
    np.testing.assert_allclose(found[:, 0], TIME_S, atol=1e-9)

"""What firmware does with a servo's error, against another integrator."""

from dataclasses import replace

import numpy as np
import pytest
from joint_rigs import (
    INERTIA,
    PENDULUM,
    PENDULUM_LEVER_NM,
    exact,
    integrated,
    plant_of,
    replayed,
    ticks,
)
from wheel_rig import (
    COMMAND,
    EMF,
    HINGE,
    KD,
    KP,
    TIME_S,
    TOLERANCE,
    commanded,
    wheel,
)

from diagnosis.effects.parts import PlacedEffect
from diagnosis.effects.variants import Joints
from diagnosis.replay import controllers as module
from diagnosis.replay.controllers import (
    DERIVATIVE_LAGS,
    BatchControllers,
    derivative_lag_s,
)
from diagnosis.replay.replay import replay
from diagnosis.residuals.replays import variants_of

STEP_S = 0.001
INTEGRAL_S = 0.2


def controllers(limit=np.inf, kd=KD, **joints):
    """Controllers of one servo, with some of the attributes of `Joints`."""
    own = vars(Joints.neutral(1, 1))
    own |= {name: np.full((1, 1), value) for name, value in joints.items()}
    law = {"kp": KP, "kd": kd, "limit": limit}
    law = {name: np.full((1, 1), float(value)) for name, value in law.items()}
    return BatchControllers(own, law, STEP_S)


def one(value):
    return np.full((1, 1), float(value))


def model_of(*effects):
    return tuple(PlacedEffect(name, place, values) for name, place, *values in effects)


def through(own, target, seen, speed=0.0):
    return float(own.through(one(target), one(target), one(seen), one(speed))[0, 0])


# Integral term


def integrating(command=COMMAND, weight_nm=0.0, time_s=INTEGRAL_S):
    """y' of angle, speed and integral of the error [rad] of a wheel or pendulum."""

    def law(t, y, k):
        q, v, summed = y
        error = command[k] - q
        torque = KP * (error + summed) - (KD + EMF) * v - weight_nm * np.sin(q)
        return [v, torque / INERTIA, error / time_s]

    return law


def test_an_integral_term_adds_up_the_error():
    truth = integrated(integrating(), TIME_S, np.zeros(3))[:, 0]
    plant = wheel()
    effect = ("integral_term", HINGE, INTEGRAL_S)
    found = exact(plant, commanded(plant), effect)[:, 0]
    assert np.abs(found - truth).max() < TOLERANCE
    assert np.abs(exact(plant, commanded(plant))[:, 0] - truth).max() > 0.01


def test_it_winds_up_to_the_largest_torque_and_back_at_once():
    own = controllers(limit=0.6, integral_1_s=2.0)
    own.begin(one(0.0))
    for k in range(1, 101):
        target = through(own, 0.05, 0.05 - 0.02) - (0.05 - 0.02)
        # e + int e dt / time, less what is there for no torque at first
        assert target == pytest.approx(0.02 + 2.0 * 0.02 * k * STEP_S - 0.02)
    for _ in range(100_000):
        target = through(own, 0.05, 0.03)
    assert target == pytest.approx(0.05 + 0.6 / KP)
    back = through(own, 0.0, 0.5) - 0.5
    assert back == pytest.approx(-0.5 + 0.6 / KP - 2.0 * 0.5 * STEP_S)


def test_two_integral_terms_add_their_gains():
    plant = wheel()
    twice = [("integral_term", HINGE, time_s) for time_s in (0.3, 0.6)]
    found, _ = replayed(plant, commanded(plant), *twice)
    same, _ = replayed(plant, commanded(plant), ("integral_term", HINGE, 0.2))
    np.testing.assert_allclose(found, same, atol=1e-12)


def pendulum():
    return plant_of(PENDULUM, kp=KP, kd=KD, emf=EMF)


def test_at_first_it_holds_what_gravity_needs():
    """Where it began at 0 the pendulum would fall until the integral has wound up."""
    plant, time_s, start = pendulum(), ticks(1.0), 0.8
    command = np.full(len(time_s), 0.85)
    held = PENDULUM_LEVER_NM * np.sin(start) / KP - (0.85 - start)
    law = integrating(command, PENDULUM_LEVER_NM)
    truth, fallen = (
        integrated(law, time_s, [start, 0.0, summed])[:, 0] for summed in (held, 0.0)
    )
    effect = ("integral_term", HINGE, INTEGRAL_S)
    run = commanded(plant, command, time_s, position_rad=start)
    found = exact(plant, run, effect)[:, 0]
    assert np.abs(found - truth).max() < 2 * TOLERANCE
    assert np.abs(fallen - truth).max() > 0.05


@pytest.mark.parametrize("time_s", [20.0, 60.0, 200.0])
def test_an_integral_has_grown_for_a_minute(time_s):
    """By its time constant, towards the torque that holds the joint."""
    own = controllers(integral_1_s=1 / time_s)
    held_nm, error = 0.5, 0.02
    own.begin(one(held_nm))
    target = through(own, 0.1, 0.1 - error)
    grown = (1 - np.exp(-60 / time_s)) * (held_nm / KP - error)
    wanted = 0.1 + grown + error * STEP_S / time_s
    assert target == pytest.approx(wanted, abs=1e-12)


@pytest.mark.parametrize("known", [True, False])
def test_in_the_midst_of_a_motion_it_gives_what_that_needs(known):
    """From the acceleration, too: without it 50 times the tolerance is lost."""
    plant, row = pendulum(), 30
    law = integrating(COMMAND, PENDULUM_LEVER_NM)
    states = integrated(law, TIME_S, np.zeros(3))
    q, v, _ = states[row]
    rising = law(0.0, states[row], row)[1] if known else None
    run = commanded(plant, COMMAND[row:], TIME_S[row:], position_rad=q)
    run = replace(
        run,
        velocity_rad_s=np.array([v]),
        acceleration_rad_s2=None if rising is None else np.array([rising]),
    )
    found = exact(plant, run, ("integral_term", HINGE, INTEGRAL_S))[:, 0]
    off = np.abs(found - states[row:, 0]).max()
    assert off < 2 * TOLERANCE if known else off > 100 * TOLERANCE


def test_dry_friction_a_spring_and_a_constant_torque_count_at_the_start(monkeypatch):
    """A wheel that turns against all of them; its integral stays as it begins."""
    monkeypatch.setattr(module, "ON_S", 1e12)  # even the longest has gathered all
    plant, time_s = wheel(), ticks(0.3)
    speed, friction, constant, stiffness, rest = 0.8, 0.05, 0.06, 0.3, 0.5
    command = 0.1 + speed * time_s

    def load_nm(q, v):
        return EMF * v + friction * np.sign(v) + stiffness * (q - rest) - constant

    summed = (load_nm(0.0, speed) + KD * speed) / KP - command[0]

    def law(t, y, k):
        q, v = y
        torque = KP * (command[k] - q + summed) - KD * v - load_nm(q, v)
        return [v, torque / INERTIA]

    truth = integrated(law, time_s, [0.0, speed])
    assert (truth[:, 1] > 0.1).all()
    effects = [
        ("coulomb_friction", HINGE, friction),
        ("torque_offset", HINGE, constant),
        ("joint_spring", HINGE, stiffness, rest),
        ("integral_term", HINGE, 1e9),
    ]
    run = commanded(plant, command, time_s, velocity_rad_s=speed)
    found = exact(plant, run, *effects)[:, 0]
    assert np.abs(found - truth[:, 0]).max() < 1e-4  # MuJoCo's friction is soft
    assert np.abs(exact(plant, run, *effects[:3])[:, 0] - truth[:, 0]).max() > 0.02


def test_an_elastic_joint_s_servo_sees_its_motor():
    """At last the motor is at the command, and the link sags by the spring's twist."""
    plant = plant_of(PENDULUM, kp=KP, kd=0.3, armature=0.005)
    time_s, stiffness = ticks(8.0), 20.0
    command = np.full(len(time_s), 0.8)
    run = commanded(plant, command, time_s, position_rad=0.8)
    effects = [
        ("joint_elasticity", HINGE, stiffness, 0.05),
        ("integral_term", HINGE, INTEGRAL_S),
    ]
    model = variants_of(plant, [model_of(*effects)])
    seen = replay([run], model, STEP_S)[0].position_rad[0, :, 0]
    assert seen[-1] == pytest.approx(0.8, abs=1e-5)  # encoders sit at motors
    soft = replay([run], variants_of(plant, [model_of(effects[0])]), STEP_S)
    assert 0.8 - soft[0].position_rad[0, -1, 0] > 0.05


# Dead band


def test_within_the_band_there_is_damping_only():
    width = 0.02

    def law(t, y, k):
        error = COMMAND[k] - y[0]
        pull = KP * error if abs(error) >= width else 0.0
        return [y[1], (pull - (KD + EMF) * y[1]) / INERTIA]

    plant = wheel()
    truth = integrated(law, TIME_S, [0, 0])[:, 0]
    run, effect = commanded(plant), ("dead_band", HINGE, width)
    found = exact(plant, run, effect, step_s=2e-4)[:, 0]
    assert np.abs(found - truth).max() < 5 * TOLERANCE
    assert np.abs(exact(plant, run)[:, 0] - truth).max() > 3e-3


@pytest.mark.parametrize(
    ("error", "speed", "share"),
    [
        (0.019, 0.0, 0.0),
        (-0.019, 0.0, 0.0),
        (0.019, 1e-10, 0.0),  # hardly moves
        (0.021, 0.0, 1.0),
        (-0.5, 0.0, 1.0),
        (0.021, 4.0, 0.25),  # after a quarter of the step's way it is in the band
        (0.019, -4.0, 0.75),
        (0.021, 42.0, 1 - 40 / 42),  # through the band and out of it again
    ],
)
def test_a_part_of_a_step_outside_of_the_band_counts_in_part(error, speed, share):
    own = controllers(dead_band_rad=0.02)
    own.begin()
    target = through(own, 0.3 + error, 0.3, speed)
    assert target - 0.3 == pytest.approx(share * error, abs=1e-12)


def test_an_integral_term_takes_errors_in_the_band_as_none():
    own = controllers(dead_band_rad=0.02, integral_1_s=5.0)
    own.begin(one(0.3))
    for _ in range(50):
        assert through(own, 0.01, 0.0) == pytest.approx(0.3 / KP)


# Derivative of the error


@pytest.mark.parametrize("share", [0.3, 1.0])
def test_damping_takes_a_share_of_the_command_s_rate(share):
    lag_s = KD / KP / DERIVATIVE_LAGS

    def law(t, y, k):
        q, v, smooth = y
        rate = (COMMAND[k] - smooth) / lag_s
        torque = KP * (COMMAND[k] - q) + KD * (share * rate - v) - EMF * v
        return [v, torque / INERTIA, rate]

    plant = wheel()
    truth = integrated(law, TIME_S, np.zeros(3))[:, 0]
    run, effect = commanded(plant), ("error_derivative", HINGE, share)
    found = exact(plant, run, effect, step_s=2e-4)[:, 0]
    assert np.abs(found - truth).max() < TOLERANCE
    assert np.abs(exact(plant, run)[:, 0] - truth).max() > 0.01 * share


@pytest.mark.parametrize("step_s", [2e-4, 0.004])
def test_a_step_gives_an_impulse_of_damping_times_the_step(step_s):
    """In steps of any length: kp times the sum of the leads is share kd times it."""
    own = controllers(rate_share=0.4)
    own._passed = -np.expm1(-step_s / derivative_lag_s(one(KP), one(KD))[0])
    own._step_s = step_s
    own.begin()
    through(own, 0.0, 0.0)
    leads = [through(own, 0.1, 0.0) - 0.1 for _ in range(round(0.1 / step_s))]
    assert KP * np.sum(leads) * step_s == pytest.approx(0.4 * KD * 0.1)


def test_of_a_target_that_is_slowed_down_the_slow_rate_counts():
    """At a steady speed v the error is (kd (1 - share) + emf) v / kp."""
    plant, time_s, speed, share = wheel(), ticks(4.0), 0.5, 0.6
    command = np.where(time_s > 0, 3.0, 0.0)
    effects = [("speed_limit", HINGE, speed), ("error_derivative", HINGE, share)]
    found = exact(plant, commanded(plant, command, time_s), *effects)
    behind = speed * (time_s[-1] - 0.01) - found[-1, 0]
    assert behind == pytest.approx((KD * (1 - share) + EMF) * speed / KP, rel=1e-3)


def test_other_simulations_stay_as_they_are():
    plant = wheel(limit=0.4)
    run = commanded(plant)
    every = ("integral_term", 0.3), ("dead_band", 0.01), ("error_derivative", 0.5)
    models = [(), *(model_of((name, HINGE, value)) for name, value in every)]
    (found,) = replay([run], variants_of(plant, models), STEP_S)
    (alone,) = replay([run], variants_of(plant, [()]), STEP_S)
    np.testing.assert_array_equal(found.position_rad[0], alone.position_rad[0])
    for other in found.position_rad[1:]:
        assert np.abs(other - alone.position_rad[0]).max() > 5e-4

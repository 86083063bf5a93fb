"""Effects at a servo and between robot and computer, against another integrator."""

import numpy as np
import pytest
from joint_rigs import (
    ARM,
    GRAVITY,
    INERTIA,
    LINKS_KG,
    LINKS_M,
    PENDULUM,
    PENDULUM_LEVER_NM,
    WHEEL,
    exact,
    integrated,
    plant_of,
    replayed,
    run_from,
    stiffly_integrated,
    ticks,
    trace_of,
)
from scipy.optimize import brentq
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
    servo_law,
    wheel,
)

from diagnosis.effects.parts import PlacedEffect
from diagnosis.replay.replay import replay
from diagnosis.residuals.replays import variants_of

# What effects do to the servo


def test_gain_damping_and_limit():
    plant = wheel()
    effects = (
        ("servo_gain", HINGE, 0.6),
        ("servo_damping", HINGE, 1.5),
        ("torque_limit", HINGE, 0.2),
    )
    law = servo_law(kp=0.6 * KP, kd=1.5 * KD, emf=1.5 * EMF, limit=0.2)
    truth = integrated(law, TIME_S, [0, 0])[:, 0]
    found = exact(plant, commanded(plant), *effects)[:, 0]
    assert np.abs(found - truth).max() < TOLERANCE


def test_within_the_gap_a_joint_coasts():
    """Nothing brakes it there, neither stiffness nor damping."""
    plant = wheel()
    time_s = ticks(0.2)
    run = commanded(plant, np.zeros(21), time_s, velocity_rad_s=0.2)
    found, _ = replayed(plant, run, ("backlash", HINGE, 0.1))
    np.testing.assert_allclose(found[:, 0], 0.2 * time_s, atol=1e-4)
    nominal, _ = replayed(plant, run)
    assert nominal[-1, 0] < 0.02


GAP = 0.04


def test_beyond_the_gap_the_servo_feels_the_rest():
    """A motor that nothing brakes is at its command, or at the gap's edge."""
    plant = plant_of(PENDULUM, kp=KP)

    def law(t, y, k):
        error = COMMAND[k] - y[0]
        felt = error - np.clip(error, -GAP / 2, GAP / 2)
        weight = PENDULUM_LEVER_NM * np.sin(y[0])
        return [y[1], (KP * felt - weight) / INERTIA]

    truth = integrated(law, TIME_S, [0, 0])[:, 0]
    effect = ("backlash", HINGE, GAP)
    found = replayed(plant, commanded(plant), effect, step_s=2e-4)[0][:, 0]
    assert np.abs(found - truth).max() < 4e-4
    assert np.abs(exact(plant, commanded(plant))[:, 0] - truth).max() > 0.01


@pytest.mark.parametrize(("edge", "compliance"), [(3e3, 0.0), (100.0, 0.01)])
def test_a_motor_takes_its_time_through_the_gap(edge, compliance):
    """It is braked there; the gap's edges are very stiff springs, or soft ones."""
    plant = plant_of(PENDULUM, kp=KP, kd=KD, emf=EMF)

    def law(t, y, k):
        angle, speed, motor = y
        twist = motor - angle
        pushed = edge * (twist - np.clip(twist, -GAP / 2, GAP / 2))
        weight = PENDULUM_LEVER_NM * np.sin(angle)
        turning = (KP * (COMMAND[k] - motor) - pushed) / (KD + EMF)
        return [speed, (pushed - weight) / INERTIA, turning]

    truth = stiffly_integrated(law, TIME_S, [0, 0, 0])[:, 0]
    run, effect = commanded(plant), ("backlash", HINGE, GAP, compliance)
    found = replayed(plant, run, effect, step_s=2e-4)[0][:, 0]
    assert np.abs(found - truth).max() < 1e-3
    rigid = replayed(plant, run, ("backlash", HINGE, GAP), step_s=2e-4)[0][:, 0]
    assert (np.abs(rigid - truth).max() > 3e-3) == (compliance > 0)
    without = plant_of(PENDULUM, kp=KP)
    at_once = replayed(without, commanded(without), effect, step_s=2e-4)[0][:, 0]
    assert np.abs(at_once - truth).max() > 0.01


def test_the_set_point_slews():
    """The servo acts on a ramp that ends at the command."""
    command = np.where(TIME_S < 0.1, 0.0, 0.5)
    plant = wheel()

    def ramp(t):
        return min(max(1.5 * (t - 0.1), 0.0), 0.5)

    truth = integrated(servo_law(ramp), TIME_S, [0, 0])[:, 0]
    found = exact(plant, commanded(plant, command), ("speed_limit", HINGE, 1.5))[:, 0]
    assert np.abs(found - truth).max() < 1e-4
    nominal = exact(plant, commanded(plant, command))[:, 0]
    assert np.abs(nominal - truth).max() > 0.1


def trapezoid(t, way, most, speed):
    """A set-point's way after t: it speeds up, goes on, and slows down to rest."""
    top = min(speed, np.sqrt(most * way))
    rise_s, all_s = top / most, way / top + top / most
    t = min(max(t, 0.0), all_s)
    if t < rise_s:
        return most * t**2 / 2
    if t < all_s - rise_s:
        return top * (t - rise_s / 2)
    return way - most * (all_s - t) ** 2 / 2


@pytest.mark.parametrize("speed", [np.inf, 1.0])
def test_the_set_point_starts_and_stops_gently(speed):
    """A triangle or a trapezoid of speed, by a closed form."""
    command = np.where(TIME_S < 0.1, 0.0, 0.5)
    plant = wheel()
    effects = [("acceleration_limit", HINGE, 8.0)]
    if np.isfinite(speed):
        effects.append(("speed_limit", HINGE, speed))

    def gentle(t):
        return trapezoid(t - 0.1, 0.5, 8.0, speed)

    truth = integrated(servo_law(gentle), TIME_S, [0, 0])[:, 0]
    found = exact(plant, commanded(plant, command), *effects)[:, 0]
    assert np.abs(found - truth).max() < 5e-4
    nominal = exact(plant, commanded(plant, command))[:, 0]
    assert np.abs(nominal - truth).max() > 0.1


@pytest.mark.parametrize("start_s", [0.0, 5.0])
def test_a_servo_fades_from_the_start_of_the_recordings_clock(start_s):
    """A later part of a recording finds the servo weaker."""
    plant = wheel()
    time_s = TIME_S + start_s
    truth = integrated(servo_law(kp=lambda t: KP * (1 - 0.05 * t)), time_s, [0, 0])
    run = commanded(plant, COMMAND, time_s)
    found = exact(plant, run, ("servo_fade", HINGE, 0.05))
    assert np.abs(found[:, 0] - truth[:, 0]).max() < 3e-5


def test_dry_friction_may_change_with_the_angle():
    """A wheel that coasts loses the friction's work: integrated over the angle."""
    plant, time_s = plant_of(WHEEL), ticks(1.0)
    torque_nm, factor, speed = 0.02, 3.0, 2.0
    run = run_from(
        trace_of(plant, time_s, command_torque_nm=[0.0]), velocity_rad_s=speed
    )
    found, velocity = replayed(plant, run, ("angle_friction", HINGE, torque_nm, factor))
    work = torque_nm * np.expm1(np.log(factor) * found[:, 0]) / np.log(factor)
    moving = velocity[:, 0] > 0.1
    left = 0.5 * INERTIA * (speed**2 - velocity[:, 0] ** 2)
    np.testing.assert_allclose(work[moving], left[moving], atol=1e-3 * left.max())
    # it stops where all is lost, and stays there
    far = np.log1p(0.5 * INERTIA * speed**2 * np.log(factor) / torque_nm)
    assert found[-1, 0] == pytest.approx(far / np.log(factor), rel=1e-3)
    assert not moving[-1]


SHARE = 0.6


def test_a_supply_sags_under_a_motors_torque():
    """Also where the servo is at its limit, which falls with the voltage."""
    plant = wheel(limit=LIMIT)

    def law(t, y, k):
        q, v = y
        asked_nm = np.clip(KP * (COMMAND[k] - q) - KD * v, -LIMIT, LIMIT)
        free_nm = asked_nm - EMF * v
        # t = asked (1 - SHARE |t| / LIMIT) - EMF v, solved for the torque t
        torque = free_nm / (1 + SHARE * np.sign(free_nm) * asked_nm / LIMIT)
        return [v, torque / INERTIA]

    truth = integrated(law, TIME_S, [0, 0])[:, 0]
    found = exact(plant, commanded(plant), ("supply_sag", "supply", SHARE))[:, 0]
    assert np.abs(found - truth).max() < 2e-4
    assert np.abs(exact(plant, commanded(plant))[:, 0] - truth).max() > 0.02


def test_a_supply_sags_under_all_servos_together():
    """Two links that hold still: the voltage is what both torques leave of it."""
    limit, emf, kp = 4.0, 0.5, 20.0
    plant = plant_of(ARM, kp=kp, kd=1.0, limit=limit, emf=emf)
    (m1, m2), (l1, l2) = LINKS_KG, LINKS_M
    run = run_from(trace_of(plant, ticks(4.0), command_rad=[0.8, 0.4]), [0.8, 0.4])
    found, _ = replayed(plant, run, ("supply_sag", "supply", SHARE))
    first, second = found[-1]
    outer_nm = m2 * GRAVITY * l2 * np.sin(first + second)
    torques = np.array([(m1 + m2) * GRAVITY * l1 * np.sin(first) + outer_nm, outer_nm])
    voltage = 1 - SHARE * torques.sum() / (2 * limit)
    assert voltage < 0.85
    held = np.array([0.8, 0.4]) - torques / (kp * voltage)
    np.testing.assert_allclose(found[-1], held, atol=1e-5)


@pytest.mark.parametrize(
    "effect",
    [
        ("load_friction", HINGE, 0.2),
        ("gear_friction", HINGE, 0.0, 0.2),
        ("supply_sag", "supply", SHARE),
    ],
    ids=lambda effect: effect[0],
)
def test_where_a_wheel_begins_to_turn_makes_no_difference(effect):
    """At the first step, too, the motor's torque is that of the error."""
    plant, begun = wheel(limit=LIMIT), []
    for start_rad in (0.0, 2.0):
        run = commanded(
            plant, COMMAND + start_rad, position_rad=start_rad, velocity_rad_s=0.5
        )
        begun.append(replayed(plant, run, effect)[0] - start_rad)
    np.testing.assert_allclose(*begun, atol=1e-9)


# Signals


def test_a_delay_of_commands_shifts_the_response():
    delay_s = 0.0133
    plant = wheel()
    # the integrator's commands change at rows and rows + delay
    every = np.unique(np.concatenate([TIME_S, TIME_S + delay_s]))
    rows = np.searchsorted(TIME_S, every - delay_s + 1e-9, side="right") - 1
    law = servo_law(COMMAND[np.maximum(rows, 0)])
    truth = integrated(law, every, [0, 0])[:, 0]
    truth = truth[np.searchsorted(every, TIME_S)]
    found = exact(plant, commanded(plant), ("command_latency", "commands", delay_s))
    assert np.abs(found[:, 0] - truth).max() < 3e-5
    assert np.abs(exact(plant, commanded(plant))[:, 0] - truth).max() > 0.01


def test_delayed_encoders_show_the_past():
    delay_s = 0.0133
    plant = wheel()
    every = np.unique(np.concatenate([TIME_S, TIME_S - delay_s]))
    every = every[every >= 0]
    rows = np.searchsorted(TIME_S, every + 1e-9, side="right") - 1
    past = np.maximum(TIME_S - delay_s, 0)
    truth = integrated(servo_law(COMMAND[rows]), every, [0, 0])
    truth = truth[np.searchsorted(every, past - 1e-9)]
    run, effect = commanded(plant), ("sensor_delay", "encoders", delay_s)
    found = exact(plant, run, effect)
    assert np.abs(found[:, 0] - truth[:, 0]).max() < 3e-5
    _, velocity = replayed(plant, run, effect, step_s=1e-4)
    assert np.abs(velocity[:, 0] - truth[:, 1]).max() < 5e-3


def test_the_servo_acts_on_what_the_encoder_says():
    """At rest kp (c - m) = m g l sin(m - offset), with m what is measured."""
    offset, command = 0.1, 0.4
    plant = plant_of(PENDULUM, kp=KP, kd=0.4)
    time_s = ticks(4.0, 0.05)
    run = commanded(plant, np.full(len(time_s), command), time_s, position_rad=0.3)
    effect = ("encoder_offset", HINGE, offset)
    found, _ = replayed(plant, run, effect, step_s=4e-3)

    def torque(m):
        return KP * (command - m) - PENDULUM_LEVER_NM * np.sin(m - offset)

    assert found[0, 0] == pytest.approx(0.3, abs=1e-9)
    assert found[-1, 0] == pytest.approx(brentq(torque, 0, 1), abs=1e-6)


def test_a_fixed_base_has_its_gyroscopes_bias():
    plant = wheel()
    model = (PlacedEffect("gyro_bias", "gyroscope", (0.1, -0.2, 0.3)),)
    (result,) = replay([commanded(plant)], variants_of(plant, [(), model]))
    np.testing.assert_allclose(result.gyroscope_rad_s[0], 0, atol=1e-12)
    wanted = np.tile([0.1, -0.2, 0.3], (len(TIME_S), 1))
    np.testing.assert_allclose(result.gyroscope_rad_s[1], wanted)

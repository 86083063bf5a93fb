"""Friction that bends before it slides, against closed forms and another integrator."""

from dataclasses import replace

import numpy as np
import pytest
from joint_rigs import INERTIA, WHEEL, exact, plant_of, replayed, run_from, trace_of
from scipy.integrate import solve_ivp
from wheel_rig import HINGE, TIME_S, commanded, driven, wheel

from diagnosis.replay import presliding
from diagnosis.replay.presliding import torque_along
from diagnosis.traces.windows import Run

TORQUE, REACH = 0.1, 0.04
N = presliding.SPRINGS


def law(*values):
    return ("presliding", HINGE, *values)


def virgin(x, torque=TORQUE, reach=REACH, n=N):
    """Torque of n springs that all begin relaxed, for ways x in one direction."""
    most = reach * np.arange(1, n + 1) / n
    stiffness = torque / most.sum()
    return stiffness * np.minimum(np.abs(x)[:, None], most).sum(axis=1) * np.sign(x)


def along(x, *earlier):
    before = np.array(earlier)[:, None] if earlier else None
    law = np.array([TORQUE]), np.array([REACH])
    return torque_along(*law, np.asarray(x)[:, None], before)[:, 0]


# The law along a motion


def test_the_first_curve_ends_as_dry_friction():
    x = np.linspace(0.0, 0.08, 300)
    np.testing.assert_allclose(along(x), virgin(x), atol=1e-12)
    np.testing.assert_allclose(along(x)[x > REACH], TORQUE)
    np.testing.assert_allclose(along(-x), -along(x))


def test_a_closed_loop_follows_masing_s_rule():
    """After a turn F = F_turn -+ 2 virgin(way / 2); a full loop ends where it began."""
    up = np.linspace(0.0, 0.025, 200)
    down, back = np.linspace(0.025, -0.025, 400), np.linspace(-0.025, 0.025, 400)
    found = along(np.concatenate([up, down, back]))
    top = found[199]
    falls = top - 2 * virgin((0.025 - down) / 2)
    rises = -top + 2 * virgin((back + 0.025) / 2)
    np.testing.assert_allclose(found[200:600], falls, atol=1e-12)
    np.testing.assert_allclose(found[600:], rises, atol=1e-12)
    assert found[-1] == pytest.approx(top)
    assert abs(top) < TORQUE  # not all springs slip


def test_the_sign_of_the_way_is_left_of_a_small_reach():
    """Coulomb's friction: the torque is that of sliding at all rows but the turns'."""
    x = np.sin(np.linspace(0, 12, 700))
    small = np.array([TORQUE]), np.array([1e-7])
    found = torque_along(*small, x[:, None])[1:, 0]
    np.testing.assert_allclose(found, TORQUE * np.sign(np.diff(x)), rtol=1e-6)


def test_what_was_before_is_remembered():
    x = 0.03 * np.sin(np.linspace(0, 9, 400))
    np.testing.assert_allclose(along(x[150:], *x[:150]), along(x)[150:], atol=1e-15)
    assert np.abs(along(x[150:]) - along(x)[150:]).max() > 0.1 * TORQUE


@pytest.mark.parametrize("factor", [0.5, 2])
def test_the_number_of_springs_hardly_matters(monkeypatch, factor):
    x = 0.05 * np.sin(np.linspace(0, 20, 2000)) * np.linspace(0, 1, 2000)
    usual = along(x)
    monkeypatch.setattr(presliding, "SPRINGS", round(factor * N))
    assert 0 < np.abs(along(x) - usual).max() < 0.07 * TORQUE  # both sides


# In replays


def test_a_wheel_that_is_pushed_too_little_bends_and_rests():
    """At last the springs carry the push: virgin(x) = push."""
    x = np.linspace(0, REACH, 4000)
    wanted = np.interp(0.08, virgin(x), x)
    time_s = np.arange(600) * 0.01
    plant, run = driven(0.08 * np.minimum(time_s / 4, 1.0), time_s=time_s)
    damped = ("viscous_friction", HINGE, 0.3)
    found = replayed(plant, run, law(TORQUE, REACH), damped)[0][:, 0]
    assert found[-1] == pytest.approx(wanted, rel=3e-3)
    free = replayed(plant, run, damped)[0][-1, 0]
    assert free > 20 * wanted


def test_a_small_reach_is_dry_friction():
    """v = v0 - T t / I until the wheel stands, and there it stays."""
    plant, run = driven(np.zeros(len(TIME_S)), velocity_rad_s=2.0)
    found = exact(plant, run, law(TORQUE, 1e-4))[:, 0]
    slowed = TORQUE / INERTIA
    t = np.minimum(TIME_S, 2.0 / slowed)
    np.testing.assert_allclose(found, 2.0 * t - slowed * t**2 / 2, atol=4e-4)
    assert np.ptp(found[2.0 / slowed + 0.1 < TIME_S]) < 1e-4


def swung(reach, step_s):
    """Replay of a wheel with a servo, and what another library says of it."""
    kp, kd = 3.0, 0.1
    command = 0.08 * np.sin(9 * TIME_S) + 0.03 * np.sin(23 * TIME_S)
    plant = wheel(kp=kp, kd=kd, emf=0.0)
    run = commanded(plant, command)
    found = replayed(plant, run, law(TORQUE, reach), step_s=step_s)[0][:, 0]
    most = reach * np.arange(1, N + 1) / N
    stiffness = TORQUE / most.sum()

    def rates(t, y, k):
        q, v, bend = y[0], y[1], y[2:]
        slips = (np.abs(bend) >= most) & (np.sign(bend) == np.sign(v))
        held = np.clip(bend, -most, most)
        torque = kp * (command[k] - q) - kd * v - stiffness * held.sum()
        return [v, torque / INERTIA, *np.where(slips, 0.0, v)]

    state, truth = np.zeros(2 + N), [0.0]
    for k in range(len(TIME_S) - 1):
        part = solve_ivp(rates, TIME_S[k : k + 2], state, args=(k,), max_step=5e-4)
        state = part.y[:, -1]
        truth.append(state[0])
    return found, np.array(truth)


@pytest.mark.parametrize("reach", [0.04, 0.008])
def test_a_servo_moves_a_wheel_as_another_integrator_says(reach):
    fine, truth = swung(reach, 1e-4)
    coarse, _ = swung(reach, 1e-3)
    assert np.ptp(truth) > 3 * reach
    np.testing.assert_allclose(fine, truth, atol=3e-4)
    np.testing.assert_allclose(coarse, truth, atol=3e-3)


@pytest.mark.parametrize("reach", [1e-4, 2e-3, 0.05])
@pytest.mark.parametrize("step_s", [0.001, 0.004])
def test_a_light_joint_comes_to_rest_with_long_steps(step_s, reach):
    """Springs of up to 4000 N m/rad at 1e-5 kg m^2: h^2 K / I is up to 7000.

    Pulled from one side all springs have slipped where kp (c - q) = T.
    """
    kp, kd, torque, command = 9.0, 0.62, 0.24, 0.24
    plant = plant_of(WHEEL.replace(str(INERTIA), "1e-5"), kp=kp, kd=kd)
    time_s = np.arange(300) * 0.01
    run = run_from(trace_of(plant, time_s, command_rad=np.full(300, command)))
    found = replayed(plant, run, law(torque, reach), step_s=step_s)[0][:, 0]
    assert found[-1] == pytest.approx(command - torque / kp, abs=2e-3)
    assert np.ptp(found[-50:]) < 1e-4
    assert (np.diff(found) > -1e-6).all()  # it does not ring


def test_dry_friction_and_bends_may_be_at_one_joint():
    """Together they hold a push below their sum, but for the way of the springs."""
    effects = ("coulomb_friction", HINGE, 0.06), law(0.05, 0.01)
    plant, run = driven(np.full(len(TIME_S), 0.1))
    assert np.abs(replayed(plant, run, *effects)[0]).max() < 0.02
    plant, run = driven(np.full(len(TIME_S), 0.13))
    assert replayed(plant, run, *effects)[0][-1, 0] > 0.1


def test_a_window_begins_with_the_bends_that_its_past_left():
    """A wheel is turned forth and half back: the springs push it, or pull it."""
    plant, run = driven(np.zeros(len(TIME_S)))
    forth = np.linspace(0, 0.1, 60)
    back = np.linspace(0.1, 0.06, 30)
    past = np.concatenate([forth, back])[:, None] - 0.06
    bent_nm = along(past[:, 0])[-1]
    assert -TORQUE < bent_nm < 0
    known = replace(run, before_rad=past)
    found = replayed(plant, known, law(TORQUE, REACH), step_s=2e-4)[0][:, 0]
    assert found[1] == pytest.approx(-bent_nm * 0.01**2 / 2 / INERTIA, rel=0.05)
    relaxed = replayed(plant, run, law(TORQUE, REACH), step_s=2e-4)[0][:, 0]
    assert np.abs(relaxed).max() < 1e-12


def test_parts_of_recordings_know_their_past():
    plant = wheel()
    x = 0.1 * np.sin(5 * TIME_S)
    whole = trace_of(plant, TIME_S, x[:, None], command_rad=x)
    assert Run.of(whole).before_rad is None
    part = Run.of(whole.part(40, 81))
    assert part.before_rad is not None
    assert part.before_rad[-1] == pytest.approx(part.position_rad)
    np.testing.assert_allclose(part.before_rad[:, 0], x[:41], atol=2e-3)

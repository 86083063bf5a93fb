"""Pushes and drag on a sled that slides without friction."""

import numpy as np
import pytest
from joint_rigs import (
    ARM,
    LINKS_M,
    PENDULUM,
    SLED,
    SLED_KG,
    arm_law,
    exact,
    integrated,
    plant_of,
    replayed,
    run_from,
    ticks,
    trace_of,
)

from diagnosis.effects.parts import PlacedEffect
from diagnosis.replay.replay import replay
from diagnosis.residuals.replays import variants_of

TIME_S = ticks(0.6)


def sled(time_s=TIME_S, **start):
    plant = plant_of(SLED)
    return plant, run_from(trace_of(plant, time_s), **start)


@pytest.mark.parametrize("start_s", [0.1, 0.10037])
@pytest.mark.parametrize("duration_s", [0.2, 0.1234, 0.0004])
def test_a_push_changes_momentum_by_force_times_time(start_s, duration_s):
    """Also where it begins and ends within a step."""
    plant, run = sled(velocity_rad_s=-0.3)
    push = ("external_force", "sled", 5.0, 7.0, -2.0, start_s, duration_s)
    _, velocity = replayed(plant, run, push)
    gained = 5.0 * duration_s / SLED_KG
    before, after = start_s > TIME_S, start_s + duration_s < TIME_S
    np.testing.assert_allclose(velocity[before, 0], -0.3, atol=1e-9)
    np.testing.assert_allclose(velocity[after, 0], -0.3 + gained, atol=1e-9)


def test_a_push_is_in_the_traces_time():
    plant, run = sled(20 + TIME_S)
    push = ("external_force", "sled", 5.0, 0.0, 0.0, 20.3, 0.1)
    _, velocity = replayed(plant, run, push)
    wanted = 5.0 / SLED_KG * np.clip(TIME_S - 0.3, 0, 0.1)
    np.testing.assert_allclose(velocity[:, 0], wanted, atol=2e-3)
    early = ("external_force", "sled", 5.0, 0.0, 0.0, 0.3, 0.1)
    np.testing.assert_allclose(replayed(plant, run, early)[1], 0, atol=1e-12)


def test_pushes_add_and_a_whole_run_may_be_pushed():
    plant, run = sled()
    pushes = (
        ("external_force", "sled", 1.0, 0, 0, 0.0, 10.0),
        ("external_force", "sled", 2.0, 0, 0, 0.2, 0.2),
    )
    _, velocity = replayed(plant, run, *pushes)
    wanted = (1.0 * TIME_S + 2.0 * np.clip(TIME_S - 0.2, 0, 0.2)) / SLED_KG
    np.testing.assert_allclose(velocity[:, 0], wanted, atol=2e-3)


def test_each_variant_and_run_has_its_own_pushes():
    plant, run = sled()
    later = run_from(trace_of(plant, 0.3 + TIME_S))
    push = PlacedEffect("external_force", "sled", (4.0, 0, 0, 0.3, 0.1))
    variants = variants_of(plant, [(), (push,), (push, push)])
    results = replay([run, later], variants)
    gained = 4.0 * 0.1 / SLED_KG
    for result in results:
        np.testing.assert_allclose(
            result.velocity_rad_s[:, -1, 0], [0, gained, 2 * gained], atol=1e-9
        )
    at = np.searchsorted(TIME_S, 0.2)
    np.testing.assert_allclose(results[0].velocity_rad_s[:, at], 0, atol=1e-12)
    assert results[1].velocity_rad_s[1, at, 0] == pytest.approx(gained)


def test_a_push_acts_at_the_centre_of_mass_of_its_body():
    """At rest the pendulum hangs askew by atan(F / (m g))."""
    plant = plant_of(PENDULUM, emf=0.3)
    time_s = ticks(10.0, 0.05)
    run = run_from(trace_of(plant, time_s))
    push = ("external_force", "rod", 2.0, 0, 0, 0.0, 100.0)
    position, _ = replayed(plant, run, push, step_s=4e-3)
    weight_n = 0.5 * 9.81
    assert position[-1, 0] == pytest.approx(np.arctan(2.0 / weight_n), abs=1e-5)


@pytest.mark.parametrize("coefficient", [1.0, 20.0])
def test_drag_slows_a_sled(coefficient):
    """x = v0 m / c (1 - exp(-c t / m))."""
    plant, run = sled(velocity_rad_s=0.8)
    found = exact(plant, run, ("drag", "sled", coefficient))[:, 0]
    rate = coefficient / SLED_KG
    wanted = 0.8 / rate * (1 - np.exp(-rate * TIME_S))
    np.testing.assert_allclose(found, wanted, atol=3e-5)
    nominal = exact(plant, run)[:, 0]
    np.testing.assert_allclose(nominal, 0.8 * TIME_S, atol=1e-9)


def test_drag_on_the_outer_link_of_an_arm():
    """Its torques are J^T (-c v), J of the link's end, where its centre is."""
    plant, coefficient = plant_of(ARM, emf=0.05), 1.5
    l1, l2 = LINKS_M

    def torque_nm(t, q, v, k):
        q1, q12 = q[0], q[0] + q[1]
        end = np.array([np.cos(q12), np.sin(q12)]) * l2
        jacobian = np.stack([end + np.array([np.cos(q1), np.sin(q1)]) * l1, end], 1)
        return -coefficient * jacobian.T @ jacobian @ v - 0.05 * v

    truth = integrated(arm_law(torque_nm), TIME_S, [0.7, 0.3, 0.0, 0.0])[:, :2]
    run = run_from(trace_of(plant, TIME_S), position_rad=[0.7, 0.3])
    found = exact(plant, run, ("drag", "lower", coefficient), step_s=5e-4)
    assert np.abs(found - truth).max() < 1e-4
    assert np.abs(exact(plant, run) - truth).max() > 0.05


def test_a_push_against_drag():
    """v = F / c (1 - exp(-c t / m))."""
    plant, run = sled()
    push = ("external_force", "sled", 3.0, 0, 0, 0.0, 10.0)
    drag = ("drag", "sled", 8.0)
    wanted = 3.0 / 8.0 * (1 - np.exp(-8.0 / SLED_KG * TIME_S))
    for effects in ((push, drag), (drag, push)):
        _, velocity = replayed(plant, run, *effects, step_s=2e-4)
        np.testing.assert_allclose(velocity[:, 0], wanted, atol=1e-3)

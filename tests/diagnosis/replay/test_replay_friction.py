"""Friction of a joint, mostly against closed forms."""

import numpy as np
import pytest
from joint_rigs import (
    INERTIA,
    WHEEL,
    exact,
    integrated,
    plant_of,
    replayed,
    run_from,
    ticks,
    trace_of,
)
from wheel_rig import (
    HINGE,
    LIMIT,
    TIME_S,
    commanded,
    driven,
    wheel,
)


def test_dry_friction_stops_a_wheel():
    """v = v0 - T t / I until it stands at I v0^2 / (2 T), and there it stays."""
    plant, run = driven(np.zeros(len(TIME_S)), velocity_rad_s=2.0)
    found = exact(plant, run, ("coulomb_friction", HINGE, 0.1))[:, 0]
    slowed = 0.1 / INERTIA
    stop_s = 2.0 / slowed
    t = np.minimum(TIME_S, stop_s)
    np.testing.assert_allclose(found, 2.0 * t - slowed * t**2 / 2, atol=2e-4)
    assert np.ptp(found[stop_s + 0.01 < TIME_S]) < 2e-4


@pytest.mark.parametrize(
    "effect",
    [
        ("coulomb_friction", HINGE, 0.1),
        ("stribeck_friction", HINGE, 0.06, 0.04, 0.05),
        ("stribeck_friction", HINGE, 0.1, 0.0, 0.05),
    ],
)
def test_dry_friction_holds_below_its_torque_and_slides_above(effect):
    """Pushed by 0.98 of it nothing moves; by 1.2 of it something does."""
    below = np.full(len(TIME_S), 0.098)
    plant, run = driven(below)
    assert np.abs(replayed(plant, run, effect)[0]).max() < 1e-3
    plant, run = driven(1.2 / 0.98 * below)
    assert replayed(plant, run, effect)[0][-1, 0] > 0.1


def test_beyond_breakaway_the_rest_of_the_torque_accelerates():
    plant, run = driven(np.full(len(TIME_S), 0.15))
    found = exact(plant, run, ("coulomb_friction", HINGE, 0.1))[:, 0]
    wanted = 0.05 * TIME_S**2 / 2 / INERTIA
    np.testing.assert_allclose(found, wanted, atol=2e-3 * wanted[-1])


@pytest.mark.parametrize("share", [0.1, 0.5])
def test_friction_that_is_a_share_of_the_torque(share):
    """The wheel accelerates by the rest: (1 - s) T / I."""
    plant, run = driven(np.full(len(TIME_S), 0.1))
    found = exact(plant, run, ("load_friction", HINGE, share))[:, 0]
    wanted = (1 - share) * 0.1 * TIME_S**2 / 2 / INERTIA
    np.testing.assert_allclose(found, wanted, atol=3e-3 * wanted[-1])


def test_a_servo_feels_friction_of_its_own_torque():
    """While a saturated servo turns the wheel: I v' = (1 - s) limit."""
    plant = wheel(kd=0.0, emf=0.0, limit=LIMIT)
    run = commanded(plant, np.full(len(TIME_S), 50.0))
    found = exact(plant, run, ("load_friction", HINGE, 0.25))[:, 0]
    wanted = 0.75 * LIMIT * TIME_S**2 / 2 / INERTIA
    np.testing.assert_allclose(found, wanted, atol=3e-3 * wanted[-1])


def test_the_gear_carries_what_back_emf_leaves():
    """I v' = (1 - s) (limit - emf v): none is left at the no-load speed."""
    share, emf = 0.25, 0.2
    plant = wheel(kd=0.0, emf=emf, limit=LIMIT)
    run = commanded(plant, np.full(len(TIME_S), 50.0))
    found = exact(plant, run, ("load_friction", HINGE, share))[:, 0]
    lag_s = INERTIA / ((1 - share) * emf)
    wanted = LIMIT / emf * (TIME_S - lag_s * (1 - np.exp(-TIME_S / lag_s)))
    np.testing.assert_allclose(found, wanted, atol=3e-3 * wanted[-1])


def test_a_stiff_spring_carries_what_a_rigid_gear_does():
    """Its torque has lost what back-EMF takes already."""
    plant = wheel(kd=0.0, emf=0.2, limit=LIMIT, armature=1e-3)
    run = commanded(plant, np.full(len(TIME_S), 50.0))
    load, spring = ("load_friction", HINGE, 0.25), ("joint_elasticity", HINGE, 2e3, 2.0)
    rigid = exact(plant, run, load, step_s=5e-4)[:, 0]
    elastic = exact(plant, run, load, spring, step_s=5e-4)[:, 0]
    np.testing.assert_allclose(elastic, rigid, atol=0.02 * rigid[-1])


def test_friction_falls_with_speed():
    coulomb, extra, speed, torque = 0.05, 0.06, 0.5, 0.13
    plant, run = driven(np.full(len(TIME_S), torque), velocity_rad_s=0.1)

    def law(t, y, k):
        friction = coulomb + extra * np.exp(-((y[1] / speed) ** 2))
        return [y[1], (torque - friction) / INERTIA]

    truth = integrated(law, TIME_S, [0, 0.1])[:, 0]
    effect = ("stribeck_friction", HINGE, coulomb, extra, speed)
    found = exact(plant, run, effect)[:, 0]
    np.testing.assert_allclose(found, truth, atol=3e-3 * truth[-1])
    without = (torque - coulomb) * TIME_S**2 / 2 / INERTIA + 0.1 * TIME_S
    assert without[-1] > 1.05 * truth[-1]


def test_viscous_friction_and_armature_are_of_the_joint():
    """v = v0 exp(-b t / (I + J))."""
    plant, run = driven(np.zeros(len(TIME_S)), velocity_rad_s=2.0)
    effects = ("viscous_friction", HINGE, 0.1), ("armature", HINGE, 0.03)
    _, velocity = replayed(plant, run, *effects, step_s=1e-4)
    wanted = 2.0 * np.exp(-0.1 / (INERTIA + 0.03) * TIME_S)
    np.testing.assert_allclose(velocity[:, 0], wanted, atol=1e-3)


@pytest.mark.parametrize("emf", [0.0, 0.3])
@pytest.mark.parametrize("step_s", [0.001, 0.004])
def test_dry_friction_stops_a_light_joint_with_a_strong_servo(step_s, emf):
    """Without inertia kd q' = kp (c - q) - T until the servo is within T: then stands.

    Integrators that have damping implicitly let it creep on to the command.
    """
    kp, kd, torque, command = 9.0, 0.62, 0.24, 0.24
    light = WHEEL.replace(str(INERTIA), "1e-5")
    plant = plant_of(light, kp=kp, kd=kd - emf, emf=emf)
    time_s = ticks(1.5)
    run = run_from(trace_of(plant, time_s, command_rad=np.full(len(time_s), command)))
    friction = ("coulomb_friction", HINGE, torque)
    found = replayed(plant, run, friction, step_s=step_s)[0][:, 0]
    rest = command - torque / kp
    wanted = rest * (1 - np.exp(-kp / kd * time_s))
    np.testing.assert_allclose(found[20:], wanted[20:], atol=2e-3)
    free = replayed(plant, run, step_s=step_s)[0][-1, 0]
    assert free == pytest.approx(command, abs=1e-3)


def test_a_light_joint_held_by_friction_hardly_creeps():
    """Within 0.5 mrad in 10 s; a simulated constraint yields a little by its nature."""
    kp, kd, torque, command = 9.0, 0.62, 0.24, 0.02
    light = WHEEL.replace(str(INERTIA), "1e-5")
    plant = plant_of(light, kp=kp, kd=kd)
    time_s = ticks(10.0)
    run = run_from(trace_of(plant, time_s, command_rad=np.full(len(time_s), command)))
    friction = ("coulomb_friction", HINGE, torque)
    held = replayed(plant, run, friction, step_s=0.004)[0][:, 0]
    assert np.abs(held).max() < 5e-4
    free = replayed(plant, run, step_s=0.004)[0][-1, 0]
    assert free == pytest.approx(command, abs=1e-3)

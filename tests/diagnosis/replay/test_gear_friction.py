"""Friction of loaded gears, in replays and for known motions, against its law."""

import numpy as np
import pytest
from joint_rigs import (
    ARM,
    INERTIA,
    PENDULUM,
    PENDULUM_LEVER_NM,
    exact,
    integrated,
    plant_of,
    run_from,
    ticks,
    trace_of,
)

from diagnosis.effects.parts import PlacedEffect
from diagnosis.plant.plant import links_torque_nm
from diagnosis.replay.dry_friction import DryFriction
from diagnosis.replay.inverse import NeededTorques
from diagnosis.residuals.replays import variants_of
from diagnosis.traces.motion import Motion

HINGE, TIME_S = "hinge", ticks(0.8)
PEAK = (0.03, 0.08, 0.6, 1.4)
RUNGS = {
    "shaped_stribeck_friction": PEAK,
    "gear_friction": (0.03, 0.15),
    "gear_stribeck_friction": (*PEAK, 0.1, 0.15),
    "directional_gear_friction": (*PEAK, 0.05, 0.2, 0.2, 0.1),
    "quadratic_gear_friction": (*PEAK, 0.05, 0.2, 0.1, 0.1, 0.4),
}


def friction(name, values, speed, motor, links):
    """The published law, term by term; scalars or arrays."""
    coulomb, extra, v_s, a = values[:4] if len(values) > 2 else (values[0], 0, 1, 1)
    shares = list(values[4:]) if len(values) > 2 else [values[1]]
    square = shares.pop() if name == "quadratic_gear_friction" else 0.0
    if len(shares) == 1:
        shares = [shares[0], shares[0], 0.0, 0.0]
    elif len(shares) == 2:
        shares = [shares[0], shares[0], shares[1], shares[1]]
    k_l, k_t, e_l, e_t = shares or [0.0] * 4
    passed = np.where(motor * links < 0, np.minimum(abs(motor), abs(links)), 0.0)
    slow = np.exp(-(np.abs(speed / v_s) ** a))
    peak = extra + np.abs(e_l * links - e_t * motor) + square * passed**2
    return coulomb + np.abs(k_l * links - k_t * motor) + slow * peak


@pytest.mark.parametrize("name", RUNGS)
@pytest.mark.parametrize("torque", [0.75, 0.2])
def test_a_pendulum_is_slowed_by_the_law(name, torque):
    """One torque lifts it, the other lets it fall; compared until it turns back."""
    values = RUNGS[name]
    plant = plant_of(PENDULUM)
    start, speed = (-0.9, 0.3) if torque > 0.5 else (-1.2, 0.5)
    trace = trace_of(plant, TIME_S, command_torque_nm=np.full(len(TIME_S), torque))
    run = run_from(trace, start, speed)

    def law(t, y, k):
        links = -PENDULUM_LEVER_NM * np.sin(y[0])
        rubs = friction(name, values, y[1], torque, links) if name else 0.0
        return [y[1], (torque + links - rubs) / INERTIA]

    truth = integrated(law, TIME_S, [start, speed])
    rows = int(np.argmax(truth[:, 1] < 0.1)) or len(truth)
    assert rows > 30
    found = exact(plant, run, (name, HINGE, *values), step_s=5e-4)[:rows, 0]
    moved = truth[rows - 1, 0] - start
    np.testing.assert_allclose(found, truth[:rows, 0], atol=3e-3 * moved)
    # half of the friction is another motion
    less = exact(plant, run, (name, HINGE, *(0.5 * np.array(values))), step_s=5e-4)
    assert abs(less[:rows, 0] - truth[:rows, 0]).max() > 0.02 * moved


def swing():
    """A motion (rows, 1) that lifts and lowers a pendulum on both sides."""
    time_s = ticks(2.0)
    q, v = 1.2 * np.sin(5 * time_s), 6.0 * np.cos(5 * time_s)
    return time_s, q[:, None], v[:, None], -25 * q[:, None]


@pytest.mark.parametrize("name", RUNGS)
def test_the_torque_that_a_motion_needs_obeys_the_law(name):
    plant, (time_s, q, v, a) = plant_of(PENDULUM), swing()
    one = np.ones(1)
    motion = Motion(q, v, a, q == q, 1, one, one)
    trace = trace_of(plant, time_s, q)
    object.__setattr__(trace, "motion", motion)
    model = (PlacedEffect(name, HINGE, RUNGS[name]),)
    torque = NeededTorques(plant, [trace]).of(variants_of(plant, [model]))[0]
    links = -PENDULUM_LEVER_NM * np.sin(q)
    rubs = friction(name, RUNGS[name], v, torque, links)
    free = INERTIA * a - links
    np.testing.assert_allclose(torque - np.sign(v) * rubs, free, atol=1e-9)
    assert (torque * v > 0).any()
    assert (torque * v < 0).any()


def test_links_pull_themselves_down():
    """Two links, hanging to the side at rest: the weight's torque about each joint."""
    plant = plant_of(ARM)
    q, still = np.array([[0.3, -0.8]]), np.zeros((1, 2))
    found = links_torque_nm(plant, plant.model, q, still)[0]
    lower = -0.4 * 9.81 * 0.2 * np.sin(0.3 - 0.8)
    upper = -(0.6 + 0.4) * 9.81 * 0.25 * np.sin(0.3) + lower
    np.testing.assert_allclose(found, [upper, lower], rtol=1e-6)


def test_more_friction_than_motors_have_ends_with_a_number():
    """Newton's method does not run away where no torque turns the gear."""
    joints = {
        "stribeck_nm": 0.1, "stribeck_speed_rad_s": 0.1, "stribeck_exponent": 2.0,
        "load_share": 0.5, "link_share": 0.5, "extra_load_share": 1.0,
        "extra_link_share": 1.0, "extra_square_1_nm": 1.0, "angle_nm": 0.0,
    }  # fmt: skip
    joints = {name: np.array([value]) for name, value in joints.items()}
    still = DryFriction(joints, np.array([1e-6]), np.array([-2.0]))
    assert np.isfinite(still.needed_nm(np.array([2.0]), np.array([1.0]))).all()
    # moving fast only half of a further torque is lost: 2 T - |2 + T| = 4 at T = 6
    moving = DryFriction(joints, np.array([50.0]), np.array([-2.0]))
    found = moving.needed_nm(np.array([2.0]), np.array([1.0]))
    np.testing.assert_allclose(found, [6.0])

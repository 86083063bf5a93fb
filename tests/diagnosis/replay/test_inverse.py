"""Torques that a motion needs, against textbook equations and MuJoCo's own motion."""

from dataclasses import replace

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
    arm_law,
    plant_of,
    ticks,
    trace_of,
)

from diagnosis.effects.base_kinds import TorqueEffect
from diagnosis.effects.library import also_known
from diagnosis.effects.parts import Parameter, PlacedEffect
from diagnosis.replay.inverse import PER_BLOCK, NeededTorques
from diagnosis.residuals.replays import variants_of
from diagnosis.traces.motion import Motion


def moving(plant, position, velocity, acceleration, rows=1):
    """A trace with a known motion, at ticks of 10 ms."""
    parts = [np.reshape(one, (-1, len(plant.joints))) for one in
             (position, velocity, acceleration)]  # fmt: skip
    j = len(plant.joints)
    motion = Motion(*parts, parts[0] == parts[0], rows, np.ones(j), np.ones(j))
    return replace(trace_of(plant, ticks(1.0)[: len(parts[0])]), motion=motion)


def swinging(plant, rows=1, size=0.4):
    """A joint that swings by a sine; with its position, velocity, acceleration."""
    time_s = ticks(1.0)
    q, v = size * np.sin(5 * time_s), 5 * size * np.cos(5 * time_s)
    a = -25 * q
    return moving(plant, q, v, a, rows), q, v, a


def needed(plant, trace, *effects):
    """(rows, j) torques; effects are (name, place, *values)."""
    model = tuple(PlacedEffect(name, place, values) for name, place, *values in effects)
    return NeededTorques(plant, [trace]).of(variants_of(plant, [model]))[0]


def test_two_links_need_what_the_textbook_says():
    plant, random = plant_of(ARM), np.random.default_rng(1)
    q, v, torque = random.uniform(-2, 2, (3, 50, 2))
    rows = []
    for k in range(50):
        law = arm_law(lambda t, q, v, k: torque[k])
        rows.append(law(0.0, [*q[k], *v[k]], k)[2:])
    trace = moving(plant, q, v, rows)
    np.testing.assert_allclose(needed(plant, trace), torque, atol=1e-6)


def test_a_load_adds_its_weight():
    plant = plant_of(ARM)
    q = np.array([[0.3, -0.5], [1.0, 0.2]])
    trace = moving(plant, q, 0 * q, 0 * q)
    more = needed(plant, trace, ("payload_mass", "lower", 0.5)) - needed(plant, trace)
    lever = LINKS_M[1] * np.sin(q.sum(axis=1))
    np.testing.assert_allclose(more[:, 1], 0.5 * GRAVITY * lever, atol=1e-9)
    whole = LINKS_M[0] * np.sin(q[:, 0]) + lever
    np.testing.assert_allclose(more[:, 0], 0.5 * GRAVITY * whole, atol=1e-9)
    assert LINKS_KG[1] != 0.5


def test_laws_of_one_joint():
    plant = plant_of(WHEEL)
    trace, q, v, a = swinging(plant)
    way = np.sign(v)

    def more(*effect):
        return (needed(plant, trace, effect) - needed(plant, trace))[:, 0]

    cases = {
        ("viscous_friction", "hinge", 0.3): 0.3 * v,
        ("coulomb_friction", "hinge", 0.2): 0.2 * way,
        ("armature", "hinge", 0.1): 0.1 * a,
        ("joint_spring", "hinge", 2.0, 0.1): 2.0 * (q - 0.1),
        ("torque_offset", "hinge", 0.4): -0.4 + 0 * q,
        ("stribeck_friction", "hinge", 0.2, 0.1, 0.5): way
        * (0.2 + 0.1 * np.exp(-((v / 0.5) ** 2))),
        ("torque_scale", "hinge", 1.5): 0.5 * INERTIA * a,
        ("torque_limit", "hinge", 0.001): 0 * a,
    }
    for effect, expected in cases.items():
        np.testing.assert_allclose(more(*effect), expected, atol=1e-9, err_msg=effect)


def test_load_friction_is_a_share_of_the_motors_torque():
    plant = plant_of(PENDULUM)
    trace, q, v, a = swinging(plant)
    torque = needed(plant, trace, ("load_friction", "hinge", 0.3))[:, 0]
    free = INERTIA * a + PENDULUM_LEVER_NM * np.sin(q)
    np.testing.assert_allclose(
        torque - 0.3 * np.abs(torque) * np.sign(v), free, atol=1e-9
    )
    assert (free * v > 0).any()
    assert (free * v < 0).any()


def test_a_wrong_zero_turns_the_pose():
    plant = plant_of(PENDULUM)
    trace, q, _, a = swinging(plant)
    torque = needed(plant, trace, ("encoder_offset", "hinge", 0.1))[:, 0]
    expected = INERTIA * a + PENDULUM_LEVER_NM * np.sin(q - 0.1)
    np.testing.assert_allclose(torque, expected, atol=1e-9)


def test_late_encoders_show_the_torque_before_the_motion():
    plant = plant_of(WHEEL)
    trace, *_ = swinging(plant)
    torque = needed(plant, trace, ("sensor_delay", "encoders", 0.015))[:, 0]
    later = -25 * 0.4 * np.sin(5 * (trace.time_s + 0.015)) * INERTIA
    np.testing.assert_allclose(torque[:-3], later[:-3], atol=1e-6)


def test_drag_and_pushes_act_through_levers():
    plant = plant_of(PENDULUM)
    trace, q, v, _ = swinging(plant)
    arm_m = 0.1
    plain = needed(plant, trace)
    drag = (needed(plant, trace, ("drag", "rod", 2.0)) - plain)[:, 0]
    np.testing.assert_allclose(drag, 2.0 * arm_m**2 * v, atol=1e-9)
    push = ("external_force", "rod", 3.0, 0.0, 0.0, 0.2, 0.3)
    acts = (trace.time_s >= 0.2) & (trace.time_s < 0.5)
    # about -y the rod's end moves towards +x where it hangs
    lever = arm_m * np.cos(q)
    torque = (needed(plant, trace, push) - plain)[:, 0]
    np.testing.assert_allclose(torque, np.where(acts, -3.0 * lever, 0.0), atol=1e-9)


class Wind(TorqueEffect):
    """A steady torque."""

    name = "wind"

    def parameters(self, plant, place):
        return (Parameter("torque", "N m", -1.0, 1.0, 0.0, 0.1),)

    def torque_nm(self, values, position_rad, velocity_rad_s, time_s):
        return values[..., 0] * (time_s > 0.5)


def test_a_law_of_ones_own_is_followed():
    plant = plant_of(WHEEL)
    trace, *_ = swinging(plant)
    with also_known(Wind()):
        torque = needed(plant, trace, ("wind", "hinge", 0.4)) - needed(plant, trace)
    np.testing.assert_allclose(torque[:, 0], -0.4 * (trace.time_s > 0.5), atol=1e-9)


def test_between_rows_that_are_computed_torques_are_interpolated():
    plant = plant_of(WHEEL)
    fine, coarse = (swinging(plant, rows)[0] for rows in (1, 4 * PER_BLOCK))
    assert needed(plant, coarse).shape == needed(plant, fine).shape
    # four rows of 10 ms: a sine of 5 rad/s is off by (5 * 0.04)^2 / 8 of its size
    wrong = np.abs(needed(plant, coarse) - needed(plant, fine)).max()
    size = np.abs(needed(plant, fine)).max()
    assert 0 < wrong < 0.006 * size


@pytest.mark.parametrize("share", [0.0, 0.8])
def test_no_friction_is_stated_at_rest(share):
    plant = plant_of(WHEEL)
    zero = np.zeros((3, 1))
    trace = moving(plant, zero, zero, zero)
    rubs = (("coulomb_friction", "hinge", 0.5), ("load_friction", "hinge", share))
    assert not needed(plant, trace, *rubs).any()


@pytest.mark.parametrize("rows", [1, 40])
def test_friction_that_bends_needs_torque_after_each_turn(rows):
    """Masing's rule on a swing: F = F_turn - 2 virgin(way / 2), of 8 springs."""
    torque, reach = 0.3, 0.5
    plant = plant_of(WHEEL)
    trace, q, *_ = swinging(plant, rows)
    effect = ("presliding", "hinge", torque, reach)
    found = (needed(plant, trace, effect) - needed(plant, trace))[:, 0]
    most = reach * np.arange(1, 9) / 8

    def virgin(x):
        return torque / most.sum() * np.minimum(x[:, None], most).sum(axis=1)

    top, bottom = np.argmax(q), np.argmin(q)
    falls = virgin(q[[top]]) - 2 * virgin((q[top] - q[top:bottom]) / 2)
    limit = 1e-12 if rows == 1 else 0.03 * torque
    np.testing.assert_allclose(found[:top], virgin(q[:top]), atol=limit)
    np.testing.assert_allclose(found[top:bottom], falls, atol=limit)


def test_a_later_part_knows_how_friction_was_bent():
    plant = plant_of(WHEEL)
    trace, *_ = swinging(plant)
    effect = ("presliding", "hinge", 0.3, 0.5)
    whole = needed(plant, trace, effect)
    part = trace.part(50, 101)
    np.testing.assert_allclose(needed(plant, part, effect), whole[50:], atol=1e-9)


def test_a_joint_that_is_read_late_moved_before():
    """Torques are those of the motion itself, which the reading shows later."""
    plant, late_s = plant_of(ARM), 0.013
    time_s = ticks(1.0)

    def motion(t):
        q = np.stack([0.4 * np.sin(5 * t), 0.3 * np.sin(4 * t + 1)], 1)
        v = np.stack([2.0 * np.cos(5 * t), 1.2 * np.cos(4 * t + 1)], 1)
        return q, v, -np.array([25.0, 16.0]) * q

    true, late = motion(time_s), motion(time_s - late_s)
    mixed = [
        np.stack([one[:, 0], other[:, 1]], 1)
        for one, other in zip(true, late, strict=True)
    ]
    effect = ("late_reading", "elbow", late_s)
    right = needed(plant, moving(plant, *true))
    found = needed(plant, moving(plant, *mixed), effect)
    wrong = needed(plant, moving(plant, *mixed))
    inside = slice(5, -5)
    np.testing.assert_allclose(found[inside], right[inside], atol=1e-3)
    assert np.abs(wrong - right)[inside].max() > 0.005

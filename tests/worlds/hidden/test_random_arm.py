"""Random arms: models, servos and motions against closed forms and SciPy."""

import mujoco
import numpy as np
import pytest
from scipy.integrate import solve_ivp

from worlds.hidden.random_arm import RandomArm

DRIVES = "actuators", "loop"
TICK_S = 0.02


def drawn(joints, drive="loop", seed=3):
    return RandomArm.drawn(joints, drive, np.random.default_rng(seed))


@pytest.mark.parametrize("drive", DRIVES)
@pytest.mark.parametrize("joints", [1, 7])
def test_its_model_has_the_joints_and_is_driven_as_asked(joints, drive):
    arm = drawn(joints, drive)
    model = mujoco.MjModel.from_xml_string(arm.xml)
    assert model.njnt == model.nu == len(arm.joints) == joints
    stiffness = -model.actuator_biasprm[:, 1]
    stated = [
        arm.gains[name].kp if drive == "actuators" else 0.0 for name in arm.joints
    ]
    assert stiffness == pytest.approx(stated)


def test_some_arms_have_dry_friction():
    rubs = ['frictionloss="0.0000"' not in drawn(2, seed=k).xml for k in range(60)]
    assert 0.15 < np.mean(rubs) < 0.55


@pytest.mark.parametrize("drive", DRIVES)
def test_a_single_joint_moves_by_its_equation_of_motion(drive):
    """An integrator with error control, inertia and weight from the model's text."""
    arm = next(
        one
        for one in (drawn(1, drive, seed) for seed in range(9))
        if 'frictionloss="0.0000"' in one.xml
    )
    model = mujoco.MjModel.from_xml_string(arm.xml)
    gains, damping = arm.gains[arm.joints[0]], float(model.dof_damping[0])
    mass, centre_m = float(model.body_mass[1]), float(model.body_ipos[1, 0])
    about_centre = float(np.max(model.body_inertia[1]))
    inertia = about_centre + mass * centre_m**2 + float(model.dof_armature[0])
    time_s = TICK_S * np.arange(100)
    command = 0.4 * (time_s > 0.3) - 0.5 * (time_s > 1.1)

    def angles(stiffer):
        def law(t, state):
            target = command[min(int(t / TICK_S + 1e-9), len(command) - 1)]
            # about y a positive angle turns the link down: its weight drives it on
            weight = mass * 9.81 * centre_m * np.cos(state[0])
            pull = stiffer * gains.kp * (target - state[0])
            torque = pull + weight - (gains.kd + damping) * state[1]
            return [state[1], torque / inertia]

        rest = solve_ivp(lambda _, y: law(0.0, y), (0, 5), np.zeros(2), rtol=1e-9)
        state, found = rest.y[:, -1], []
        for t in time_s:
            found.append(state[0])
            end = t + TICK_S - 1e-12
            state = solve_ivp(law, (t, end), state, rtol=1e-9, atol=1e-11).y[:, -1]
        return np.array(found)

    moved = arm.moved(command[:, None], TICK_S)[:, 0]
    # a loop in steps of 0.1 ms is late by half a step, at 5 rad/s
    np.testing.assert_allclose(moved, angles(1.0), atol=4e-4)
    assert np.abs(moved - angles(1.03)).max() > 2e-3


def test_both_drives_move_an_arm_alike():
    """MuJoCo's actuators are integrated implicitly, the loop is not."""
    command = np.outer(np.sin(np.arange(60) / 9), [0.4, -0.3, 0.5])
    moved = [drawn(3, drive).moved(command, TICK_S) for drive in DRIVES]
    np.testing.assert_allclose(*moved, atol=1e-3)
    other = drawn(3, seed=4).moved(command, TICK_S)
    assert np.abs(other - moved[1]).max() > 0.05

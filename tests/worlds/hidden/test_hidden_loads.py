"""Robots with hidden physics carry known loads, in both engines."""

import numpy as np
import pytest

from groundwalk.errors import UnknownNameError
from worlds import Load
from worlds.hidden.mujoco_engine import hidden_model
from worlds.hidden.plant import hidden_plant
from worlds.hidden.run import Clock, run_hidden

LOAD = Load(1.5, (0.05, 0.1, -0.2))


def test_a_body_with_a_load_has_the_inertia_of_both():
    """By the parallel axis theorem about the joint, where both are known."""
    bare = hidden_plant("pendulum")
    before, after = (
        hidden_model(one, (), 1e-3, None).body("link")
        for one in (bare, bare.with_loads({"link": LOAD}))
    )
    assert after.mass[0] == pytest.approx(before.mass[0] + LOAD.mass)
    centre = (before.mass * before.ipos + LOAD.mass * np.array(LOAD.at)) / after.mass
    np.testing.assert_allclose(after.ipos, centre)

    def about_joint(body):
        turn = quaternion_matrix(body.iquat)
        own = turn @ np.diag(body.inertia) @ turn.T
        return own + body.mass[0] * shifted(body.ipos)

    more = about_joint(after) - about_joint(before)
    np.testing.assert_allclose(more, LOAD.mass * shifted(np.array(LOAD.at)), atol=1e-12)


def shifted(at):
    return at @ at * np.eye(3) - np.outer(at, at)


def quaternion_matrix(quat):
    from scipy.spatial.transform import Rotation

    return Rotation.from_quat(quat, scalar_first=True).as_matrix()


@pytest.mark.parametrize("engine", ["mujoco", "bullet"])
def test_a_load_pulls_the_joint_down(engine):
    """At rest the servo's error is gravity's torque over its stiffness."""
    bare, lever_m = hidden_plant("pendulum"), 0.25
    kp, target = float(bare.kp_nm_rad[0]), np.array([0.5])
    # the pendulum's own mass and lever stand in its model file
    for loads, moment in (({}, 0.15), ({"link": Load(1.0, (0, 0, -lever_m))}, 0.4)):
        clock = Clock(1e-3, np.arange(0, 8001, 100), 0)
        run = run_hidden(
            bare.with_loads(loads), (), engine, clock, lambda row, _: target,
            target, np.random.SeedSequence(1),
        )  # fmt: skip
        angle = float(run.position_rad[-1, 0])
        wanted = moment * 9.81 * np.sin(angle)
        assert kp * (target[0] - angle) == pytest.approx(wanted, abs=2e-3)


def test_a_body_that_is_not_there_is_refused():
    with pytest.raises(UnknownNameError, match="did you mean 'link'"):
        hidden_plant("pendulum").with_loads({"lonk": LOAD})
    plant = hidden_plant("pendulum")
    assert plant.with_loads({}) is plant

"""What the MuJoCo model holds beside its links and motors."""

import mujoco
import numpy as np
import pytest

from robots.engine_models.mjcf import mujoco_spec
from robots.sole import CONTACT_RADIUS_M, contact_points


def test_weight(nao, model):
    assert mujoco.mj_getTotalmass(model) == pytest.approx(nao.mass_kg, rel=1e-12)


def test_only_the_soles_can_touch(model):
    """A geom touches if its own contype meets another's conaffinity."""
    soles = [k for k in range(model.ngeom) if model.geom(k).name.startswith("sole_")]
    assert len(soles) == 24
    np.testing.assert_array_equal(np.flatnonzero(model.geom_contype), soles)
    assert not model.geom_conaffinity.any()
    feet = {model.body("LFoot").id, model.body("RFoot").id}
    assert set(model.geom_bodyid[soles]) == feet


def test_soles_reach_down_to_the_sole(nao, model):
    for side, foot in zip(("left", "right"), nao.feet, strict=True):
        for k, (x, y) in enumerate(contact_points(foot)):
            geom = model.geom(f"sole_{side}_{k}")
            assert geom.size[0] == CONTACT_RADIUS_M
            np.testing.assert_allclose(
                geom.pos, [x, y, -0.04511 + CONTACT_RADIUS_M], atol=1e-12
            )


def test_sensors_come_in_the_order_that_worlds_read(model):
    names = [model.sensor(k).name for k in range(model.nsensor)]
    touch = [f"touch_{side}_{k}" for side in ("left", "right") for k in range(12)]
    assert names == [*touch, "gyroscope", "accelerometer"]
    assert model.nsensordata == 24 + 3 + 3


def test_accelerometer_and_gyroscope_of_a_spinning_torso(nao):
    """Without gravity, spinning about z at w: w^2 r towards the axis."""
    spec = mujoco_spec(nao)
    spec.option.gravity = [0, 0, 0]
    model = spec.compile()
    data = mujoco.MjData(model)
    # All links turn as one: no joint moves, and none is asked to.
    data.qvel[5] = 4.0
    mujoco.mj_forward(model, data)
    np.testing.assert_allclose(data.sensor("gyroscope").data, [0, 0, 4], atol=1e-9)
    spin = data.qvel[3:6]
    turning, place = data.qacc[3:6], np.array([-0.008, 0.00606, 0.027])
    expected = (
        data.qacc[:3] + np.cross(turning, place) + np.cross(spin, np.cross(spin, place))
    )
    np.testing.assert_allclose(data.sensor("accelerometer").data, expected, atol=1e-9)


def test_coupled_joints_are_held_together(nao, model):
    assert model.neq == 1
    first, second = (model.joint(nao.joints[k]).id for k in nao.coupled[0])
    assert (model.eq_obj1id[0], model.eq_obj2id[0]) == (first, second)
    np.testing.assert_array_equal(model.eq_data[0, :5], [0, 1, 0, 0, 0])

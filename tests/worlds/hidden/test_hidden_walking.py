"""A robot on its feet with hidden physics."""

import numpy as np
import pytest

import robots
from worlds.hidden.effects import Hidden
from worlds.hidden.plant import hidden_plant
from worlds.hidden.run import Clock, run_hidden

NOBODY = np.random.SeedSequence(0)
SLOPE = Hidden("ground_slope", "world", {"pitch": 0.05, "roll": 0.0})
SOFT = Hidden("contact_compliance", "feet", {"stiffness": 4000.0})


def stand(engine, *effects, rows=60):
    plant = hidden_plant("nao", floating=True)
    pose = np.zeros(len(plant.joints))
    for side in "LR":
        for name, angle in (
            ("HipPitch", -0.4),
            ("KneePitch", 0.8),
            ("AnklePitch", -0.4),
        ):
            pose[plant.joint(side + name)] = angle
    pose = np.clip(pose, *plant.range_rad.T)
    clock = Clock(0.0005, np.arange(rows) * 20, 0)
    return run_hidden(plant, effects, engine, clock, lambda k, s: pose, pose, NOBODY)


@pytest.mark.parametrize("engine", ["mujoco", "bullet"])
def test_feet_carry_the_weight_and_the_sensors_feel_it(engine):
    run = stand(engine)
    weight_n = robots.get("nao").mass_kg * 9.81
    assert run.ok
    assert run.sense["foot_force_n"][-1].sum() == pytest.approx(weight_n, rel=0.05)
    assert run.sense["accelerometer_m_s2"][-1, 2] == pytest.approx(9.81, abs=0.15)


def test_on_a_slope_the_robot_leans_with_the_ground():
    level, tilted = stand("bullet"), stand("bullet", SLOPE)
    assert level.sense["orientation"][0, 2] == pytest.approx(0.0, abs=1e-9)
    assert tilted.sense["orientation"][0, 2] == pytest.approx(np.sin(0.025), abs=1e-6)
    assert tilted.sense["accelerometer_m_s2"][-1, 0] < -0.3
    assert level.sense["accelerometer_m_s2"][-1, 0] > -0.3


def test_on_soft_ground_it_sinks_as_far_as_springs_say():
    hard, soft = stand("bullet", rows=120), stand("bullet", SOFT, rows=120)
    deeper_m = hard.sense["position_m"][-1, 2] - soft.sense["position_m"][-1, 2]
    weight_n = robots.get("nao").mass_kg * 9.81
    assert deeper_m == pytest.approx(weight_n / 2 / 4000.0, rel=0.15)


def test_a_push_tells():
    push = {"x": 20.0, "y": 0.0, "z": 0.0, "start": 0.1, "duration": 0.2}
    pushed = stand("mujoco", Hidden("external_force", "torso", push))
    alone = stand("mujoco")
    change = pushed.sense["linear_m_s"][:, 0] - alone.sense["linear_m_s"][:, 0]
    assert np.abs(change[:10]).max() < 1e-9
    assert change[12:30].max() > 0.03


def test_a_robot_that_is_knocked_over_is_not_well():
    push = {"x": 200.0, "y": 0.0, "z": 0.0, "start": 0.0, "duration": 0.5}
    fallen = stand("mujoco", Hidden("external_force", "torso", push), rows=150)
    assert not fallen.ok

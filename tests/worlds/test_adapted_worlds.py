"""Other humanoids in both worlds."""

import numpy as np
import pytest

import robots
from robots import biped
from walk_engine import WalkEngine, gaits

TICKS = 60


@pytest.fixture(scope="module")
def g1():
    return robots.get("g1")


@pytest.fixture(scope="module")
def in_the_air(make_world, g1):
    """Function: joint positions (ticks, joints) of a hanging G1 that waves its legs."""
    start = WalkEngine(biped(g1), [gaits.get("start")]).start_pose()
    phase = np.random.default_rng(3).uniform(0, 2 * np.pi, start.shape)

    def run(name):
        world = make_world(name, description=g1, fixed_base=True)
        world.reset(start)
        waves = 0.1 * (np.sin(0.05 * np.arange(TICKS)[:, None, None] + phase))
        rows = [world.step(start + wave - waves[0]) for wave in waves]
        return np.array([row.position_rad[0] for row in rows])

    return run


def test_worlds_agree_in_the_air(in_the_air):
    """Nothing is lumped or coupled here: the engines differ by rounding alone."""
    sim, real = in_the_air("sim"), in_the_air("real")
    assert np.ptp(sim, axis=0).min() > 0.01  # they move
    np.testing.assert_allclose(sim, real, atol=1e-6)


def test_a_servo_that_damps_more_than_its_motor(in_the_air, g1):
    """So it is here, which the NAO's motors do not show."""
    for joint in g1.links:
        motor = joint.motor
        back_emf = motor.stall_torque_nm / motor.no_load_speed_rad_s
        assert motor.kd_nm_s_rad > 1.5 * back_emf

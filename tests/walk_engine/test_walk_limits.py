"""Commands stay within what the joints can do."""

import numpy as np
import pytest
from walk_drill import Drill

from walk_engine import Velocity, WalkEngine, gaits
from walk_engine.gait import PARAMETERS, from_unit

WALK2014 = gaits.get("walk2014")


def wild_commands(biped):
    """Fifty gaits from all over the bounds, walking, turning and stepping aside."""
    rng = np.random.default_rng(5)
    engine = WalkEngine(biped, from_unit(rng.random((50, 16))))
    start = engine.start_pose()[None]
    request = Velocity(np.inf, rng.uniform(-0.3, 0.3, 50), rng.uniform(-1, 1, 50))
    gyroscope = rng.normal(0.0, 1.0, (50, 3))
    walked = Drill(engine, half_period_s=0.2).run(150, request, gyroscope)
    return np.concatenate([start, walked])


def test_commands_respect_ranges_and_speeds(biped):
    commands = wild_commands(biped)
    low, high = biped.joint_range_rad.T
    assert ((commands >= low) & (commands <= high)).all()
    fastest = np.abs(np.diff(commands, axis=0)).max(axis=(0, 1)) / 0.01
    assert (fastest <= 0.9 * biped.max_speed_rad_s + 1e-9).all()
    assert fastest[3] == pytest.approx(0.9 * 6.96)  # the knee's limit is met


def test_the_same_gaits_unlimited_ask_for_more(unlimited, biped):
    commands = wild_commands(unlimited)
    assert np.abs(np.diff(commands, axis=0)).max() / 0.01 > biped.max_speed_rad_s.max()


@pytest.mark.parametrize("corner", [0.0, 1.0])
def test_extreme_gaits_give_finite_commands(unlimited, corner):
    engine = WalkEngine(unlimited, from_unit(np.full((1, 16), corner)))
    commands = Drill(engine).run(150, Velocity(np.inf, 0.2, 0.87))
    assert np.isfinite(commands).all()


def test_out_of_reach_strides_are_cut_not_nan(unlimited):
    tall = WALK2014.replace(hip_height=0.24, max_forward=0.45, step_period=0.34)
    commands = Drill(WalkEngine(unlimited, [tall]), half_period_s=0.34).run(200)
    assert np.isfinite(commands).all()
    assert (commands[:, :, [3, 9]] < 0.1).any()  # a leg stretched to its end


def test_bounds_of_every_parameter_are_walked_at(unlimited):
    rows = [
        WALK2014.replace(**{parameter.name: bound})
        for parameter in PARAMETERS
        for bound in (parameter.low, parameter.high)
    ]
    commands = Drill(WalkEngine(unlimited, rows)).run(120)
    assert np.isfinite(commands).all()

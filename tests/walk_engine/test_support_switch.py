"""The change of the support foot, driven by made-up force sensors."""

import numpy as np
import pytest
from walk_drill import LEFT, RIGHT, forces

from walk_engine import Velocity, WalkEngine, gaits
from walk_engine.engine_config import EngineConfig
from walk_engine.stepper import nothing_sensed, sense, sensor_lateral_m

WALK2014 = gaits.get("walk2014")
CONFIG = EngineConfig()


def change_ticks(biped, sides, gait=WALK2014, readings=forces):
    """The ticks (from 1) at which the support changed, and the supports after them."""
    engine = WalkEngine(biped, [gait])
    found, before = [], None
    for tick, side in enumerate(sides, start=1):
        engine.step(Velocity.forward(), np.zeros((1, 3)), readings(side))
        now = int(engine.support[0])
        if before is not None and now != before:
            found.append((tick, now))
        before = now
    return found


def test_weight_that_moves_after_the_minimal_phase_changes_the_support(biped):
    # 0.75 * 0.23 s = 0.1725 s: tick 18 is the first that counts.
    assert change_ticks(biped, [RIGHT] * 17 + [LEFT] * 20) == [(18, LEFT)]


def test_weight_that_moves_earlier_is_missed_until_the_timeout(biped):
    sides = [RIGHT] * 16 + [LEFT] * 70
    ((tick, side),) = change_ticks(biped, sides)
    assert side == LEFT
    assert tick in (69, 70)  # 3 * 0.23 s = 0.69 s


def test_weight_that_moves_late_changes_the_support_then(biped):
    assert change_ticks(biped, [RIGHT] * 49 + [LEFT] * 5) == [(50, LEFT)]


def test_minimal_phase_is_the_gaits(biped):
    sides = [RIGHT] * 12 + [LEFT] * 10
    early = WALK2014.replace(switch_min_phase=0.5)
    assert change_ticks(biped, sides, early) == [(13, LEFT)]
    assert change_ticks(biped, sides) == []


def test_weight_that_never_moves_leaves_the_same_foot_in_support(biped):
    engine = WalkEngine(biped, [WALK2014])
    times = []
    for _ in range(75):
        engine.step(Velocity.forward(), np.zeros((1, 3)), forces(RIGHT))
        times.append(engine.step_time_s[0])
        assert engine.support[0] == RIGHT
    assert times.count(0.0) == 1
    assert times.index(0.0) + 1 in (69, 70)


def test_sensors_that_show_nothing_change_the_support_at_each_timeout(biped):
    dead = change_ticks(biped, [0] * 145, readings=lambda _: np.zeros((1, 8)))
    assert [side for _, side in dead] == [LEFT, RIGHT]
    assert dead[0][0] in (69, 70)


@pytest.mark.parametrize("gap", [0, 1, 3])
def test_a_jump_between_the_feet_is_still_a_crossing(biped, gap):
    def readings(side):
        return np.zeros((1, 8)) if side == 0 else forces(side)

    sides = [RIGHT] * 17 + [0] * gap + [LEFT] * 5
    assert change_ticks(biped, sides, readings=readings) == [(18 + gap, LEFT)]


def test_a_gap_without_change_of_side_is_no_crossing(biped):
    def readings(side):
        return np.zeros((1, 8)) if side == 0 else forces(side)

    sides = [RIGHT] * 19 + [0] * 2 + [RIGHT] * 5
    assert change_ticks(biped, sides, readings=readings) == []


def test_sensor_positions_give_the_weights_of_walk2014(biped):
    # Walk2014: outer sensors at 0.080 m, inner ones at 0.030 m.
    left = [0.080, 0.030, 0.080, 0.030]
    right = [-0.030, -0.080, -0.030, -0.080]
    assert np.allclose(sensor_lateral_m(biped), left + right, atol=0.005)


def sensed(biped, before, reading):
    force_n = np.array(reading, dtype=float)[:, None]
    return sense(before, force_n, sensor_lateral_m(biped), CONFIG)


def test_each_sensor_is_scaled_by_its_own_largest_reading(biped):
    weak_left = [2.0] * 4 + [20.0] * 4
    seen = sensed(biped, nothing_sensed(1, CONFIG), weak_left)
    assert seen.side[0] == 0  # all at their largest: balanced
    lighter_right = [2.0] * 4 + [16.0] * 4
    assert sensed(biped, seen, lighter_right).side[0] == LEFT
    lighter_left = [1.6] * 4 + [20.0] * 4
    assert sensed(biped, seen, lighter_left).side[0] == RIGHT


def test_largest_readings_start_above_noise_and_stop_growing(biped):
    seen = nothing_sensed(1, CONFIG)
    assert np.allclose(seen.largest_n, 0.980665)
    seen = sensed(biped, seen, [0.5, 30, 1000, 0, 0, 0, 0, -3])
    expected = [0.980665, 30, 49.03325, *[0.980665] * 5]
    assert np.allclose(seen.largest_n[:, 0], expected)
    assert (sensed(biped, seen, [0.0] * 8).largest_n == seen.largest_n).all()


def test_readings_below_zero_count_as_none(biped):
    seen = sensed(biped, nothing_sensed(1, CONFIG), [-5.0] * 4 + [0.0] * 4)
    assert seen.side[0] == 0


def test_a_mirrored_load_is_balanced_to_the_last_bit(biped):
    rng = np.random.default_rng(2)
    seen = sensed(biped, nothing_sensed(1, CONFIG), [30.0] * 8)
    for left in rng.uniform(1, 29, (50, 4)):
        assert sensed(biped, seen, [*left, *left[[1, 0, 3, 2]]]).side[0] == 0
        assert sensed(biped, seen, [*left, *left[[1, 0, 3, 2]] * 0.9]).side[0] == LEFT


def test_a_load_that_balances_diagonally_is_balanced_to_the_last_bit(biped):
    rng = np.random.default_rng(2)
    seen = sensed(biped, nothing_sensed(1, CONFIG), [30.0] * 8)
    for front, inner, rear in rng.uniform(1, 29, (50, 3)):
        balanced = [front, inner, rear, 0, inner, rear, 0, front]
        assert sensed(biped, seen, balanced).side[0] == 0

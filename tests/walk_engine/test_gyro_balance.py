"""What the gyroscope does to the ankles."""

import numpy as np
import pytest
from walk_drill import Drill, feet_of

from walk_engine import Velocity, WalkEngine, gaits

GAIT = gaits.get("walk2014").replace(gyro_sagittal=0.05, gyro_coronal=0.03)
PITCH_RATE, ROLL_RATE = np.array([[0.0, 1.0, 0.0]]), np.array([[1.0, 0.0, 0.0]])
ANKLE_PITCH, ANKLE_ROLL = [4, 10], [5, 11]


def correction(biped, gyroscope, ticks, request=None, tick_s=0.01, gait=GAIT):
    """Commands with the gyroscope less those without, and the drill with it."""
    drills = [Drill(WalkEngine(biped, [gait], tick_s)) for _ in range(2)]
    turned = drills[0].run(ticks, request, gyroscope)[:, 0]
    still = drills[1].run(ticks, request)[:, 0]
    return turned - still, drills[0]


@pytest.mark.parametrize(
    ("gyroscope", "ankles", "gain"),
    [(PITCH_RATE, ANKLE_PITCH, 0.05), (ROLL_RATE, ANKLE_ROLL, 0.03)],
)
def test_only_the_support_ankle_follows_the_filtered_rate(
    unlimited, gyroscope, ankles, gain
):
    delta, drill = correction(unlimited, gyroscope, 120)
    filtered = 1 - 0.8 ** np.arange(1, 121)
    support = np.array(drill.supports)
    expected = np.zeros_like(delta)
    for column, side in zip(ankles, (1, -1), strict=True):
        expected[:, column] = gain * filtered * (support[:, 0] == side)
    assert np.allclose(delta, expected, atol=1e-12)
    assert set(support[:, 0]) == {-1, 1}


def test_yaw_rate_does_nothing(unlimited):
    delta, _ = correction(unlimited, np.array([[0.0, 0.0, 1.0]]), 50)
    assert (delta == 0).all()


def test_no_feedback_while_ready(unlimited):
    delta, _ = correction(unlimited, PITCH_RATE + ROLL_RATE, 30, Velocity())
    assert (delta == 0).all()


def test_both_ankles_while_rising_and_standing(unlimited):
    delta, _ = correction(unlimited, PITCH_RATE, 80, Velocity(stand=True))
    assert np.allclose(delta[-1, ANKLE_PITCH], 0.05, atol=1e-6)
    assert np.allclose(delta[10, ANKLE_PITCH], 0.05 * (1 - 0.8**11), atol=1e-12)


def test_time_constant_does_not_depend_on_the_tick(unlimited):
    coarse, _ = correction(unlimited, PITCH_RATE, 5, tick_s=0.01)
    fine, _ = correction(unlimited, PITCH_RATE, 10, tick_s=0.005)
    assert np.allclose(coarse[:, 10], fine[1::2, 10], atol=1e-12)
    assert coarse[0, 10] == pytest.approx(0.05 * 0.2)


def edges_lowered(biped, gyroscope):
    """How much toes, heel, right and left edge of the support foot sink."""
    offsets = np.array(
        [[0.1, 0, -0.045], [-0.05, 0, -0.045], [0, -0.04, -0.045], [0, 0.04, -0.045]]
    )
    heights = []
    for rates in (gyroscope, np.zeros((1, 3))):
        drill = Drill(WalkEngine(biped, [GAIT]))
        ankles, turns = feet_of(biped, drill.run(10, gyroscope=rates)[-1, 0])
        assert drill.supports[-1][0] == -1
        heights.append((ankles[1] + offsets @ turns[1].T)[:, 2])
    return heights[1] - heights[0]


def test_falling_forward_presses_the_toes_down(unlimited):
    toes, heel, right, left = edges_lowered(unlimited, PITCH_RATE)
    assert toes > 1e-3 > -1e-3 > heel
    assert right == pytest.approx(left)


def test_falling_to_the_right_presses_the_right_edge_down(unlimited):
    # A right-handed turn about x (forward) carries y (left) to z (up): to the right.
    toes, heel, right, left = edges_lowered(unlimited, ROLL_RATE)
    assert right > 5e-4 > -5e-4 > left
    assert toes == pytest.approx(heel)

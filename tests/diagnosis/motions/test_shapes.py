"""Shapes of motions: what each promises."""

import numpy as np
import pytest

from diagnosis.motions.shapes import MOTIONS

TICK_S = 0.01


def values_of(name):
    motion = {one.name: one for one in MOTIONS}[name]
    time_s = np.arange(0, motion.duration_s + TICK_S / 2, TICK_S)
    return time_s, motion.shape(time_s, motion.duration_s)


@pytest.mark.parametrize("motion", MOTIONS, ids=lambda one: one.name)
def test_motions_begin_and_end_at_the_centre_and_stay_within_reach(motion):
    time_s, values = values_of(motion.name)
    assert values.shape == time_s.shape
    assert abs(values[0]) < 1e-9
    assert abs(values[-1]) < 1e-9
    assert 0.4 < np.abs(values).max() <= 1.0
    jumps = np.abs(np.diff(values)).max()
    assert (jumps > 0.2) == motion.sudden


def test_ramps_go_both_ways_at_two_speeds():
    _, values = values_of("slow_ramps")
    speeds = np.unique(np.round(np.diff(values) / TICK_S, 2))
    slow, fast = -2 / (0.4 * 24), -2 / (0.14 * 24)
    assert {round(slow, 2), round(fast, 2)} <= set(speeds.tolist())
    assert (speeds > 0).any()


def test_holds_rest_at_poses_on_both_sides():
    _, values = values_of("holds")
    resting = values[:-1][np.abs(np.diff(values)) < 1e-9]
    assert {0.9, -0.9} <= set(np.round(np.unique(resting), 6).tolist())
    assert len(resting) > 0.4 * len(values)


def test_a_chirp_quickens_to_5_hz():
    _, values = values_of("chirp")
    turns = np.flatnonzero(np.diff(np.sign(values)) != 0) * TICK_S
    last = turns[(turns > 18) & (turns < 19.5)]
    assert 0.5 / np.diff(last).mean() == pytest.approx(4.0, rel=0.25)
    assert 0.5 / np.diff(turns[1:4]).mean() < 0.8


def test_small_strokes_turn_back_often():
    _, values = values_of("reversals")
    turns = np.count_nonzero(np.diff(np.sign(np.diff(values))) != 0)
    assert turns >= 14

import dataclasses

import numpy as np
import pytest
from made_up_runs import STANDING_M, glide, steady

from experiments.seeing.scenes import make_scenes
from experiments.seeing.walk_strip import walk_strip
from groundwalk.errors import UnknownNameError
from terrain import Heightfield
from worlds import Recording

HEAD_M = STANDING_M + 0.1265 + 0.057 + 0.056


def strip_of(recording, ground=None):
    (scene,) = make_scenes({"sim/tuned": recording})
    return walk_strip(dataclasses.replace(scene, ground=ground))


def test_the_piece_is_one_metre_in_the_middle_of_the_walk():
    strip = strip_of(steady(0.5, 6.0))  # 3 m
    assert (strip.ticks.start, strip.ticks.stop) == pytest.approx((200, 400), abs=1)
    assert strip.x_range_m == pytest.approx((0.75, 2.25), abs=0.01)
    assert not strip.ended
    assert strip.title == "sim, tuned: 50.0 cm/s"


def test_of_a_slow_walk_it_is_five_seconds():
    strip = strip_of(steady(0.05, 20.0))
    assert (strip.ticks.start, strip.ticks.stop) == pytest.approx((750, 1250), abs=1)


def test_a_short_walk_is_shown_whole():
    strip = strip_of(steady(0.5, 1.0))
    assert (strip.ticks.start, strip.ticks.stop) == (0, 101)
    assert strip.x_range_m == pytest.approx((-0.5, 1.0))


def test_before_a_fall_it_is_the_last_metre():
    strip = strip_of(steady(0.5, 6.0, end="fall"))
    assert (strip.ticks.start, strip.ticks.stop) == pytest.approx((401, 601), abs=1)
    assert strip.ended
    assert strip.title == "sim, tuned: 50.0 cm/s, fall at 6.0 s"


def test_a_robot_that_turned_around_is_still_in_the_picture():
    there = np.arange(0, 2, 0.005)
    strip = strip_of(glide([*there, *there[:0:-1]], end="fall"))
    low_m, high_m = strip.x_range_m
    assert low_m < -0.2 < 1.2 < high_m
    assert strip.ticks.stop == 2 * len(there) - 1


def test_stills_follow_each_other_up_to_the_last_tick():
    strip = strip_of(steady(0.2, 3.0, end="fall"))
    assert strip.stills[-1] == 300
    assert set(np.diff(strip.stills)) == {12}


def test_stills_of_one_tick():
    strip = strip_of(glide([0.0], end="fall"))
    assert strip.stills.tolist() == strip.clear.tolist() == [0]


def test_clear_stills_do_not_cover_each_other():
    strip = strip_of(steady(0.2, 3.0))
    apart_m = -np.diff(strip.figure.torso[strip.clear, -1, 0])
    assert strip.clear[0] == strip.stills[-1]
    assert set(strip.clear) < set(strip.stills)
    assert (apart_m > 2 * 0.056).all()
    assert (apart_m < 4 * 0.056).all()


def test_each_foot_has_the_ground_below_itself():
    # A plane that rises to the left: 10 cm a metre.
    heights_m = 0.1 * np.linspace(-2, 2, 41)[:, None] + np.zeros((41, 61))
    ground = Heightfield(heights_m, (-1.0, -2.0), 0.1)
    strip = strip_of(glide(0.01 * np.arange(100), y_m=0.5), ground)
    for side, y_m in (("left", 0.55), ("right", 0.45)):
        x_m, z_m = strip.ground_m[side].T
        assert (x_m[0], x_m[-1]) == pytest.approx(strip.x_range_m)
        np.testing.assert_allclose(z_m, 0.1 * y_m, atol=1e-9)
    assert strip.z_range_m == pytest.approx((0.045, HEAD_M))


def test_without_ground_the_heights_begin_at_zero():
    strip = strip_of(steady())
    assert strip.ground_m == {}
    assert strip.z_range_m == pytest.approx((0, HEAD_M))


def test_a_walk_without_places_cannot_be_shown():
    recording = steady()
    columns = {
        name: values
        for name, values in recording.columns.items()
        if not name.startswith("base.position")
    }
    with pytest.raises(UnknownNameError, match=r"base\.position"):
        strip_of(Recording(columns, recording.metadata))

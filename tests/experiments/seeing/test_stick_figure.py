from dataclasses import replace

import numpy as np
import pytest
from made_up_runs import NAO, STANDING_M, glide, steady

from experiments.seeing.scenes import make_scenes
from experiments.seeing.walk_strip import NAO_HEAD_M, stick_figure
from worlds import Recording
from worlds.scenes.scene import Scene


def figure_of(recording):
    return stick_figure(make_scenes({"sim": recording})[0])


def test_straight_legs_stand_on_the_ground():
    figure = figure_of(glide([0.0, 1.0]))
    for side, y_m in (("left", 0.05), ("right", -0.05)):
        hip, *_, knee, ankle, roll, heel, toe, back = figure.legs[side][1]
        np.testing.assert_allclose(hip, [1, y_m, STANDING_M - 0.085], atol=1e-12)
        np.testing.assert_allclose(knee, [1, y_m, STANDING_M - 0.185], atol=1e-12)
        for point in (ankle, roll, back):
            np.testing.assert_allclose(point, [1, y_m, 0.04511], atol=1e-12)
        np.testing.assert_allclose(heel, [1 - 0.0507, y_m, 0], atol=1e-12)
        np.testing.assert_allclose(toe, [1 + 0.0994, y_m, 0], atol=1e-12)


def test_torso_and_head_stand_upright_between_the_limbs():
    figure = figure_of(glide([0.3]))
    hips, shoulders, head = figure.torso[0]
    np.testing.assert_allclose(hips, [0.3, 0, STANDING_M - 0.085], atol=1e-12)
    np.testing.assert_allclose(shoulders, [0.3, 0, STANDING_M + 0.1], atol=1e-12)
    assert head[2] - STANDING_M == pytest.approx(0.1265 + 0.057)
    assert figure.head_radius_m == pytest.approx(0.056)


def test_arms_reach_forward_one_on_each_side():
    left, right = figure_of(glide([0.0])).arms
    for arm, side in ((left, 1), (right, -1)):
        np.testing.assert_allclose(arm[0, 0], [0, side * 0.098, STANDING_M + 0.1])
        reach_m = arm[0, -1] - arm[0, 0]
        assert 0.2 < reach_m[0] < 0.24
        assert abs(reach_m[2]) < 0.02


def test_a_leg_turns_with_its_joints_and_the_feet_with_the_torso():
    columns = dict(glide([0.0]).columns)
    columns["position.LKneePitch"] = np.array([np.pi / 2])
    columns["base.orientation.w"] = np.array([np.sqrt(0.5)])
    columns["base.orientation.z"] = np.array([np.sqrt(0.5)])
    figure = figure_of(Recording(columns, steady().metadata))
    # Torso turned to the left: forward is +y. The left knee bends the shank backward.
    knee, ankle = figure.legs["left"][0, 3:5]
    np.testing.assert_allclose(ankle - knee, [0, -0.1029, 0], atol=1e-12)
    *_, ankle, _heel, toe, _ = figure.legs["right"][0]
    np.testing.assert_allclose(toe - ankle, [0, 0.0994, -0.04511], atol=1e-12)


def test_what_is_missing_at_a_tick_is_nan_there_and_nowhere_else():
    columns = dict(glide([0.0, 1.0, 2.0]).columns)
    columns["position.LKneePitch"] = np.array([0.0, np.nan, 0.0])
    columns["base.orientation.w"] = np.array([1.0, 1.0, np.nan])
    figure = figure_of(Recording(columns, steady().metadata))
    left, right = figure.legs["left"], figure.legs["right"]
    for whole in (left[0], right[:2], figure.torso[:2], figure.arms[0][:2]):
        assert np.isfinite(whole).all()
    assert np.isfinite(left[1, :3]).all()
    for missing in (left[1, -3:-1], left[2, 1:], figure.torso[2], figure.arms[0][2]):
        assert np.isnan(missing).all()


def test_a_root_without_shapes_has_a_head_where_its_mass_is():
    bare = replace(NAO, root=replace(NAO.root, shapes=()))
    figure = stick_figure(Scene("sim", glide([0.3]), bare))
    com_m = NAO.root.inertial.com_m
    np.testing.assert_allclose(figure.torso[0, -1] - (0.3, 0, STANDING_M), com_m)
    assert figure.head_radius_m == NAO_HEAD_M
    assert figure_of(glide([0.3])).torso[0, -1, 2] > figure.torso[0, -1, 2]

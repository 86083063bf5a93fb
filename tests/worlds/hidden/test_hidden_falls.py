"""Robots with hidden physics fall by the one rule: torso height above the ground."""

import math

import numpy as np
import pytest

from terrain import Heightfield
from worlds.hidden.run import stands

ROWS = 50
START_M = 0.33


def path(x_m, height_m, tilt_rad=0.0):
    turn = np.zeros((ROWS, 4))
    turn[:, 0], turn[:, 2] = math.cos(tilt_rad / 2), math.sin(tilt_rad / 2)
    place = np.stack([x_m, np.zeros(ROWS), height_m], axis=1)
    return {"position_m": place, "orientation": turn}


def slope(rise):
    """Ground that falls or rises along x by a share of the way."""
    x = np.linspace(-3, 3, 61)
    return Heightfield(np.tile(rise * x, (61, 1)), (-3.0, -3.0), 0.1)


def test_a_robot_that_walks_down_a_hill_stands():
    """Its height above the origin is soon below half of what it was."""
    x = np.linspace(0, 2, ROWS)
    ground = slope(-0.1)
    assert START_M - 0.1 * 2 < START_M / 2
    assert stands(path(x, START_M - 0.1 * x), ground)
    assert not stands(path(x, START_M - 0.2 * x), ground)


def test_a_robot_that_sinks_to_half_of_its_height_on_a_hill_has_fallen():
    x = np.linspace(0, 2, ROWS)
    assert not stands(path(x, np.full(ROWS, START_M)), slope(0.1))


@pytest.mark.parametrize(("tilt_deg", "up"), [(0, True), (59, True), (61, False)])
def test_a_robot_that_tilts_by_more_than_60_degrees_has_fallen(tilt_deg, up):
    level = path(np.zeros(ROWS), np.full(ROWS, START_M), math.radians(tilt_deg))
    assert stands(level, slope(0.0)) == up


@pytest.mark.parametrize("name", ["position_m", "orientation"])
def test_a_robot_without_numbers_does_not_stand(name):
    felt = path(np.zeros(ROWS), np.full(ROWS, START_M))
    felt[name][7] = np.nan
    assert not stands(felt, slope(0.0))

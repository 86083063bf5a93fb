"""Contact points of a sole, and how a force at each is shared by its sensors."""

import numpy as np

from groundwalk.arrays import FloatArray
from robots.description import Foot

CONTACT_RADIUS_M = 0.01
"""Radius [m] of the spheres that touch the ground: smaller ones, of 3 mm, got caught
below the ground in Bullet."""

FRICTION = 0.8
"""Friction coefficient of plastic soles on carpet: no measurement is known, and
simulators of the NAO use 0.5 to 1."""

RIM_POINTS = 10
"""Corners kept of a sole's rim: on the NAO ten keep 98 % of the area, and all fifteen
cost a quarter more time."""


def rim_points(outline_m: FloatArray, count: int = RIM_POINTS) -> FloatArray:
    """Reduce a convex outline to corners that keep most of its area.

    Args:
      outline_m: (points, 2) corners in order.
      count: how many corners to keep; fewer if the outline has fewer.

    Returns:
      (count, 2) corners [m], after removing one by one the corner that costs the least
      area.
    """
    corners = outline_m
    while len(corners) > count:
        before, after = np.roll(corners, 1, axis=0), np.roll(corners, -1, axis=0)
        (ax, ay), (bx, by) = (corners - before).T, (after - before).T
        triangle = np.abs(ax * by - ay * bx)
        corners = np.delete(corners, int(np.argmin(triangle)), axis=0)
    return corners


def contact_points(foot: Foot) -> FloatArray:
    """(points, 2) contact points [m]: the sole's rim and two places on its midline.

    The two in the middle let a foot rock on a crest; on level ground they add nothing.
    """
    low, high = foot.outline_m.min(axis=0), foot.outline_m.max(axis=0)
    middle = low + np.array([[1 / 3, 1 / 2], [2 / 3, 1 / 2]]) * (high - low)
    return np.vstack([rim_points(foot.outline_m), middle])


def sensor_shares(sensors_m: FloatArray, points_m: FloatArray) -> FloatArray:
    """How a force at each point of a stiff sole is shared by its sensors.

    The sole is a stiff plate on four equal springs, so that the share of sensor i
    is linear in place, w_i = a + b.(s_i - c) with the springs' centre c. Force and
    moments balance: sum w_i = 1 and sum w_i s_i = p, which gives
    w_i = 1/4 + (s_i - c)^T S^-1 (p - c) with S = sum (s_i - c)(s_i - c)^T.
    A point beyond the springs has negative shares: the plate tips, and a sensor
    reads nothing where the sum over all points is negative.

    Args:
      sensors_m: (4, 2) the sensors' places.
      points_m: (points, 2) where forces act.

    Returns:
      (points, 4) shares, each row adding up to one.
    """
    centre = sensors_m.mean(axis=0)
    arms = sensors_m - centre
    spread = np.linalg.inv(arms.T @ arms)
    shares = 1 / len(sensors_m) + (points_m - centre) @ spread @ arms.T
    return np.asarray(shares)


def contact_shares(foot: Foot) -> FloatArray:
    """(contact points, 4): how a force at each contact point reaches the sensors."""
    return sensor_shares(foot.sensors_m, contact_points(foot))

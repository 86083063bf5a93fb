"""Contact points of a sole, and the shares of their forces in the foot's sensors."""

import numpy as np

from groundwalk.arrays import FloatArray
from robots.description import Foot

CONTACT_RADIUS_M = 0.01
"""Radius [m] of the spheres under a sole that touch the ground. In Bullet, spheres of
3 mm sank through the ground and stuck there."""

FRICTION = 0.8
"""Friction coefficient of plastic soles on carpet. No measurement is known; the NAO's
simulators use 0.5 to 1."""

RIM_POINTS = 10
"""Number of contact points on a sole's rim: on the NAO ten keep 98 % of the area; all
fifteen corners need a quarter more computing time."""


def rim_points(outline_m: FloatArray, count: int = RIM_POINTS) -> FloatArray:
    """Reduce a convex outline (points, 2) [m] to `count` corners with most of its area.

    The corner whose removal costs the least area is removed again and again.
    """
    corners = outline_m
    while len(corners) > count:
        before, after = np.roll(corners, 1, axis=0), np.roll(corners, -1, axis=0)
        (ax, ay), (bx, by) = (corners - before).T, (after - before).T
        triangle = np.abs(ax * by - ay * bx)
        corners = np.delete(corners, int(np.argmin(triangle)), axis=0)
    return corners


def contact_points(foot: Foot) -> FloatArray:
    """(points, 2) contact points of a sole [m]: up to ten on its rim, two inside.

    The two inside lie on the midline. They let a foot rock on a crest of the ground; on
    level ground they have no effect.
    """
    low, high = foot.outline_m.min(axis=0), foot.outline_m.max(axis=0)
    middle = low + np.array([[1 / 3, 1 / 2], [2 / 3, 1 / 2]]) * (high - low)
    return np.vstack([rim_points(foot.outline_m), middle])


def sensor_shares(sensors_m: FloatArray, points_m: FloatArray) -> FloatArray:
    """(points, 4) shares of a foot's sensors in a vertical force at points (points, 2).

    The sole is a stiff plate on four equal springs at the sensors' positions s_i (4, 2)
    [m], so that the share of a sensor is linear in its position, w_i = a + b.(s_i - c)
    with the centre c of the springs. Force and moments at a point p balance: sum w_i =
    1 and sum w_i s_i = p, which gives w_i = 1/4 + (s_i - c)^T S^-1 (p - c) with S = sum
    (s_i - c)(s_i - c)^T. A point outside of the springs has negative shares, as the
    plate tips; a sensor whose sum over all points is negative should read 0.
    """
    centre = sensors_m.mean(axis=0)
    arms = sensors_m - centre
    spread = np.linalg.inv(arms.T @ arms)
    shares = 1 / len(sensors_m) + (points_m - centre) @ spread @ arms.T
    return np.asarray(shares)


def contact_shares(foot: Foot) -> FloatArray:
    """(contact points, 4) shares of a foot's sensors in a force at each point."""
    return sensor_shares(foot.sensors_m, contact_points(foot))

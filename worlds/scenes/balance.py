"""A robot's balance: centre of mass, loaded feet and zero-moment point (ZMP).

Three points on the ground describe a walk's balance:

- the centre of pressure, *measured*: the mean of the force sensors' places, weighted
  by their forces. It is always on the soles.
- the zero-moment point, *from the motion*: where the ground's force must act for links
  of these masses to have moved as they did (Vukobratovic and Borovac 2004). It needs
  the base's pose. With both soles flat on level ground it is the centre of pressure.
  If it is outside of the support polygon, the robot tips about the polygon's edge.
- the centre of mass, projected along the vertical.

All are in the world frame; a base that was not recorded is at the origin, upright.
"""

from typing import NamedTuple

import numpy as np
from scipy.ndimage import gaussian_filter1d
from scipy.spatial import ConvexHull

from groundwalk.arrays import BoolArray, FloatArray
from groundwalk.gravity import GRAVITY_M_S2
from robots.description import Description
from worlds.scenes.scene import SIDES, LinkPoses, Scene

LOADED_PART = 0.05
"""A foot counts as loaded if its force exceeds this share of the robot's weight."""

SMOOTHING_TICKS = 2.0
"""Standard deviation [ticks of 10 ms] of the Gaussian that smooths positions and
momenta before they are differentiated: 20 ms."""

LEAST_WEIGHT_PART = 0.2
"""Least ground force, as a share of the robot's weight, for which the ZMP is
computed; its formula divides by that force."""


class Balance(NamedTuple):
    """Balance points (ticks, 3) of a robot in the world frame; NaN where unknown.

    The point `below_m` is the centre of mass, moved down to the height of the lowest
    sole. Measured centre of pressure and support polygons (corners, 3), which have no
    corners while no foot is loaded, are None without force sensors; the zero-moment
    point is None without a recorded base position.
    """

    centre_of_mass_m: FloatArray
    below_m: FloatArray
    pressure_m: FloatArray | None
    zmp_m: FloatArray | None
    polygons_m: list[FloatArray] | None


def balance(scene: Scene) -> Balance:
    """Compute the balance points of a scene's robot at all ticks."""
    poses = scene.link_poses()
    soles_m = {side: _sole(scene, side, poses) for side in SIDES}
    lowest_m = np.min([sole[..., 2].min(axis=1) for sole in soles_m.values()], axis=0)
    mass_kg, places_m = _centres(scene.description, poses)
    centre_m = np.average(places_m, axis=0, weights=mass_kg)
    below_m = np.column_stack([centre_m[:, :2], lowest_m])
    loaded = loaded_feet(scene)
    has_base = scene.recording.has("base.position")
    return Balance(
        centre_of_mass_m=centre_m,
        below_m=below_m,
        pressure_m=_pressure(scene, poses),
        zmp_m=_zmp(scene, poses, lowest_m) if has_base else None,
        polygons_m=None if loaded is None else _polygons(soles_m, loaded),
    )


def loaded_feet(scene: Scene) -> dict[str, BoolArray] | None:
    """(ticks,) by side whether a foot carries weight; None without force sensors."""
    least_n = LOADED_PART * scene.description.mass_kg * GRAVITY_M_S2
    forces_n = {side: scene.foot_force_n(side) for side in SIDES}
    known = {side: force for side, force in forces_n.items() if force is not None}
    if len(known) < len(SIDES):
        return None
    return {side: force > least_n for side, force in known.items()}


def _pressure(scene: Scene, poses: dict[str, LinkPoses]) -> FloatArray | None:
    """(ticks, 3) centre of pressure sum(F_i p_i) / sum(F_i) [m]; NaN if unloaded."""
    moment: FloatArray | float = 0.0
    force: FloatArray | float = 0.0
    for side in SIDES:
        sensors = scene.sensor_forces_n(side)
        if sensors is None:
            return None
        points_m, forces_n = sensors
        pressing_n = np.maximum(forces_n, 0.0)[..., np.newaxis]
        moment = moment + (pressing_n * _on_foot(scene, side, poses, points_m)).sum(1)
        force = force + pressing_n.sum(axis=1)
    least_n = LOADED_PART * scene.description.mass_kg * GRAVITY_M_S2
    return np.asarray(moment) / np.where(np.asarray(force) > least_n, force, np.nan)


def _polygons(
    soles_m: dict[str, FloatArray], loaded: dict[str, BoolArray]
) -> list[FloatArray]:
    """For each tick the (corners, 3) hull, seen from above, of the loaded soles [m]."""
    polygons = []
    for tick in range(len(soles_m[SIDES[0]])):
        soles = [soles_m[side][tick] for side in SIDES if loaded[side][tick]]
        corners = np.vstack([np.empty((0, 3)), *soles])
        if soles and np.isfinite(corners).all():
            polygons.append(corners[ConvexHull(corners[:, :2]).vertices])
        else:
            polygons.append(np.empty((0, 3)))
    return polygons


def _sole(scene: Scene, side: str, poses: dict[str, LinkPoses]) -> FloatArray:
    """(ticks, corners, 3) outline of a sole in the world frame [m]."""
    foot = scene.description.feet[SIDES.index(side)]
    height_m = np.full((len(foot.outline_m), 1), foot.sole_height_m)
    return _on_foot(scene, side, poses, np.hstack([foot.outline_m, height_m]))


def _on_foot(
    scene: Scene, side: str, poses: dict[str, LinkPoses], points_m: FloatArray
) -> FloatArray:
    """(ticks, points, 3) world places of points (points, 3) in a foot's frame [m]."""
    robot = scene.description
    foot = robot.feet[SIDES.index(side)]
    return poses[robot.links[foot.joint].link.name].points(points_m)


def _centres(
    robot: Description, poses: dict[str, LinkPoses]
) -> tuple[FloatArray, FloatArray]:
    """(links,) masses [kg] and (links, ticks, 3) centres of mass in the world [m]."""
    links = [robot.root, *(joint.link for joint in robot.links)]
    places_m = [
        poses[link.name].points(link.inertial.com_m[np.newaxis])[:, 0] for link in links
    ]
    return np.array([link.inertial.mass_kg for link in links]), np.array(places_m)


def _zmp(scene: Scene, poses: dict[str, LinkPoses], height_m: FloatArray) -> FloatArray:
    """(ticks, 3) zero-moment point [m], at the heights `height_m` (ticks,).

    The ground's force must act there for the recorded motion. With momentum P, angular
    momentum L about the world's origin, mass M and centre of mass c, the ground's force
    is F = dP/dt + M g e_z and its moment about the origin N = dL/dt + M c x g e_z. Its
    moment about the ZMP p has no horizontal part: (N - p x F)_xy = 0, so
    p_x = (p_z F_x - N_y) / F_z and p_y = (p_z F_y + N_x) / F_z.
    """
    robot, time_s = scene.description, scene.recording.time_s
    if time_s.size < 2:
        return np.full((time_s.size, 3), np.nan)
    mass_kg, places_m = _centres(robot, poses)
    weight = np.array([0.0, 0.0, mass_kg.sum() * GRAVITY_M_S2])
    centre_m = np.average(places_m, axis=0, weights=mass_kg)
    momentum, angular = _momenta(robot, poses, places_m, time_s)
    force = _rate(momentum, time_s) + weight
    moment = _rate(angular, time_s) + np.cross(centre_m, weight)
    pressing = np.where(
        force[:, 2] > LEAST_WEIGHT_PART * weight[2], force[:, 2], np.nan
    )
    x_m = (height_m * force[:, 0] - moment[:, 1]) / pressing
    y_m = (height_m * force[:, 1] + moment[:, 0]) / pressing
    return np.stack([x_m, y_m, height_m], axis=1)


def _momenta(
    robot: Description,
    poses: dict[str, LinkPoses],
    places_m: FloatArray,
    time_s: FloatArray,
) -> tuple[FloatArray, FloatArray]:
    """(ticks, 3) momentum [kg m/s] and angular momentum about the origin [kg m^2/s].

    They follow from the links' poses and centres of mass `places_m` (links, ticks, 3).
    """
    momentum = angular = np.zeros((time_s.size, 3))
    # Rotor inertias are added to the links, as in both worlds' models.
    moved = [(joint.link.name, joint.moved_inertial) for joint in robot.links]
    links = [(robot.root.name, robot.root.inertial), *moved]
    for (name, inertial), place_m in zip(links, places_m, strict=True):
        axes = poses[name].axes()
        own = inertial.mass_kg * _rate(place_m, time_s)
        momentum = momentum + own
        # dR/dt R^T is the cross product matrix of the angular velocity.
        spin = _rate(axes.reshape(-1, 9), time_s).reshape(-1, 3, 3) @ axes.mT
        turning = np.stack([spin[:, 2, 1], spin[:, 0, 2], spin[:, 1, 0]], axis=1)
        inertia = axes @ inertial.inertia_kg_m2 @ axes.mT
        angular = angular + np.cross(place_m, own)
        angular = angular + np.einsum("tij,tj->ti", inertia, turning)
    return momentum, angular


def _rate(values: FloatArray, time_s: FloatArray) -> FloatArray:
    """Smoothed time derivative of values (ticks, k); NaN in the 6 ticks at each end."""
    smooth = gaussian_filter1d(values, SMOOTHING_TICKS, axis=0, truncate=3.0)
    rate = np.gradient(smooth, time_s, axis=0)
    margin = int(3.0 * SMOOTHING_TICKS)
    rate[:margin] = rate[-margin:] = np.nan
    return np.asarray(rate)

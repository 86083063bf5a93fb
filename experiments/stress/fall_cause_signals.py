"""Signals of a walk at each tick, computed from its recording: feet, load, balance."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.spatial.transform import Rotation

from experiments.stress.families import leg_length_m
from groundwalk.arrays import BoolArray, FloatArray
from groundwalk.gravity import GRAVITY_M_S2
from robots.sole import contact_points
from worlds.recordings.recording import SUPPORT
from worlds.scenes.scene import LinkPoses, Scene, link_poses


@dataclass(frozen=True, eq=False)
class Signals:
    """Signals of a recorded walk as arrays over its ticks; feet in order left, right.

    The recording must have base pose, commands, foot forces and support leg; a signal
    whose column it lacks raises an UnknownNameError.
    """

    scene: Scene

    @cached_property
    def leg_m(self) -> float:
        """Length of a straight leg from hip to sole [m]."""
        return leg_length_m(self.scene.description)

    @cached_property
    def pendulum_s(self) -> float:
        """Time scale of tipping over a leg [s]: sqrt(leg length / gravity)."""
        return float(np.sqrt(self.leg_m / GRAVITY_M_S2))

    @cached_property
    def time_s(self) -> FloatArray:
        """(ticks,) time of every tick [s]."""
        return self.scene.recording.time_s

    @cached_property
    def tick_s(self) -> float:
        """Median time from one tick to the next [s]."""
        return float(np.median(np.diff(self.time_s)))

    def ticks_in(self, duration_s: float) -> int:
        """Number of ticks in a duration, at least one."""
        return max(1, round(duration_s / self.tick_s))

    @cached_property
    def load(self) -> FloatArray:
        """(ticks, 2) force on each foot as a share of the robot's weight."""
        weight_n = self.scene.description.mass_kg * GRAVITY_M_S2
        return self.scene.recording.vector("foot_force") / weight_n

    @cached_property
    def swings(self) -> BoolArray:
        """(ticks, 2) whether each foot should swing according to the walk engine."""
        support = self.scene.recording.columns[SUPPORT]
        return np.stack([support < 0, support > 0], axis=1)

    @cached_property
    def soles_m(self) -> FloatArray:
        """(ticks, 2, points, 3) world positions of both soles' contact points [m]."""
        return self._soles(self.scene.link_poses())

    @cached_property
    def commanded_m(self) -> FloatArray:
        """(ticks, 2, points, 3) soles' points [m] if the joints were as commanded."""
        recording, robot = self.scene.recording, self.scene.description
        base = LinkPoses(
            recording.vector("base.position"), recording.vector("base.orientation")
        )
        poses = link_poses(robot, recording.joint_values("command", robot.joints), base)
        return self._soles(poses)

    @cached_property
    def clearance_m(self) -> FloatArray:
        """(ticks, 2, points) heights of the soles' points above the ground [m]."""
        return self.soles_m[..., 2] - self.ground_m(self.soles_m[..., :2])

    @cached_property
    def heading(self) -> FloatArray:
        """(ticks, 2) horizontal unit vectors in the direction that the torso faces."""
        ahead = self._torso.apply([1.0, 0.0, 0.0])[:, :2]
        return np.asarray(ahead / np.linalg.norm(ahead, axis=1, keepdims=True))

    @cached_property
    def lean(self) -> FloatArray:
        """(ticks, 2) forward and left components of the torso's unit up vector."""
        up, heading = self._torso.apply([0.0, 0.0, 1.0]), self.heading
        left = np.stack([-heading[:, 1], heading[:, 0]], axis=1)
        return np.stack(
            [np.sum(up[:, :2] * heading, axis=1), np.sum(up[:, :2] * left, axis=1)],
            axis=1,
        )

    @cached_property
    def tilt_rad(self) -> FloatArray:
        """(ticks,) angle between the torso's up axis and the vertical [rad]."""
        up_z = self._torso.apply([0.0, 0.0, 1.0])[:, 2]
        return np.asarray(np.arccos(np.clip(up_z, -1.0, 1.0)))

    def ground_m(self, places_m: FloatArray) -> FloatArray:
        """(...) heights of the ground [m] at x, y (..., 2); 0 if it is unknown."""
        ground = self.scene.ground
        if ground is None:
            return np.zeros(places_m.shape[:-1])
        return ground.height_at(places_m[..., 0], places_m[..., 1])

    @cached_property
    def _torso(self) -> Rotation:
        orientation = self.scene.recording.vector("base.orientation")
        return Rotation.from_quat(orientation, scalar_first=True)

    def _soles(self, poses: dict[str, LinkPoses]) -> FloatArray:
        robot = self.scene.description
        soles = []
        for foot in robot.feet:
            pose = poses[robot.links[foot.joint].link.name]
            turn = Rotation.from_quat(pose.orientation, scalar_first=True).as_matrix()
            points = contact_points(foot)
            flat = np.c_[points, np.full(len(points), foot.sole_height_m)]
            soles.append(pose.position_m[:, None] + flat @ np.swapaxes(turn, 1, 2))
        return np.stack(soles, axis=1)

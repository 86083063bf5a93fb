"""Computes the torso height at which a robot in a given pose stands on its ground."""

from collections.abc import Sequence

import numpy as np

from groundwalk.arrays import FloatArray
from robots.description import Description
from robots.sole import contact_points
from terrain import Heightfield
from worlds.sim.model import ROOT_QPOS, mujoco_model
from worlds.world import WorldOptions


class StartHeight:
    """Finds the torso height at which an upright robot's lower sole just touches."""

    def __init__(self, description: Description) -> None:
        """Compile a MuJoCo model of the robot for forward kinematics."""
        import mujoco

        self._mujoco = mujoco
        self._model = mujoco_model(description, WorldOptions(), None)
        self._data = mujoco.MjData(self._model)
        self._data.qpos[:ROOT_QPOS] = [0, 0, 0, 1, 0, 0, 0]
        self._soles: list[tuple[int, FloatArray]] = []
        for foot in description.feet:
            points = contact_points(foot)
            height = np.full((len(points), 1), foot.sole_height_m)
            link = description.links[foot.joint].link.name
            self._soles.append((self._model.body(link).id, np.hstack([points, height])))

    def heights_m(
        self, pose_rad: FloatArray, grounds: Sequence[Heightfield]
    ) -> FloatArray:
        """(n,) heights [m] of the torsos above the origin, in poses (n, joints)."""
        places = zip(pose_rad, grounds, strict=True)
        return np.array([self._height_m(pose, ground) for pose, ground in places])

    def _height_m(self, pose_rad: FloatArray, ground: Heightfield) -> float:
        data = self._data
        data.qpos[ROOT_QPOS:] = pose_rad
        self._mujoco.mj_kinematics(self._model, data)
        soles_m = [
            data.xpos[body] + points_m @ data.xmat[body].reshape(3, 3).T
            for body, points_m in self._soles
        ]
        x_m, y_m, z_m = np.vstack(soles_m).T
        return float(np.max(ground.height_at(x_m, y_m) - z_m))

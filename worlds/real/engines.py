"""MuJoCo and PyBullet for robots with hidden effects, physics that the sim lacks."""

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from groundwalk.arrays import FloatArray
from robots.engine_models.model_urdf import model_urdf
from terrain import Heightfield
from worlds.hidden.effects.placed import Hidden
from worlds.hidden.engine import BodySense, HiddenEngine, check_engine
from worlds.hidden.model import hidden_model
from worlds.hidden.mujoco_engine import HiddenMujoco
from worlds.hidden.plant import HiddenPlant
from worlds.real.body import BulletBody

if TYPE_CHECKING:
    import mujoco


def hidden_engine(
    name: str,
    plant: HiddenPlant,
    effects: Sequence[Hidden],
    step_s: float,
    ground: Heightfield | None,
) -> HiddenEngine:
    """Make the engine "bullet" or "mujoco" and load a robot with effects into it.

    `ground` is that under a floating robot; None for a fixed base.

    Raises:
      GroundwalkError: the engine cannot compute an effect, or the robot does not have
        an effect's place.
    """
    check_engine(name, effects)
    model = hidden_model(plant, effects, step_s, ground)
    if name == "mujoco":
        return HiddenMujoco(plant, model)
    return HiddenBullet(plant, model, effects, ground)


class HiddenBullet(BulletBody):
    """A robot with hidden effects in PyBullet, with the methods of `HiddenEngine`.

    It is made from a MuJoCo model that has the effects on masses and gravity, so that
    both engines compute the same bodies under the same gravity.
    """

    def __init__(
        self,
        plant: HiddenPlant,
        model: "mujoco.MjModel",
        effects: Sequence[Hidden],
        ground: Heightfield | None,
    ) -> None:
        """Load robot and ground from the model; soft ground comes from the effects."""
        soles = np.flatnonzero(model.geom_contype == 1)
        spring = None
        if plant.description is not None:
            for effect in effects:
                found = effect.kind.foot_spring(effect.values, plant.description)
                spring = found or spring
        super().__init__(
            model_urdf(model, plant.name),
            plant.joints,
            plant.description,
            floating=plant.floating,
            step_s=float(model.opt.timestep),
            gravity_m_s2=model.opt.gravity.copy(),
            friction=float(model.geom_friction[soles[0], 0]) if soles.size else 0.0,
            spring=spring,
            ground=ground,
        )
        self._forget()

    def _forget(self) -> None:
        self._watched, self._feet = 0, np.zeros(8)
        self._earlier: FloatArray | None = None

    def watch(self) -> None:
        """Add this step's foot forces to the mean that `sense` will return."""
        if not self._floating:
            return
        if self._earlier is None:
            self._earlier = self.base_motion()[1]
        self._watched += 1
        self._feet += self.foot_forces()

    def sense(self) -> BodySense:
        """Read the sensors, averaged over the watched steps; forget those steps."""
        if not self._floating:
            zero, up = np.zeros(3), np.array([1.0, 0.0, 0.0, 0.0])
            felt = -self._gravity_m_s2 if self._description else zero
            return BodySense(zero, felt, np.zeros(8), zero, up, zero, zero)
        pose, now = self.base_motion()
        earlier = now if self._earlier is None else self._earlier
        seconds = max(self._watched - 1, 1) * self._step_s
        felt = self.specific_force(pose, earlier, now, seconds)
        feet = np.maximum(self._feet / max(self._watched, 1), 0.0)
        self._forget()
        return BodySense(now[3:], felt, feet, pose[:3], pose[3:], now[:3], now[3:])

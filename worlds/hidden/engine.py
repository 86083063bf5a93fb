"""What a hidden world asks of a physics engine."""

from collections.abc import Sequence
from typing import Protocol

import numpy as np

from groundwalk.arrays import FloatArray
from groundwalk.errors import BadValueError
from terrain import Heightfield
from worlds.hidden.body_sense import BodySense
from worlds.hidden.effects import Hidden
from worlds.hidden.model import hidden_model
from worlds.hidden.plant import HiddenPlant

WATCH_STEPS = 8
"""Forces and accelerations are means over so many fine steps."""


class HiddenEngine(Protocol):
    """One robot under joint torques, a fine step at a time."""

    position_rad: FloatArray
    velocity_rad_s: FloatArray

    def reset(self, pose_rad: FloatArray, height_m: float) -> None:
        """Put the robot at rest; a floating base upright at a height."""

    def step(self, torque_nm: FloatArray) -> None:
        """One fine step under (j,) torques and the pushes since the last step."""

    def push(self, body: str, force_n: FloatArray) -> None:
        """Let a force (3,) act at a body's centre of mass over the next step."""

    def body_velocity(self, body: str) -> FloatArray:
        """(3,) velocity of a body's centre of mass [m/s]."""

    def watch(self) -> None:
        """Take the sensors in; called after each of the last steps of a row."""

    def sense(self) -> BodySense:
        """What the sensors say, as a mean of what was watched since last asked."""

    def close(self) -> None:
        """Give back memory."""


def hidden_engine(
    name: str,
    plant: HiddenPlant,
    effects: Sequence[Hidden],
    step_s: float,
    ground: Heightfield | None,
) -> HiddenEngine:
    """An engine with the robot in it.

    Raises:
      BadValueError: the engine does not know one of the effects.
    """
    from worlds.hidden.mujoco_engine import HiddenMujoco
    from worlds.real.bullet_engine import HiddenBullet

    check_engine(name, effects)
    model = hidden_model(plant, effects, step_s, ground)
    if name == "mujoco":
        return HiddenMujoco(plant, model)
    return HiddenBullet(plant, model, effects, ground)


def check_engine(name: str, effects: Sequence[Hidden]) -> None:
    """Refuse what an engine does not know.

    Raises:
      BadValueError: it is no engine, or has not one of the effects.
    """
    names = {effect.name for effect in effects}
    if name not in ("bullet", "mujoco"):
        raise BadValueError(f"engine is {name!r}; it must be bullet or mujoco")
    if name == "mujoco" and "contact_compliance" in names:
        raise BadValueError("contact_compliance is hidden in bullet only")
    if name == "bullet" and "armature" in names:
        raise BadValueError("armature is hidden in mujoco only; Bullet has none")


def least_inertia_kg_m2(
    plant: HiddenPlant, poses_rad: Sequence[FloatArray]
) -> FloatArray:
    """(j,) what a torque at each joint accelerates, all others free; the least.

    Args:
      plant: the nominal robot.
      poses_rad: (j,) poses that it takes.
    """
    import mujoco

    model = plant.make_spec().compile()
    data = mujoco.MjData(model)
    free = 7 if plant.floating else 0
    least = np.full(len(plant.joints), np.inf)
    for pose in poses_rad:
        data.qpos[free:] = pose
        mujoco.mj_forward(model, data)
        mass = np.zeros((model.nv, model.nv))
        mujoco.mj_fullM(model, data, mass)
        inverse = np.diag(np.linalg.inv(mass))[-len(plant.joints) :]
        least = np.minimum(least, 1.0 / inverse)
    return least

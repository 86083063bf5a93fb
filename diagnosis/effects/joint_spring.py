"""A cable or spring that pulls a joint towards some angle."""

from typing import TYPE_CHECKING

import numpy as np

from diagnosis.effects._places import JointEffect
from diagnosis.effects._sizes import range_rad, torque_nm
from diagnosis.effects.effect import Parameter
from groundwalk.arrays import FloatArray

if TYPE_CHECKING:
    from diagnosis.effects.variants import Variants
    from diagnosis.plant.plant import Plant


class JointSpring(JointEffect):
    """Torque -k (q - rest).

    Source: Hooke 1678. In MuJoCo `jnt_stiffness` and `qpos_spring`.
    """

    name = "joint_spring"
    native = True

    def parameters(self, plant: "Plant", place: str) -> tuple[Parameter, ...]:
        """Stiffness k and rest; tried first at rest in the reference pose."""
        scale = torque_nm(plant, place)
        low, high = range_rad(plant, place)
        reference = plant.model.qpos0[plant.qpos[plant.joints.index(place)]]
        rest = float(np.clip(reference, low, high))
        return (
            Parameter("stiffness", "N m/rad", 0.0, 5 * scale, 0.0, 0.2 * scale),
            Parameter("rest", "rad", low, high, rest, rest),
        )

    def apply(
        self, variants: "Variants", row: int, place: str, values: FloatArray
    ) -> None:
        """Two springs are one: stiffnesses add, rests average by stiffness."""
        stiffness, rest = values
        if stiffness == 0:
            return
        joint = variants.plant.model.joint(place).id
        qpos = variants.plant.qpos[variants.column(place)]
        stiffnesses = variants.field("jnt_stiffness")
        rests = variants.field("qpos_spring")
        total = stiffnesses[row, joint] + stiffness
        rests[row, qpos] += stiffness / total * (rest - rests[row, qpos])
        stiffnesses[row, joint] = total

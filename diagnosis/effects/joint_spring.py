"""The effect joint spring: a cable or spring pulls a joint towards some angle."""

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from diagnosis.effects.bases import JointEffect
from diagnosis.effects.parts import (
    EffectWords,
    Interval,
    JointMotion,
    Parameter,
    Values,
)
from diagnosis.effects.scales import range_rad, torque_nm
from groundwalk.arrays import FloatArray

if TYPE_CHECKING:
    from diagnosis.effects.variants import Variants
    from diagnosis.plant.plant import Plant
    from diagnosis.traces.usage import Usage


class JointSpring(JointEffect):
    """Torque -k (q - rest) at joint angle q.

    Source: Hooke 1678. In MuJoCo `jnt_stiffness` and `qpos_spring`.
    """

    name = "joint_spring"
    native = True
    main_parameters = ("stiffness",)
    words = EffectWords(
        "spring at a joint",
        "{joint} has a spring of {stiffness} that pulls to {rest}, {lacking}",
        "A cable, a hose or a return spring pulls the joint to one angle.",
    )

    def parameters(self, plant: "Plant", place: str) -> tuple[Parameter, ...]:
        """Stiffness k [N m/rad] and rest angle [rad], first the reference pose's."""
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
        """Merge the spring with any other at the joint in one variant of the model.

        Stiffnesses are added; rest angles are averaged, weighted by stiffness.
        """
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

    def first_tries(
        self,
        plant: "Plant",
        place: str,
        usage: "Usage",
        intervals: Sequence[Interval],
    ) -> list[Values]:
        """Springs with rest angles in the middle and at both ends of the motion."""
        column = plant.joints.index(place)
        low, high = usage.low_rad[column], usage.high_rad[column]
        stiffness = self.parameters(plant, place)[0].typical
        return [(stiffness, rest) for rest in ((low + high) / 2, low, high)]

    def torque_column(self, motion: JointMotion) -> FloatArray:
        """(rows,) joint angle; the rest angle adds a constant torque of its own."""
        return motion.position_rad

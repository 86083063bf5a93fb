"""A servo that brakes more or less than the model says."""

from collections.abc import Sequence
from typing import TYPE_CHECKING

from diagnosis.effects._places import JointEffect, joints_where
from diagnosis.effects.effect import Parameter
from groundwalk.arrays import FloatArray

if TYPE_CHECKING:
    from diagnosis.effects.variants import Variants
    from diagnosis.plant.plant import Plant
    from diagnosis.traces.trace import Trace


class ServoDamping(JointEffect):
    """Torque = ... - factor (kd + back-EMF) v.

    Source: derivative part of a position loop and the motor's induced voltage, Spong,
    Hutchinson and Vidyasagar 2006, "Robot modeling and control", chapter 6. In
    MuJoCo `actuator_biasprm` and `dof_damping`.
    """

    name = "servo_damping"
    native = True

    def places(self, plant: "Plant", traces: Sequence["Trace"]) -> tuple[str, ...]:
        """Joints whose servo has damping that a factor can change, in any trace."""
        servos = [trace.servo for trace in traces] or [plant.servo]
        damping = [one.kd_nm_s_rad + one.back_emf_nm_s_rad for one in servos]
        return joints_where(plant, [values > 0 for values in damping])

    def parameters(self, plant: "Plant", place: str) -> tuple[Parameter, ...]:
        """The factor."""
        return (Parameter("factor", "1", 0.05, 20.0, 1.0, 1.5, logarithmic=True),)

    def apply(
        self, variants: "Variants", row: int, place: str, values: FloatArray
    ) -> None:
        """Factors multiply."""
        variants.joints.damping_factor[row, variants.column(place)] *= values[0]

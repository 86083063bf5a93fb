"""Base classes of effects that share a kind of place."""

from abc import abstractmethod
from collections.abc import Sequence
from typing import TYPE_CHECKING, ClassVar

import numpy as np

from diagnosis.effects.effect import Effect
from diagnosis.effects.parts import PlaceKind
from groundwalk.arrays import BoolArray, FloatArray

if TYPE_CHECKING:
    from diagnosis.effects.variants import Variants
    from diagnosis.plant.plant import Plant
    from diagnosis.traces.trace import Trace


class JointEffect(Effect):
    """An effect that may be at any joint.

    Example:
      See docs/python.md, "An effect of your own".
    """

    place_kind: ClassVar[PlaceKind] = "joint"

    def places(self, plant: "Plant", traces: Sequence["Trace"]) -> tuple[str, ...]:
        """All joints of the plant."""
        return plant.joints


class ServoEffect(JointEffect):
    """An effect that may be at joints that a servo holds with some stiffness.

    Example:
      See docs/python.md, "An effect of your own".
    """

    def places(self, plant: "Plant", traces: Sequence["Trace"]) -> tuple[str, ...]:
        """Joints whose servo has a stiffness above 0, in any of the traces."""
        servos = [trace.servo for trace in traces] or [plant.servo]
        return joints_where(plant, [servo.kp_nm_rad > 0 for servo in servos])


class JointNumber(JointEffect):
    """An effect whose one value changes one number of a joint.

    Attributes:
      array: the number: an array of `Joints`, or a field of MuJoCo's model with a value
        for each degree of freedom, such as "dof_damping".
      combined: how the value is combined with the number that is there.
    """

    array: ClassVar[str]
    combined: ClassVar[np.ufunc] = np.add

    def apply(
        self, variants: "Variants", row: int, place: str, values: FloatArray
    ) -> None:
        """Combine the effect's value with what is there."""
        if self.array in vars(variants.joints):
            numbers = vars(variants.joints)[self.array]
            at = row, variants.column(place)
        else:
            numbers, at = variants.field(self.array), (row, variants.dof(place))
        numbers[at] = self.combined(numbers[at], values[0])


class ServoNumber(JointNumber, ServoEffect):
    """A `JointNumber` of joints that a servo holds with some stiffness."""


class TorqueEffect(JointEffect):
    """A torque at a joint, computed at every step by the effect itself.

    The way to physics that neither MuJoCo nor the replay knows: `torque_nm` is the law.

    Example:
      See docs/python.md, "An effect of your own".
    """

    native: ClassVar[bool] = False

    def apply(
        self, variants: "Variants", row: int, place: str, values: FloatArray
    ) -> None:
        """Note the values; those of several effects at one joint are added.

        A law that is not linear in its values has to override this.
        """
        noted = variants.torque_values(self, len(values))
        noted[row, variants.column(place)] += values

    @abstractmethod
    def torque_nm(
        self,
        values: FloatArray,
        position_rad: FloatArray,
        velocity_rad_s: FloatArray,
        time_s: FloatArray,
    ) -> FloatArray:
        """Torques (rows, j) [N m] at all joints of all simulations for one step.

        Args:
          values: (rows, j, p) the effect's values; all 0 where it is absent, where the
            torque must be 0.
          position_rad: (rows, j) as the step begins.
          velocity_rad_s: (rows, j) as the step begins.
          time_s: (rows, 1) time of the recording.
        """


class BodyEffect(Effect):
    """An effect that may be at any body that has mass, a name, and moves.

    Example:
      See docs/python.md, "An effect of your own".
    """

    place_kind: ClassVar[PlaceKind] = "body"

    def places(self, plant: "Plant", traces: Sequence["Trace"]) -> tuple[str, ...]:
        """Names of the bodies; a body without a name cannot be a place."""
        return tuple(name for name in plant.bodies if name)


def joints_where(plant: "Plant", masks: Sequence[BoolArray]) -> tuple[str, ...]:
    """Names of the joints for which any of some masks (j,) is true."""
    found = np.flatnonzero(np.any(masks, axis=0))
    return tuple(plant.joints[column] for column in found)

"""Base classes of effects by where they are, and by what they change."""

from abc import abstractmethod
from collections.abc import Sequence
from typing import ClassVar

import numpy as np

from diagnosis.effects.effect import Effect
from diagnosis.effects.parts import Parameter, PlaceKind
from diagnosis.effects.places import joints_where
from diagnosis.effects.variants import Variants
from diagnosis.plant.plant import Plant
from diagnosis.traces.trace import Trace, asked
from groundwalk.arrays import FloatArray


class JointEffect(Effect):
    """An effect that may be at any joint."""

    place_kind: ClassVar[PlaceKind] = "joint"

    def places(self, plant: Plant, traces: Sequence[Trace]) -> tuple[str, ...]:
        """Names of all joints of the robot model."""
        return plant.joints


class ServoEffect(JointEffect):
    """An effect that may be at joints whose servo has a stiffness above 0."""

    def places(self, plant: Plant, traces: Sequence[Trace]) -> tuple[str, ...]:
        """Names of joints whose servo has a stiffness above 0 in any recording."""
        servos = [trace.servo for trace in traces] or [plant.servo]
        return joints_where(plant, [servo.kp_nm_rad > 0 for servo in servos])


class CommandedServo(ServoEffect):
    """An effect that changes how servos follow position commands."""

    def places(self, plant: Plant, traces: Sequence[Trace]) -> tuple[str, ...]:
        """Names of joints with a servo, if a recording has position commands.

        None if only the torque is compared for which servos ask: any motion that does
        not follow its commands would look like such an effect.
        """
        if asked(traces) or all(trace.command_rad is None for trace in traces):
            return ()
        return super().places(plant, traces)


class BodyEffect(Effect):
    """An effect that may be at any body that has a name and mass, and can move."""

    place_kind: ClassVar[PlaceKind] = "body"

    def places(self, plant: Plant, traces: Sequence[Trace]) -> tuple[str, ...]:
        """Names of the bodies that have mass and can move."""
        return tuple(name for name in plant.bodies if name)


class NumberEffect(Effect):
    """An effect that changes one number, or one vector, of its place.

    Attributes:
      quantity: what the effect changes, see `Variants.at`.
      combined: function of the quantity and the effect's values that gives the new
        quantity.
      usual: the effect's parameters, if they are the same for all robots and places;
        otherwise override `parameters`.
    """

    quantity: ClassVar[str]
    combined: ClassVar[np.ufunc] = np.add
    usual: ClassVar[tuple[Parameter, ...]]

    def parameters(self, plant: Plant, place: str) -> tuple[Parameter, ...]:
        """The effect's parameters, the same for all robots and places."""
        return self.usual

    def apply(self, copies: Variants, row: int, place: str, values: FloatArray) -> None:
        """Change the quantity in one variant by the effect's value or vector (p,)."""
        numbers, at = copies.at(self.quantity, row, place)
        change = values if self.components > 1 else values[0]
        numbers[at] = self.combined(numbers[at], change)


class TorqueEffect(JointEffect):
    """A torque at a joint by a law that MuJoCo lacks: `torque_nm`, for every step.

    Example:
      See docs/python.md, "Physics of your own".
    """

    native: ClassVar[bool] = False
    no_law: ClassVar[str] = "its law is code of your own"

    def apply(self, copies: Variants, row: int, place: str, values: FloatArray) -> None:
        """Store the values (p,) for one variant; those of several effects are added.

        A law that is not linear in its values has to override this.
        """
        noted = copies.torque_values(self, len(values))
        noted[row, copies.column(place)] += values

    @abstractmethod
    def torque_nm(
        self,
        values: FloatArray,
        position_rad: FloatArray,
        velocity_rad_s: FloatArray,
        time_s: FloatArray,
    ) -> FloatArray:
        """Torques (rows, j) [N m] at the j joints of all simulations for one step.

        Args:
          values: (rows, j, p) the effect's p parameters. Where all are 0, there is no
            effect, and the torque must be 0.
          position_rad: (rows, j) joint angles as the step begins.
          velocity_rad_s: (rows, j) joint speeds as the step begins.
          time_s: (rows, 1) time in the recording.
        """

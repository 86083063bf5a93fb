"""Where effects may be: bases of those that share a kind of place."""

from collections.abc import Sequence
from typing import TYPE_CHECKING, ClassVar

import numpy as np

from diagnosis.effects.effect import Effect, PlaceKind
from groundwalk.arrays import BoolArray

if TYPE_CHECKING:
    from diagnosis.plant.plant import Plant
    from diagnosis.traces.trace import Trace


class JointEffect(Effect):
    """At any joint that the traces speak of."""

    place_kind: ClassVar[PlaceKind] = "joint"

    def places(self, plant: "Plant", traces: Sequence["Trace"]) -> tuple[str, ...]:
        """All joints of the plant."""
        return plant.joints


class ServoEffect(JointEffect):
    """At joints that a servo holds with some stiffness."""

    def places(self, plant: "Plant", traces: Sequence["Trace"]) -> tuple[str, ...]:
        """Joints whose servo has a stiffness above 0, in any of the traces."""
        servos = [trace.servo for trace in traces] or [plant.servo]
        return joints_where(plant, [servo.kp_nm_rad > 0 for servo in servos])


def joints_where(plant: "Plant", masks: Sequence[BoolArray]) -> tuple[str, ...]:
    """Names of the joints for which any of some masks (j,) is true."""
    found = np.flatnonzero(np.any(masks, axis=0))
    return tuple(plant.joints[column] for column in found)


class BodyEffect(Effect):
    """At any body that has mass, a name, and moves."""

    place_kind: ClassVar[PlaceKind] = "body"

    def places(self, plant: "Plant", traces: Sequence["Trace"]) -> tuple[str, ...]:
        """Names of the bodies; those without one cannot be spoken of."""
        return tuple(name for name in plant.bodies if name)

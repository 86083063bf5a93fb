"""A firmware that moves its set-point slowly."""

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from diagnosis.effects._places import ServoEffect
from diagnosis.effects._sizes import speed_rad_s
from diagnosis.effects.effect import Parameter
from groundwalk.arrays import FloatArray

if TYPE_CHECKING:
    from diagnosis.effects.variants import Variants
    from diagnosis.plant.plant import Plant
    from diagnosis.traces.trace import Trace


class SpeedLimit(ServoEffect):
    """The set-point follows the command with |speed| <= limit.

    Source: rate limiter, Astrom and Hagglund 2006, "Advanced PID control";
    hobby and smart servos have it as their "moving speed".
    """

    name = "speed_limit"
    native = False

    def places(self, plant: "Plant", traces: Sequence["Trace"]) -> tuple[str, ...]:
        """Joints with a servo, if a trace has position commands."""
        if all(trace.command_rad is None for trace in traces):
            return ()
        return super().places(plant, traces)

    def parameters(self, plant: "Plant", place: str) -> tuple[Parameter, ...]:
        """The limit."""
        scale = speed_rad_s(plant, place)
        return (
            Parameter(
                "speed", "rad/s", 0.01 * scale, 4 * scale, np.inf, 0.4 * scale, True
            ),
        )

    def apply(
        self, variants: "Variants", row: int, place: str, values: FloatArray
    ) -> None:
        """The lower limit counts."""
        limits, at = variants.joints.setpoint_speed_rad_s, (row, variants.column(place))
        limits[at] = min(limits[at], values[0])

"""The effect end stop: a hard stop inside a joint's nominal range."""

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from diagnosis.effects.bases import JointEffect
from diagnosis.effects.parts import (
    EffectWords,
    Interval,
    Parameter,
    PlacedEffect,
    Values,
)
from diagnosis.effects.scales import range_rad
from groundwalk.arrays import FloatArray

if TYPE_CHECKING:
    from diagnosis.effects.variants import Variants
    from diagnosis.plant.plant import Plant
    from diagnosis.traces.trace import Trace
    from diagnosis.traces.usage import Usage

_FAR_RAD = 1e6
"""Bound of the angle of a joint without a range: so large that it acts as no bound."""

_STIFF = (0.005, 1.0)
"""MuJoCo's `solref` of the stop, time constant [s] and damping ratio: hard, without
bouncing."""


class EndStop(JointEffect):
    """A hard stop: joint angle q <= angle (side +1) or q >= angle (side -1).

    The stop pushes the joint back, critically damped, with a time constant of 5 ms, or
    of two physics steps if that is longer, as MuJoCo demands.

    Source: complementarity between distance and force, Brogliato 2016, "Nonsmooth
    mechanics". In MuJoCo `jnt_range`.
    """

    name = "end_stop"
    native = True
    threshold = True
    on_every_servo = False
    main_parameters = ("angle",)
    words = EffectWords(
        "end stop",
        "{joint} hits a stop at {angle} {lacking}",
        "Something stops the joint before the end of its nominal range.",
    )

    def parameters(self, plant: "Plant", place: str) -> tuple[Parameter, ...]:
        """Angle of the stop [rad], and side, whose sign says which way it blocks."""
        low, high = range_rad(plant, place)
        is_limited = plant.model.jnt_limited[plant.model.joint(place).id]
        neutral = high if is_limited else np.inf
        typical = low + 0.75 * (high - low)
        return (
            Parameter("angle", "rad", low, high, neutral, typical),
            Parameter("side", "1", -1.0, 1.0, 1.0, 1.0),
        )

    def apply(
        self, variants: "Variants", row: int, place: str, values: FloatArray
    ) -> None:
        """Narrow a joint's range in one variant; stops outside it change nothing."""
        angle, side = (float(value) for value in values)
        joint = variants.plant.model.joint(place).id
        limited, ranges = variants.field("jnt_limited"), variants.field("jnt_range")
        low, high = ranges[row, joint] if limited[row, joint] else (-_FAR_RAD, _FAR_RAD)
        if not low < angle < high:
            return
        ranges[row, joint] = (low, angle) if side > 0 else (angle, high)
        limited[row, joint] = 1
        variants.field("jnt_solref")[row, joint] = _STIFF

    def first_tries(
        self,
        plant: "Plant",
        place: str,
        usage: "Usage",
        intervals: Sequence[Interval],
    ) -> list[Values]:
        """Stops that cut 5 % and 20 % of the joint's recorded range off either end."""
        column = plant.joints.index(place)
        low, high = usage.low_rad[column], usage.high_rad[column]
        span = high - low
        return [
            (end + side * -share * span, side)
            for end, side in ((high, 1.0), (low, -1.0))
            for share in (0.05, 0.2)
        ]

    def sizes_to_scan(
        self, plant: "Plant", placed: PlacedEffect, traces: Sequence["Trace"]
    ) -> list[PlacedEffect]:
        """Only the guess: scaling a stop's angle does not scale the effect."""
        return [placed]

    def neutral_values(self, plant: "Plant", placed: PlacedEffect) -> Values:
        """Angle at the end of the joint's range on the stop's side, and the side +1."""
        angle, side = self.parameters(plant, placed.place)
        if placed.values and placed.values[1] < 0:
            return angle.low, side.neutral
        return angle.neutral, side.neutral

"""Sizes of effects that are worth a first try, given how a robot was used."""

from collections.abc import Sequence

from diagnosis.effects.effect import Parameter
from diagnosis.traces.usage import Usage

Values = tuple[float, ...]
Interval = tuple[float, float]
"""Start [s] and duration [s]."""

VECTORS = {"com_offset": 3, "ground_slope": 2, "gyro_bias": 3, "external_force": 3}
"""Effects whose first so many values are components: each is tried, and what they do
together is the sum. What else they have, such as when a force acts, is no size."""

THRESHOLDS = frozenset({"torque_limit", "speed_limit", "end_stop"})
"""Effects that are no larger for a larger first value."""


def trial_values(
    name: str,
    parameters: tuple[Parameter, ...],
    column: int | None,
    usage: Usage,
    intervals: Sequence[Interval],
) -> list[Values]:
    """Values of an effect to begin with: most effects are nearly linear, one will do.

    Those with a threshold do nothing until it is met, so theirs are taken from what
    the joint did.

    Args:
      name: of the effect.
      parameters: at the place.
      column: of the joint; None if the place is none.
      usage: of all joints.
      intervals: when something may have pushed.
    """
    typical = tuple(p.typical for p in parameters)
    if name == "external_force":
        return [axes + when for when in intervals for axes in _axes(typical[:3])]
    if name in VECTORS:
        return _axes(typical)
    return [typical] if column is None else _joint_values(name, typical, column, usage)


def _joint_values(
    name: str, typical: Values, column: int, usage: Usage
) -> list[Values]:
    low, high = usage.low_rad[column], usage.high_rad[column]
    span, speed = high - low, usage.command_speed_rad_s[column]
    torque = usage.torque_nm[column]
    match name:
        case "torque_limit":
            return [(share * torque,) for share in (0.9, 0.7, 0.45)]
        case "speed_limit":
            return [(share * speed,) for share in (0.8, 0.5, 0.25)]
        case "end_stop":
            return [
                (end + side * -share * span, side)
                for end, side in ((high, 1.0), (low, -1.0))
                for share in (0.05, 0.2)
            ]
        case "backlash":
            return [(0.01,), (0.03,)]
        case "stribeck_friction":
            coulomb, extra, _ = typical
            return [(coulomb, extra, v) for v in (0.03, 0.2)]
        case "joint_elasticity":
            stiffness, damping = typical
            return [(stiffness * k, damping * k) for k in (1.0, 5.0)]
        case "joint_spring":
            return [
                (typical[0], (low + high) / 2),
                (typical[0], low),
                (typical[0], high),
            ]
        case _:
            return [typical]


def _axes(typical: Values) -> list[Values]:
    """One axis at a time."""
    return [
        tuple(value if i == axis else 0.0 for i, value in enumerate(typical))
        for axis in range(len(typical))
    ]

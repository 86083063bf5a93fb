"""Requests to walk at a velocity, halt or stand up, and the plan of a step."""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from groundwalk.arrays import BoolArray, FloatArray
from groundwalk.errors import BadValueError
from robots.leg_geometry import LegGeometry
from walk_engine.engine_config import EngineConfig


@dataclass(frozen=True, eq=False)
class Velocity:
    """Requested walking velocity, for all robots (numbers) or each (arrays (n,)).

    A request of zero keeps a robot crouched and ready to walk. Speeds beyond the gait's
    `max_forward` or the engine's limits are clipped: infinity means as fast as allowed.

    Attributes:
      forward_m_s: speed in the direction in which the robot faces.
      left_m_s: speed to its left.
      turn_rad_s: rate of turn to the left.
      stand: True asks to halt and to straighten the legs, whatever the velocity.

    Example:
      >>> Velocity(forward_m_s=0.1, turn_rad_s=0.2).forward_m_s
      0.1
    """

    forward_m_s: float | FloatArray = 0.0
    left_m_s: float | FloatArray = 0.0
    turn_rad_s: float | FloatArray = 0.0
    stand: bool | BoolArray = False

    def __post_init__(self) -> None:
        """Refuse speeds that are NaN."""
        for name in ("forward_m_s", "left_m_s", "turn_rad_s"):
            if np.isnan(getattr(self, name)).any():
                raise BadValueError(f"velocity {name} is NaN; it must be a number")

    @classmethod
    def forward(cls) -> "Velocity":
        """Request to walk straight ahead at the gait's `max_forward` speed."""
        return cls(forward_m_s=np.inf)


GaitColumns = dict[str, FloatArray]
"""Values (n,) of each gait parameter, by its name, for n robots."""


class Speeds(NamedTuple):
    """Requested speeds of n robots, clipped to the limits; all arrays are (n,)."""

    forward_m_s: FloatArray
    left_m_s: FloatArray
    turn_rad_s: FloatArray

    @property
    def moving(self) -> BoolArray:
        """(n,) whether any speed of a robot differs from zero."""
        moving: BoolArray = (
            (self.forward_m_s != 0) | (self.left_m_s != 0) | (self.turn_rad_s != 0)
        )
        return moving


class StepPlan(NamedTuple):
    """The planned step of each robot; all arrays are (n,).

    Distances and angles are those of a whole cycle of two steps, as in rUNSWift's
    Walk2014.

    Attributes:
      period_s: duration of the step [s].
      lift_m: height of the swing foot at its apex [m].
      forward_m: distance forward in a cycle [m].
      left_m: distance to the left in a cycle [m].
      turn_rad: change of the hip yaw joints in a cycle [rad], left positive.
      com_offset_m: distance of the hip ahead of the middle of the ankles at the end of
        the step [m].
    """

    period_s: FloatArray
    lift_m: FloatArray
    forward_m: FloatArray
    left_m: FloatArray
    turn_rad: FloatArray
    com_offset_m: FloatArray


def within_limits(request: Velocity, gait: GaitColumns, config: EngineConfig) -> Speeds:
    """Clip each requested speed of each robot to the gait's or the engine's limit."""
    fastest = gait["max_forward"]
    left, turn = np.zeros_like(fastest), np.zeros_like(fastest)
    left += np.clip(request.left_m_s, -config.max_left_m_s, config.max_left_m_s)
    turn += np.clip(request.turn_rad_s, -config.max_turn_rad_s, config.max_turn_rad_s)
    return Speeds(np.clip(request.forward_m_s, -fastest, fastest), left, turn)


def plan_step(
    speeds: Speeds,
    starting: BoolArray,
    gait: GaitColumns,
    leg: LegGeometry,
    config: EngineConfig,
) -> StepPlan:
    """Plan a step of each robot, from its speeds within the limits.

    The first step (`starting`, (n,)) only rocks the robot: it lifts a foot, less high
    than a later step, and covers no distance. The turn of the hip yaw joints follows
    without slip: the foot turns by the z component of the joint's axis, and each degree
    is used twice in a cycle.
    """
    share = np.abs(speeds.left_m_s) / config.max_left_m_s
    period_s = gait["step_period"] + config.side_step_extra_s * share
    cycle_s = 2 * period_s
    forward_m = speeds.forward_m_s * cycle_s
    left_m = speeds.left_m_s * cycle_s * config.left_calibration
    turn_rad = speeds.turn_rad_s * cycle_s / (2 * abs(leg.yaw_axis[2]))
    lift_m = gait["base_leg_lift"] + gait["lift_slope_forward"] * np.abs(forward_m)
    lift_m = lift_m + config.lift_slope_left * np.abs(left_m)
    # As in rUNSWift 2022, only walking forward shifts the hip.
    ahead = np.maximum(speeds.forward_m_s, 0.0) / config.com_offset_speed_m_s
    ahead = np.where(starting, 0.0, ahead)
    return StepPlan(
        period_s=period_s,
        lift_m=np.where(starting, lift_m / gait["start_lift_divisor"], lift_m),
        forward_m=np.where(starting, 0.0, forward_m),
        left_m=np.where(starting, 0.0, left_m),
        turn_rad=np.where(starting, 0.0, turn_rad),
        com_offset_m=gait["com_offset"] + gait["com_offset_speed_gain"] * ahead,
    )

"""Positions of the feet relative to the hips in a step, as in rUNSWift's Walk2014.

Let f, l and u be the planned distance forward, distance to the left and turn of a cycle
of two steps. Let s and w rise from 0 to 1 over the step, s at constant speed and w with
constant acceleration, then constant deceleration:

- the support foot moves to f/4 behind the hip with s, the swing foot to f/4 ahead of it
  with w; in steady walking both take steps of length f/2;
- if the foot on the side of l swings, it opens the legs with w to half the angle that l
  subtends at the hip; the opening left by the step before closes with 1 - w, so that
  the other foot brings the legs together again;
- the toes turn with w: outward by 2/3 of u if the outer foot swings, inward by 1/3 if
  the inner foot swings;
- the swing foot rises to the plan's lift and comes down again.

Arrays (2, n) hold the left foot in row 0 and the right one in row 1.
"""

from typing import NamedTuple

import numpy as np

from groundwalk.arrays import BoolArray, FloatArray
from walk_engine.engine_config import EngineConfig
from walk_engine.step_plan import GaitColumns, StepPlan
from walk_engine.time_profiles import (
    linear_step,
    parabolic_return,
    parabolic_step,
    warped_phase,
)


class Feet(NamedTuple):
    """Positions of the feet of n robots relative to their hips.

    Attributes:
      behind_m: (2, n) distance of the ankle behind the hip, without com_offset_m [m].
      lift_m: (2, n) height of the sole above the ground [m].
      opening_rad: (n,) outward turn of the legs about the hips' x axes [rad].
      toe_out_rad: (n,) outward turn of the toes by the hip yaw joints [rad].
      com_offset_m: (n,) distance of the hip ahead of the middle of the ankles [m].
    """

    behind_m: FloatArray
    lift_m: FloatArray
    opening_rad: FloatArray
    toe_out_rad: FloatArray
    com_offset_m: FloatArray


def resting_feet(com_offset_m: FloatArray) -> Feet:
    """Feet side by side on the ground; hips ahead of the ankles by (n,) offsets [m]."""
    n = len(com_offset_m)
    pair, zero = np.zeros((2, n)), np.zeros(n)
    return Feet(pair, pair, zero, zero, com_offset_m)


def feet_in_step(
    time_s: FloatArray,
    plan: StepPlan,
    origin: Feet,
    left_swings: BoolArray,
    gait: GaitColumns,
    leg_height_m: FloatArray,
    config: EngineConfig,
) -> Feet:
    """Positions of the feet at times (n,) [s] since the step began at `origin`.

    `left_swings` (n,) says whether the left foot swings; `leg_height_m` (n,) is the
    height of the hip above the ankle with both feet down [m].
    """
    swings = np.stack((left_swings, ~left_swings))
    progress = parabolic_step(time_s, plan.period_s)
    phase = linear_step(time_s, plan.period_s)
    dead = gait["swing_dead_fraction"]
    forth = parabolic_step(time_s, plan.period_s, dead)
    travel = np.where(swings, forth, phase)
    quarter_m = np.where(swings, -plan.forward_m, plan.forward_m) / 4
    rise = parabolic_return(warped_phase(phase, gait["lift_apex_phase"]))
    side = np.where(left_swings, 1.0, -1.0)
    outward_m = np.maximum(side * plan.left_m, 0.0)
    step = np.arctan(outward_m * progress / leg_height_m)
    return Feet(
        behind_m=origin.behind_m + (quarter_m - origin.behind_m) * travel,
        lift_m=np.where(swings, plan.lift_m * rise, 0.0),
        opening_rad=0.5 * step + origin.opening_rad * (1.0 - progress),
        toe_out_rad=_toe_out(side * plan.turn_rad, progress, origin, config),
        com_offset_m=origin.com_offset_m
        + (plan.com_offset_m - origin.com_offset_m) * phase,
    )


def _toe_out(
    outward_rad: FloatArray, progress: FloatArray, origin: Feet, config: EngineConfig
) -> FloatArray:
    """Outward turn (n,) of the toes [rad]; `outward_rad` is a cycle's turn."""
    outer = config.outward_turn_share
    target = np.where(outward_rad > 0, outer, 1.0 - outer) * outward_rad
    return origin.toe_out_rad + (target - origin.toe_out_rad) * progress

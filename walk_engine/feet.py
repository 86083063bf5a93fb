"""Where the feet are during a step, relative to the hips; the equations of Walk2014.

Let f, l and u be the plan's way forward, way to the left and turn, s the linear and w
the parabolic profile over the step:

- the support foot goes to f/4 behind the hip with s, the swing foot to f/4 ahead with
  w, so that in steady walking both take steps of f/2;
- if the foot on the side of l swings, it opens the legs with w to half the angle that l
  is seen under from the hip; what was open before closes with 1 - w, so the other foot
  brings them together again;
- the toes turn with w: outward by 2/3 of u if the outer foot swings, inward by 1/3 if
  the inner one does;
- the swing foot rises to the plan's lift and comes back.

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
    """Where the feet are. All but the first two are the same for both feet.

    Attributes:
      behind_m: (2, n) ankle behind the hip, com_offset_m not counted.
      lift_m: (2, n) sole above the ground.
      opening_rad: (n,) legs turned outward about the hips' x axes.
      toe_out_rad: (n,) hip yaw joints turned so that the toes point outward.
      com_offset_m: (n,) hip ahead of the middle of the ankles.
    """

    behind_m: FloatArray
    lift_m: FloatArray
    opening_rad: FloatArray
    toe_out_rad: FloatArray
    com_offset_m: FloatArray


def resting_feet(com_offset_m: FloatArray) -> Feet:
    """Feet side by side on the ground."""
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
    """The feet at a time after the step began.

    Args:
      time_s: (n,) time since the step began.
      plan: what the step shall do.
      origin: where the feet were when it began.
      left_swings: (n,) which foot swings.
      gait: the gaits.
      leg_height_m: (n,) hip above ankle, both feet on the ground.
      config: the engine's constants.
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
    return Feet(
        behind_m=origin.behind_m + (quarter_m - origin.behind_m) * travel,
        lift_m=np.where(swings, plan.lift_m * rise, 0.0),
        opening_rad=_opening(side * plan.left_m, progress, origin, leg_height_m),
        toe_out_rad=_toe_out(side * plan.turn_rad, progress, origin, config),
        com_offset_m=origin.com_offset_m
        + (plan.com_offset_m - origin.com_offset_m) * phase,
    )


def _opening(
    outward_m: FloatArray, progress: FloatArray, origin: Feet, leg_height_m: FloatArray
) -> FloatArray:
    """Angle of the legs; `outward_m` is the cycle's way to the swing foot's side."""
    step = np.arctan(np.maximum(outward_m, 0.0) * progress / leg_height_m)
    return 0.5 * step + origin.opening_rad * (1.0 - progress)


def _toe_out(
    outward_rad: FloatArray, progress: FloatArray, origin: Feet, config: EngineConfig
) -> FloatArray:
    """Angle of the toes; `outward_rad` is the turn to the swing foot's side."""
    outer = config.outward_turn_share
    target = np.where(outward_rad > 0, outer, 1.0 - outer) * outward_rad
    return origin.toe_out_rad + (target - origin.toe_out_rad) * progress

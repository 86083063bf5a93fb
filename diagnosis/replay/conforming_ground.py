"""Uneven ground for replays, inferred from where recorded soles stood at their start.

The effect uneven ground states how high bumps are, not where. Recorded base and joints
say where each point of a loaded sole is when a replay begins. Where that is off the
model's plane by more than measurement errors, the ground is taken to be there, at most
as high or low as the bumps. Where a foot steps later, the ground is flat.
"""

from collections.abc import Sequence
from typing import Any

import mujoco
import numpy as np

from diagnosis.effects.ground import foot_geoms, ground_geoms
from diagnosis.plant.plant import Plant
from diagnosis.traces.windows import Run
from groundwalk.arrays import BoolArray, FloatArray, IntArray

DOUBT_M = 6e-4
"""Distance [m] from the plane below which a sole counts as standing on the plane: three
times the uncertainty from motion capture and encoders."""

LOADED = 0.05
"""Share of the force on all feet above which a foot counts as standing."""

ABOVE_M = 0.005
"""Height [m] above the lowest foot up to which a foot counts as standing, where foot
forces are not recorded."""


def conform(
    batch: Any, plant: Plant, runs: Sequence[Run], height_m: FloatArray
) -> None:
    """Raise or lower the ground under loaded soles to where the soles are.

    The ground stays a plane: the geoms of the soles are moved instead, by `height_m`
    (N,) at most. The `batch` of N simulations is in the states that their `runs` start
    from.
    """
    model, floor = plant.model, ground_geoms(plant)[0]
    n = len(height_m)
    places = np.asarray(batch.expand("geom_pos")).reshape(n, model.ngeom, 3)
    turns = np.asarray(batch.bind("geom_xmat")).reshape(n, model.ngeom, 3, 3)
    bodies = np.asarray(batch.bind("xmat")).reshape(n, model.nbody, 3, 3)
    at = np.asarray(batch.bind("geom_xpos")).reshape(n, model.ngeom, 3)
    batch.forward()  # computes the positions that have just been bound
    normal = turns[:, floor, :, 2]
    feet = [foot_geoms(plant, foot) for foot in plant.feet]
    above = [_above(model, geoms, floor, at, turns) for geoms in feet]
    stands = _stands(runs, np.stack([each.min(axis=1) for each in above], axis=1))
    for i, (foot, geoms) in enumerate(zip(plant.feet, feet, strict=True)):
        bump = np.clip(above[i], -height_m[:, None], height_m[:, None])
        bump = np.where(np.abs(above[i]) > DOUBT_M, bump, 0.0) * stands[:, i, None]
        down = np.einsum("nij,ni->nj", bodies[:, model.body(foot).id], -normal)
        places[:, geoms] += bump[:, :, None] * down[:, None]
    # MuJoCo's tree of bounding boxes still surrounds the old places of the soles
    flags = np.asarray(batch.expand("opt.disableflags"))
    flags[:] |= int(mujoco.mjtDisableBit.mjDSBL_MIDPHASE)
    batch.forward()


def _above(
    model: mujoco.MjModel,
    geoms: IntArray,
    floor: int,
    at: FloatArray,
    turns: FloatArray,
) -> FloatArray:
    """(N, geoms) height of each geom's lowest point above the plane [m].

    `geoms` are a foot's, `floor` is the plane; `at` (N, ngeom, 3) and `turns` (N,
    ngeom, 3, 3) are positions and orientations of all geoms.
    """
    normal = turns[:, floor, :, 2]
    down = np.einsum("ngij,ni->ngj", turns[:, geoms], normal)
    middle, half = model.geom_aabb[geoms, :3], model.geom_aabb[geoms, 3:]
    round_ = model.geom_type[geoms] == int(mujoco.mjtGeom.mjGEOM_SPHERE)
    reach = np.where(round_, half[:, 0], (np.abs(down) * half).sum(axis=2))
    centre = np.einsum("ngi,ni->ng", at[:, geoms] - at[:, [floor]], normal)
    return np.asarray(centre + (down * middle).sum(axis=2) - reach)


def _stands(runs: Sequence[Run], lowest: FloatArray) -> BoolArray:
    """(N, feet) whether feet carry robots, from N runs and heights (N, feet) [m]."""
    found = lowest - lowest.min(axis=1, keepdims=True) <= ABOVE_M
    for row, run in enumerate(runs):
        force = run.trace.foot_force_n
        if force is not None and force.shape[1] == lowest.shape[1]:
            found[row] = force[0] > LOADED * max(force[0].sum(), 1e-9)
    return np.asarray(found)

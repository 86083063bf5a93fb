"""Bumps that nobody has measured: the ground is where soles stood on it.

How high an uneven ground is says nothing of where its bumps are, but a robot that
stands still has felt them. Recorded base and joints say where each point of a loaded
sole is when a window begins; if that is off the model's plane by more than what is not
known of the start, ground of sufficient height is taken to be there, and nowhere else.
Where a foot is put down later is not known in advance.
"""

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from diagnosis.effects.ground import foot_geoms, ground_geoms
from diagnosis.traces.windows import Run
from groundwalk.arrays import BoolArray, FloatArray, IntArray

if TYPE_CHECKING:
    import mujoco

    from diagnosis.plant.plant import Plant

DOUBT_M = 6e-4
"""So far from the plane a sole may seem to be though it stands on it: three times
what cameras and encoders do not know."""

LOADED = 0.05
"""Share of the weight on both feet that a foot carries at least if it stands."""

ABOVE_M = 0.005
"""Without foot sensors: a foot stands if it is no higher above the lower one."""


def conform(
    batch: Any, plant: "Plant", runs: Sequence[Run], height_m: FloatArray
) -> None:
    """Raise or lower the ground under loaded soles to where they are.

    The points of the soles move, not the ground: it is one plane for all of them.

    Args:
      batch: N simulations of a plant, put into the states that their runs start from.
      plant: with a plane as ground.
      runs: of each simulation.
      height_m: (N,) that the ground may differ from the plane by, at most.
    """
    import mujoco

    model, floor = plant.model, ground_geoms(plant)[0]
    n = len(height_m)
    places = np.asarray(batch.expand("geom_pos")).reshape(n, model.ngeom, 3)
    turns = np.asarray(batch.bind("geom_xmat")).reshape(n, model.ngeom, 3, 3)
    bodies = np.asarray(batch.bind("xmat")).reshape(n, model.nbody, 3, 3)
    at = np.asarray(batch.bind("geom_xpos")).reshape(n, model.ngeom, 3)
    batch.forward()  # fills what has just been bound
    normal = turns[:, floor, :, 2]
    feet = [foot_geoms(plant, foot) for foot in plant.feet]
    above = [_above(model, geoms, floor, at, turns) for geoms in feet]
    stands = _stands(runs, np.stack([each.min(axis=1) for each in above], axis=1))
    for i, (foot, geoms) in enumerate(zip(plant.feet, feet, strict=True)):
        bump = np.clip(above[i], -height_m[:, None], height_m[:, None])
        bump = np.where(np.abs(above[i]) > DOUBT_M, bump, 0.0) * stands[:, i, None]
        down = np.einsum("nij,ni->nj", bodies[:, model.body(foot).id], -normal)
        places[:, geoms] += bump[:, :, None] * down[:, None]
    # the tree of boxes that collisions are looked for in is around the old places
    flags = np.asarray(batch.expand("opt.disableflags"))
    flags[:] |= int(mujoco.mjtDisableBit.mjDSBL_MIDPHASE)
    batch.forward()


def _above(
    model: "mujoco.MjModel",
    geoms: IntArray,
    floor: int,
    at: FloatArray,
    turns: FloatArray,
) -> FloatArray:
    """(N, geoms) height of the lowest point of each over the plane."""
    import mujoco

    normal = turns[:, floor, :, 2]
    down = np.einsum("ngij,ni->ngj", turns[:, geoms], normal)
    middle, half = model.geom_aabb[geoms, :3], model.geom_aabb[geoms, 3:]
    round_ = model.geom_type[geoms] == int(mujoco.mjtGeom.mjGEOM_SPHERE)
    reach = np.where(round_, half[:, 0], (np.abs(down) * half).sum(axis=2))
    centre = np.einsum("ngi,ni->ng", at[:, geoms] - at[:, [floor]], normal)
    return np.asarray(centre + (down * middle).sum(axis=2) - reach)


def _stands(runs: Sequence[Run], lowest: FloatArray) -> BoolArray:
    """(N, feet) which feet carry the robot as a run begins.

    Args:
      runs: of each simulation.
      lowest: (N, feet) height of each foot's lowest point.
    """
    forces = [run.trace.foot_force_n for run in runs]
    found = lowest - lowest.min(axis=1, keepdims=True) <= ABOVE_M
    for row, force in enumerate(forces):
        if force is not None and force.shape[1] == lowest.shape[1]:
            found[row] = force[0] > LOADED * max(force[0].sum(), 1e-9)
    return np.asarray(found)

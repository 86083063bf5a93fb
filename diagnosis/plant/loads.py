"""Known loads of recordings, added to the bodies of a robot model.

A load is a point mass. A body that carries one has another mass, centre of mass and
inertia (Featherstone 2008, "Rigid body dynamics algorithms", section 2.13).
"""

import copy
from collections.abc import Mapping
from typing import NamedTuple

import mujoco
import numpy as np
from scipy.spatial.transform import Rotation

from diagnosis.plant.plant import Plant
from groundwalk.arrays import FloatArray
from groundwalk.errors import BadRecordingError
from worlds.recordings.load import Load
from worlds.recordings.recording import nearest


class Inertias(NamedTuple):
    """Views of n models' fields of those names, one row for each model and body.

    They are (n, bodies) masses [kg], (n, bodies, 3) centres of mass in the body frames
    [m], (n, bodies, 3) principal inertias [kg m^2] and (n, bodies, 4) the quaternions
    (w, x, y, z) of their axes.
    """

    body_mass: FloatArray
    body_ipos: FloatArray
    body_inertia: FloatArray
    body_iquat: FloatArray


def check_loads(loads: Mapping[str, Load], plant: Plant, said_by: str) -> None:
    """Refuse loads at bodies that a robot model lacks.

    Raises:
      BadRecordingError: there is no such body; the message begins with `said_by`.
    """
    model = plant.model
    known = [model.body(i).name for i in range(1, model.nbody)]
    for body in loads:
        if body not in known:
            hint = nearest(body, known) or f"; it has {', '.join(known)}"
            raise BadRecordingError(
                f"{said_by}: a load is fixed to {body!r}, which is no body of "
                f"{plant.name}{hint}"
            )


def carry(inertias: Inertias, plant: Plant, loads: Mapping[str, Load]) -> None:
    """Add loads to the bodies of n models, in place; bodies unknown here are left out.

    (A model of one limb lacks the bodies of the others.) Constants that MuJoCo computes
    from inertias must be set anew afterwards, and the plant must be `bearing` them.
    """
    for name, load in loads.items():
        body = mujoco.mj_name2id(plant.model, mujoco.mjtObj.mjOBJ_BODY.value, name)
        if body >= 0:
            _add(Inertias(*(one[:, body] for one in inertias)), load)


def model_under(
    plant: Plant, loads: Mapping[str, Load], model: mujoco.MjModel | None = None
) -> mujoco.MjModel:
    """A copy of a robot's compiled model, or of the given one like it, with loads.

    Without loads it is the model itself.
    """
    model = plant.model if model is None else model
    if not loads:
        return model
    model = copy.copy(model)
    carry(
        Inertias(*(getattr(model, one)[None] for one in Inertias._fields)), plant, loads
    )
    mujoco.mj_setConst(model, mujoco.MjData(model))
    return model


def _add(own: Inertias, load: Load) -> None:
    """Add a load to one body of n models: as in `Inertias`, less the bodies' axis."""
    mass, centre, size, axes = own
    total = mass + load.mass
    way = np.asarray(load.at) - centre
    turn = Rotation.from_quat(axes, scalar_first=True).as_matrix()
    inertia = np.einsum("nij,nj,nkj->nik", turn, size, turn)
    # two masses at a distance turn about their common centre as their reduced mass does
    reduced = (mass * load.mass / total)[:, None, None]
    square = np.einsum("ni,ni->n", way, way)[:, None, None] * np.eye(3)
    size[:], turn = np.linalg.eigh(
        inertia + reduced * (square - way[:, :, None] * way[:, None, :])
    )
    turn[:, :, 0] *= np.linalg.det(turn)[:, None]  # a rotation, not a mirror
    axes[:] = Rotation.from_matrix(turn).as_quat(scalar_first=True)
    centre += load.mass / total[:, None] * way
    mass[:] = total

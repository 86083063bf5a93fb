"""Multiplies masses and inertias of bodies in a compiled MuJoCo model."""

from collections.abc import Sequence
from typing import Any

from groundwalk.errors import BadValueError, UnknownNameError


def scale_mass(model: Any, data: Any, factor: float, bodies: Sequence[str]) -> None:
    """Multiply masses and inertias of an `MjModel`'s bodies; () means all.

    Changing masses alone would leave the inertias and MuJoCo's derived constants
    unchanged (MuJoCo issue 609); `mj_setConst` computes the constants again, and also
    puts `data` into the model's reference pose.

    Raises:
      BadValueError: the factor is not positive.
      UnknownNameError: there is no such body.
    """
    import mujoco

    if not 0 < factor < float("inf"):
        raise BadValueError(f"the masses' factor is {factor}; it must be positive")
    names = [model.body(index).name for index in range(1, model.nbody)]
    for name in bodies or names:
        if name not in names:
            raise UnknownNameError("body", name, names)
        index = model.body(name).id
        model.body_mass[index] *= factor
        model.body_inertia[index] *= factor
    mujoco.mj_setConst(model, data)

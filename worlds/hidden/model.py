"""Hidden physics that changes bodies, gravity or ground: before the world starts."""

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from groundwalk.arrays import FloatArray
from groundwalk.errors import BadValueError, UnknownNameError
from groundwalk.gravity import GRAVITY_M_S2
from terrain import Heightfield, Lumps
from worlds.hidden.effects import Hidden
from worlds.hidden.plant import HiddenPlant
from worlds.sim.model import add_ground
from worlds.sim.quiet_mujoco import quiet_mujoco

if TYPE_CHECKING:
    import mujoco

_GROUND_M = 3.0
_BUMP_WAVELENGTH_M = 0.2


def hidden_model(
    plant: HiddenPlant,
    effects: Sequence[Hidden],
    step_s: float,
    ground: Heightfield | None,
) -> "mujoco.MjModel":
    """The robot with what the effects do to its bodies and to gravity.

    Args:
      plant: the nominal robot.
      effects: all that is hidden; those of other kinds change nothing here.
      step_s: time step.
      ground: what it stands on; None for a fixed base.

    Raises:
      UnknownNameError: the robot has no such body or joint.
    """
    import mujoco

    quiet_mujoco()
    spec = plant.make_spec()
    spec.compiler.discardvisual = False
    # Semi-implicit Euler: with speeds half a step ahead it is a leapfrog, and exact
    # to second order for all that depends on positions.
    spec.option.integrator = mujoco.mjtIntegrator.mjINT_EULER
    spec.option.timestep = step_s
    for effect in effects:
        _change_bodies(spec, plant, effect)
    spec.option.gravity = tilted_gravity(effects)
    if ground is not None:
        add_ground(spec, ground)
    model = spec.compile()
    model.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_AUTORESET
    _set_friction(model, effects)
    return model


def _change_bodies(spec: Any, plant: HiddenPlant, effect: Hidden) -> None:
    if effect.name == "armature":
        plant.joint(effect.place)
        spec.joint(effect.place).armature += effect["inertia"]
    if effect.name in ("payload_mass", "com_offset"):
        body = _body(spec, effect.place)
        if effect.name == "payload_mass":
            body.mass += effect["mass"]
        else:
            body.ipos = body.ipos + np.array([effect[axis] for axis in "xyz"])


def _body(spec: Any, name: str) -> Any:
    body = spec.body(name)
    if body is None:
        known = [other.name for other in spec.bodies if other.name != "world"]
        raise UnknownNameError("body", name, known)
    return body


def _set_friction(model: "mujoco.MjModel", effects: Sequence[Hidden]) -> None:
    """The soles' friction counts, not the larger of sole's and ground's."""
    soles = model.geom_contype == 1
    model.geom_priority[soles] = 1
    for effect in effects:
        if effect.name == "contact_friction":
            model.geom_friction[soles, 0] = effect["coefficient"]


def tilt(effects: Sequence[Hidden]) -> FloatArray:
    """(3, 3) turn of the base's mount, or of the ground, against the true vertical.

    R = R_y(pitch) R_x(roll): a positive pitch dips what is in front (x), a positive
    roll lifts what is on the left (y).
    """
    pitch = sum(e["pitch"] for e in effects if e.name == "ground_slope")
    roll = sum(e["roll"] for e in effects if e.name == "ground_slope")
    about_y = np.array(
        [
            [math.cos(pitch), 0, math.sin(pitch)],
            [0, 1, 0],
            [-math.sin(pitch), 0, math.cos(pitch)],
        ]
    )
    about_x = np.array(
        [
            [1, 0, 0],
            [0, math.cos(roll), -math.sin(roll)],
            [0, math.sin(roll), math.cos(roll)],
        ]
    )
    return np.asarray(about_y @ about_x)


def tilted_gravity(effects: Sequence[Hidden]) -> FloatArray:
    """(3,) gravity [m/s^2] in the frame of the mount or the ground."""
    return np.asarray(tilt(effects).T @ np.array([0, 0, -GRAVITY_M_S2]))


def hidden_ground(
    effects: Sequence[Hidden], seed: np.random.SeedSequence
) -> Heightfield:
    """What a floating robot stands on: level ground, or bumps from the start on."""
    height_m = max(
        (e["height"] for e in effects if e.name == "uneven_ground"), default=0.0
    )
    if height_m < 0:
        raise BadValueError(f"bumps of {height_m} m; they must not be negative")
    extent = (-_GROUND_M, _GROUND_M)
    if height_m == 0:
        return Heightfield(np.zeros((2, 2)), (-_GROUND_M, -_GROUND_M), 2 * _GROUND_M)
    lumps = Lumps(
        amplitude_m=height_m,
        wavelength_m=_BUMP_WAVELENGTH_M,
        x_range_m=extent,
        y_range_m=extent,
        start_radius_m=0.0,
        blend_m=0.05,
    )
    return lumps.make(seed)

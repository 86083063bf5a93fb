"""Makes MuJoCo models with physics (effects) that the robot's nominal model lacks."""

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from groundwalk.errors import UnknownNameError
from robots.engine_models.mjcf import quiet_mujoco
from terrain import Heightfield
from worlds.hidden.effects.placed import Hidden, surroundings
from worlds.hidden.plant import HiddenPlant
from worlds.sim.model import add_ground

if TYPE_CHECKING:
    import mujoco


def hidden_model(
    plant: HiddenPlant,
    effects: Sequence[Hidden],
    step_s: float,
    ground: Heightfield | None,
) -> "mujoco.MjModel":
    """The robot's model, with joints, bodies, gravity and soles as the effects say.

    Effects on servos and signals change nothing here; `ground` is None for a fixed
    base.
    """
    import mujoco

    quiet_mujoco()
    spec = plant.make_spec()
    spec.compiler.discardvisual = False
    # If speeds are read as those half a step later, semi-implicit Euler is a leapfrog:
    # second-order accurate for all that depends on positions.
    spec.option.integrator = mujoco.mjtIntegrator.mjINT_EULER
    spec.option.timestep = step_s
    for effect in effects:
        if effect.kind.place in ("joint", "body"):
            effect.kind.change_part(_part(spec, plant, effect), effect.values)
    around = surroundings(effects)
    spec.option.gravity = around.gravity_m_s2()
    if ground is not None:
        add_ground(spec, ground)
    model = spec.compile()
    model.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_AUTORESET
    soles = model.geom_contype == 1
    # Without a priority MuJoCo takes the larger coefficient of sole and ground.
    model.geom_priority[soles] = 1
    if around.friction is not None:
        model.geom_friction[soles, 0] = around.friction
    return model


def _part(spec: Any, plant: HiddenPlant, effect: Hidden) -> Any:
    """The `MjsJoint` or `MjsBody` of a `mujoco.MjSpec` that an effect changes."""
    if effect.kind.place == "joint":
        plant.joint(effect.place)
        return spec.joint(effect.place)
    body = spec.body(effect.place)
    if body is None:
        known = [other.name for other in spec.bodies if other.name != "world"]
        raise UnknownNameError("body", effect.place, known)
    return body

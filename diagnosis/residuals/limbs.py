"""Splits a robot model into limbs that move independently of each other.

The arms and legs of a robot whose torso is held do not influence each other. To judge
missing physics at an elbow, only that arm needs to be simulated, which is faster.
"""

from dataclasses import dataclass, replace

import mujoco

from diagnosis.effects.parts import PlacedEffect
from diagnosis.plant.plant import Plant
from diagnosis.residuals.channels import Channels
from diagnosis.traces.windows import Run


@dataclass(frozen=True, eq=False)
class Limb:
    """A part of a robot model that moves independently, itself a robot model.

    Attributes:
      plant: the model with the joints of this limb only.
      columns: indices of these joints in the whole model.
      first: whether the channels that belong to no joint, such as the gyroscope, are
        taken from this limb's simulation.
      elsewhere: names of the joints and bodies of the other limbs.
    """

    plant: Plant
    columns: tuple[int, ...]
    first: bool
    elsewhere: frozenset[str]

    def felt(self, model: tuple[PlacedEffect, ...]) -> tuple[PlacedEffect, ...]:
        """The effects of a model whose place is not at another limb."""
        return tuple(one for one in model if one.place not in self.elsewhere)

    def run(self, run: Run) -> Run:
        """The part of a window of the whole robot that belongs to this limb."""
        columns = list(self.columns)
        before, rising = run.before_rad, run.acceleration_rad_s2
        return replace(
            run,
            trace=run.trace.of(columns),
            position_rad=run.position_rad[columns],
            velocity_rad_s=run.velocity_rad_s[columns],
            whole=run.whole and run.whole.of(columns),
            before_rad=None if before is None else before[:, columns],
            acceleration_rad_s2=None if rising is None else rising[columns],
        )

    def channels(self, whole: Channels) -> tuple[Channels, list[int]]:
        """This limb's channels, and their indices among those of the whole robot."""
        mine = set(self.plant.joints)
        chosen = [
            i
            for i, name in enumerate(whole.names)
            if (_joint_of(name) in mine if _joint_of(name) else self.first)
        ]
        names = tuple(whole.names[i] for i in chosen)
        return Channels(names, whole.noise[chosen], whole.floor[chosen]), chosen


def _joint_of(channel: str) -> str | None:
    """The joint that a channel belongs to; None for channels of the whole robot."""
    kind, _, joint = channel.partition(".")
    return joint if kind in ("position", "torque") else None


def limbs_of(plant: Plant) -> tuple[Limb, ...]:
    """The limbs of a robot model; the whole model if its parts influence each other."""
    parts = _coupled_trees(plant.model) if plant.base == "fixed" else []
    if not parts:
        return (Limb(plant, tuple(range(len(plant.joints))), True, frozenset()),)
    plants = [_with_trees(plant, part) for part in parts]
    names = [frozenset((*one.joints, *one.bodies)) for one in plants]
    return tuple(
        Limb(
            one,
            tuple(plant.joints.index(joint) for joint in one.joints),
            i == 0,
            frozenset().union(*names[:i], *names[i + 1 :]),
        )
        for i, one in enumerate(plants)
    )


def _coupled_trees(model: mujoco.MjModel) -> list[set[int]]:
    """Sets of kinematic trees that constraints couple; empty if contacts may, too."""
    touchable = model.geom_contype.any() and model.geom_conaffinity.any()
    off = model.opt.disableflags & mujoco.mjtDisableBit.mjDSBL_CONTACT
    if (touchable and not off) or model.ntendon or model.nflex:
        return []
    parts = [{tree} for tree in range(model.ntree)]
    for i in range(model.neq):
        ends = [e for e in (model.eq_obj1id[i], model.eq_obj2id[i]) if e >= 0]
        tied = set(range(model.ntree))
        if model.eq_type[i] == mujoco.mjtEq.mjEQ_JOINT:
            tied = {int(model.dof_treeid[model.jnt_dofadr[e]]) for e in ends}
        touched = [part for part in parts if part & tied]
        rest = [part for part in parts if not part & tied]
        parts = [*rest, set().union(*touched)] if touched else rest
    return sorted(parts, key=min)


def _with_trees(plant: Plant, kept: set[int]) -> Plant:
    """The model with only the kinematic trees `kept`, without shapes and sensors."""
    model, spec = plant.model, plant.spec.copy()
    _without_shapes(spec, model)
    tree = model.body_treeid
    roots = [
        model.body(i).name
        for i in range(1, model.nbody)
        if tree[i] >= 0 and tree[i] not in kept and tree[model.body_parentid[i]] < 0
    ]
    for name in roots:
        spec.delete(spec.body(name))
    columns = [
        i for i, dof in enumerate(plant.dofs) if int(model.dof_treeid[dof]) in kept
    ]
    return replace(
        plant,
        spec=spec,
        joints=tuple(plant.joints[i] for i in columns),
        servo=plant.servo.of(columns),
        feet=tuple(f for f in plant.feet if int(tree[model.body(f).id]) in kept),
    )


def _without_shapes(spec: mujoco.MjSpec, model: mujoco.MjModel) -> None:
    """Remove shapes and sensors, which a limb does not need, but keep all inertias."""
    for body in spec.bodies[1:]:
        compiled = model.body(body.name)
        body.explicitinertial = True
        body.fullinertia = [float("nan")] * 6
        body.mass, body.ipos = float(compiled.mass[0]), compiled.ipos
        body.inertia, body.iquat = compiled.inertia, compiled.iquat
    for shape in list(spec.geoms):
        spec.delete(shape)
    spec.option.disableflags |= mujoco.mjtDisableBit.mjDSBL_SENSOR

"""The torques that motors must give for a measured motion, by the laws of all effects.

A replay asks which motion follows from a torque; here the motion is known, and the
torque is asked for (inverse dynamics). MuJoCo computes that of the robot model. Dry
friction, and what else MuJoCo leaves out, is added by the laws that replays follow as
well. Controllers, play, stops and contacts change nothing here: the motion holds what
they did.
"""

import copy
from collections import OrderedDict
from collections.abc import Callable, Mapping, Sequence
from operator import attrgetter
from typing import NamedTuple

import mujoco
import numpy as np
from scipy.interpolate import CubicSpline

from diagnosis.effects.variants import Variants
from diagnosis.plant.loads import model_under
from diagnosis.plant.plant import Plant, inverse_dynamics, links_torque_nm
from diagnosis.replay.dry_friction import SHARES_OF_LINKS, DryFriction, depends_on
from diagnosis.replay.presliding import torque_along
from diagnosis.traces.trace import Trace
from groundwalk.arrays import FloatArray
from worlds.recordings.load import Load

PASSIVE = "dof_damping", "dof_armature", "jnt_stiffness", "qpos_spring"
"""Fields of MuJoCo's model whose torques are linear in the motion: they are added
without computing the whole inverse dynamics again."""

MOST_KEPT = 200
"""Number of results of inverse dynamics that are kept, since most models that are
compared differ in friction only."""


PER_BLOCK = 16
"""Number of rows of a block, over which torques are averaged, at which they are
computed; between these rows they are interpolated."""


class _Moved(NamedTuple):
    """Positions, velocities and accelerations (rows, j) at which torques are found."""

    position: FloatArray
    velocity: FloatArray
    acceleration: FloatArray


class NeededTorques:
    """Computes the torques that the motion in some recordings needs."""

    def __init__(self, plant: Plant, traces: Sequence[Trace]) -> None:
        """Take the motion of traces, all of which have one."""
        motions = [trace.motion for trace in traces if trace.motion is not None]
        assert len(motions) == len(traces)
        self._plant = plant
        self._whole_s = [trace.time_s for trace in traces]
        steps = [max(1, motion.block_rows // PER_BLOCK) for motion in motions]
        rows = [
            np.unique([*range(0, trace.ticks, step), trace.ticks - 1])
            for trace, step in zip(traces, steps, strict=True)
        ]
        thin = list(zip(motions, rows, strict=True))
        self._moved = _Moved(
            _stacked([one.position_rad[own] for one, own in thin]),
            _stacked([one.velocity_rad_s[own] for one, own in thin]),
            _stacked([one.acceleration_rad_s2[own] for one, own in thin]),
        )
        times = [trace.time_s[own] for trace, own in zip(traces, rows, strict=True)]
        self._time_s = np.concatenate(times)
        self._earlier = [_earlier_rad(trace) for trace in traces]
        ends = np.cumsum([len(own) for own in rows])
        self._parts = [slice(e - len(r), e) for e, r in zip(ends, rows, strict=True)]
        loads = [trace.loads for trace in traces]
        self._by_load: list[tuple[slice, Mapping[str, Load]]] = (
            list(zip(self._parts, loads, strict=True))
            if any(loads)
            else [(slice(None), {})]
        )
        self._kept: OrderedDict[tuple[object, ...], FloatArray] = OrderedDict()
        self._jacobians: dict[int, FloatArray] = {}

    def of(self, variants: Variants) -> FloatArray:
        """(n, rows, j) torques [N m] for n variants of the robot model, at all rows."""
        each = [self._whole(self._one(variants, row)) for row in range(variants.n)]
        return np.stack(each)

    def _whole(self, torque: FloatArray) -> FloatArray:
        """(rows of the traces, j) torques, interpolated between those computed."""
        if len(torque) == sum(map(len, self._whole_s)):
            return torque
        parts = []
        for time_s, rows in zip(self._whole_s, self._parts, strict=True):
            known = self._time_s[rows], torque[rows].T
            parts += [np.stack([np.interp(time_s, known[0], one) for one in known[1]])]
        return np.concatenate(parts, axis=1).T

    def _one(self, variants: Variants, row: int) -> FloatArray:
        """(rows, j) torques for one variant."""
        joints = {name: one[row] for name, one in vars(variants.joints).items()}
        moved = self._timely(joints["late_s"])
        moved = moved._replace(position=moved.position - joints["offset_rad"])
        torque = self._rigid(variants, row, moved)
        torque = torque + self._passive(variants, row, moved)
        torque += self._outside(variants, row)
        for effect, values in variants.torques.items():
            every = np.broadcast_to(values[row], (len(torque), *values[row].shape))
            now = moved.position, moved.velocity, self._time_s[:, None]
            torque -= effect.torque_nm(every, *now)
        torque += self._bending(joints, moved.position)
        loss = variants.fields.get("dof_frictionloss")
        dry = self._plant.model.dof_frictionloss if loss is None else loss[row]
        dry = dry[self._plant.dofs] + joints["coulomb_nm"]
        way, links_nm = np.sign(moved.velocity), self._links(variants, row, moved)
        rubs = DryFriction(joints, moved.velocity, links_nm, moved.position)
        torque = rubs.needed_nm(torque + way * dry, way)
        return self._late(torque * joints["torque_factor"], variants, row)

    def _timely(self, late_s: FloatArray) -> "_Moved":
        """The motion as it was at the rows' times, of joints that are read late (j,).

        How late all joints are together is left to `_late`.
        """
        moved = self._moved
        for j in np.flatnonzero(late_s):
            moved = _Moved(*(one.copy() for one in moved))
            for rows in self._parts:
                time_s = self._time_s[rows]
                later = np.clip(time_s + late_s[j], time_s[0], time_s[-1])
                for one in moved:
                    one[rows, j] = CubicSpline(time_s, one[rows, j])(later)
        return moved

    def _rigid(self, variants: Variants, row: int, moved: "_Moved") -> FloatArray:
        """(rows, j) torques of a variant's bodies, and of all that is nominal."""
        return self._of_bodies(inverse_dynamics, variants, row, moved)

    def _links(
        self, variants: Variants, row: int, moved: "_Moved"
    ) -> FloatArray | float:
        """(rows, j) torques that a variant's links put on joints; 0.0 if not needed."""
        joints = {name: one[row] for name, one in vars(variants.joints).items()}
        if not depends_on(joints, SHARES_OF_LINKS):
            return 0.0
        return self._of_bodies(_by_links, variants, row, moved)

    def _of_bodies(
        self,
        law: Callable[..., FloatArray],
        variants: Variants,
        row: int,
        moved: "_Moved",
    ) -> FloatArray:
        """(rows, j) torques of a law by a variant's bodies and each trace's loads."""
        changed = {k: v[row] for k, v in variants.fields.items() if k not in PASSIVE}
        joints = variants.joints
        own = joints.offset_rad[row].tobytes(), joints.late_s[row].tobytes()
        key = (law, *own, *(v.tobytes() for v in changed.values()))
        if key not in self._kept:
            model, each = model_with(self._plant, changed), []
            for rows, loads in self._by_load:
                under = model_under(self._plant, loads, model)
                each.append(law(self._plant, under, *(one[rows] for one in moved)))
            self._kept[key] = np.concatenate(each)
            if len(self._kept) > MOST_KEPT:
                self._kept.popitem(last=False)
        return self._kept[key]

    def _passive(self, variants: Variants, row: int, moved: "_Moved") -> FloatArray:
        """(rows, j) torques against changed damping, rotor inertias and springs."""
        plant, model = self._plant, self._plant.model
        hinges = [int(model.joint(name).id) for name in plant.joints]
        indices = (plant.dofs, plant.dofs, hinges, plant.qpos)
        columns = dict(zip(PASSIVE, indices, strict=True))
        before = {name: getattr(model, name)[columns[name]] for name in PASSIVE}
        now = {
            name: variants.fields[name][row][columns[name]]
            if name in variants.fields
            else before[name]
            for name in PASSIVE
        }
        torque = (now["dof_damping"] - before["dof_damping"]) * moved.velocity
        more_kg_m2 = now["dof_armature"] - before["dof_armature"]
        torque = torque + more_kg_m2 * moved.acceleration
        springs = [
            one["jnt_stiffness"] * (moved.position - one["qpos_spring"])
            for one in (before, now)
        ]
        return np.asarray(torque + springs[1] - springs[0])

    def _bending(
        self, joints: Mapping[str, FloatArray], position_rad: FloatArray
    ) -> FloatArray | float:
        """(rows, j) torques of friction that bends first; 0.0 without any."""
        own = np.flatnonzero(joints["slip_nm"])
        if not own.size:
            return 0.0
        torque = np.zeros_like(position_rad)
        law = joints["slip_nm"][own], joints["slip_rad"][own]
        for rows, earlier in zip(self._parts, self._earlier, strict=True):
            before = None if earlier is None else earlier[:, own]
            torque[rows, own] = torque_along(*law, position_rad[rows][:, own], before)
        return torque

    def _outside(self, variants: Variants, row: int) -> FloatArray | float:
        """(rows, j) torques against pushes and drag; 0.0 without any."""
        torque: FloatArray | float = 0.0
        for push in variants.outside.pushes[row]:
            jacobian = self._jacobian(int(self._plant.model.body(push.body).id))
            since_s = self._time_s - push.start_s
            acts = (since_s >= 0) & (since_s < push.duration_s)
            torque = torque - acts[:, None] * (np.array(push.force_n) @ jacobian)
        for body in np.flatnonzero(variants.outside.drag_n_s_m[row]):
            jacobian = self._jacobian(int(body))
            speed = np.einsum("rxj,rj->rx", jacobian, self._moved.velocity)
            drag_n = variants.outside.drag_n_s_m[row, body] * speed
            torque = torque + np.einsum("rxj,rx->rj", jacobian, drag_n)
        return torque

    def _jacobian(self, body: int) -> FloatArray:
        """(rows, 3, j) derivatives of the velocity of a body's centre of mass."""
        if body not in self._jacobians:
            plant, model = self._plant, self._plant.model
            data, whole = mujoco.MjData(model), np.zeros((3, model.nv))
            found = np.empty((len(self._moved.position), 3, len(plant.joints)))
            for row, position in enumerate(self._moved.position):
                data.qpos[plant.qpos] = position
                mujoco.mj_kinematics(model, data)
                mujoco.mj_comPos(model, data)
                mujoco.mj_jacBodyCom(model, data, whole, None, body)
                found[row] = whole[:, plant.dofs]
            self._jacobians[body] = found
        return self._jacobians[body]

    def _late(self, torque: FloatArray, variants: Variants, row: int) -> FloatArray:
        """(rows, j) torques beside late encoders, which show them before the motion."""
        late_s = float(variants.signals.sensor_delay_s[row])
        if late_s == 0:
            return torque
        for rows in self._parts:
            time_s = self._time_s[rows]
            # a straight line between rows would smooth, and so take noise away
            later = np.minimum(time_s + late_s, time_s[-1])
            torque[rows] = CubicSpline(time_s, torque[rows])(later)
        return torque


def _by_links(plant: Plant, model: mujoco.MjModel, *motion: FloatArray) -> FloatArray:
    """(rows, j) torques that links put on joints; accelerations are left out."""
    return links_torque_nm(plant, model, *motion[:2])


def _earlier_rad(trace: Trace) -> FloatArray | None:
    """(rows, j) smoothed positions just before a part of a recording, if known."""
    before = trace.before
    if before is None or before.motion is None:
        return None
    return before.motion.position_rad


def _stacked(parts: Sequence[FloatArray]) -> FloatArray:
    """(rows, j) values of all motions, missing ones as 0."""
    return np.asarray(np.nan_to_num(np.concatenate(parts)))


def model_with(plant: Plant, fields: dict[str, FloatArray]) -> mujoco.MjModel:
    """The compiled model of a robot with other values of some of its fields."""
    if not fields:
        return plant.model
    model = copy.copy(plant.model)
    for name, values in fields.items():
        target = attrgetter(name)(model)
        target[:] = values.reshape(target.shape)
    mujoco.mj_setConst(model, mujoco.MjData(model))
    return model

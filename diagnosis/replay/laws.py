"""Applies servos and all effects that MuJoCo lacks to a batch of simulations."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from diagnosis.effects.variants import Variants
from diagnosis.plant.loads import Inertias, carry
from diagnosis.plant.plant import Plant
from diagnosis.plant.servo import Servo
from diagnosis.replay.columns import columns
from diagnosis.replay.controllers import CONTROLLED, BatchControllers, HeldTorques
from diagnosis.replay.dry_friction import depends_on
from diagnosis.replay.joint_friction import BatchFriction
from diagnosis.replay.outside import OutsideForces
from diagnosis.replay.presliding import BatchPresliding
from diagnosis.replay.servos import (
    BatchServos,
    Ends,
    first_share,
)
from diagnosis.replay.set_points import SetPoints
from diagnosis.replay.transmission import BatchGaps, ElasticJoints
from groundwalk.arrays import FloatArray
from worlds.recordings.load import Load


class BatchLaws:
    """Torques and forces at every step of n R simulations: n variants in R runs.

    Attributes:
      joints: arrays (n R, j) of `Joints` by name, a row for each simulation, sorted by
        variant, then by run.
      outside: pushes and drag; call its `apply` at every step, too.
    """

    def __init__(
        self,
        batch: Any,
        variants: Variants,
        servos: Sequence[Servo],
        step_s: float,
        loads: Sequence[Mapping[str, Load]] = (),
    ) -> None:
        """Set the constants of all simulations; call `begin` once they have states.

        The `batch` has n R simulations of n variants with the servos of R runs, sorted
        by variant, and with the `loads` of R runs, if there are any.
        """
        plant, runs = variants.plant, len(servos)
        self._batch, self._step_s = batch, step_s
        self._dofs, self._columns = columns(plant.dofs), columns(plant.qpos)
        self._actuators = columns(plant.actuators)
        self._qpos, self._qvel, self._ctrl = map(self._bind, ("qpos", "qvel", "ctrl"))
        self.joints = joints = {
            name: np.repeat(values, runs, axis=0)
            for name, values in vars(variants.joints).items()
        }
        for name, values in variants.fields.items():
            self._expand(name)[:] = np.repeat(values, runs, axis=0)
        self._carry(plant, loads)
        self._rotor_kg_m2 = self._rotors()
        self._batch.set_const()
        self._servos = BatchServos(batch, plant, servos, joints, step_s)
        damping = self._servos.damping_nm_s_rad
        self._friction = BatchFriction(batch, plant, joints, damping, step_s)
        # most variants have none of these effects, so computing them is skipped
        self._set_points = SetPoints(joints, step_s)
        self._slews = bool(self._set_points.limited.any())
        self._stiff = np.isinf(joints["spring_nm_rad"])
        loose = bool(joints["gap_rad"].any())
        self._gaps = BatchGaps(joints, self._servos.law, step_s) if loose else None
        self._controllers: BatchControllers | None = None
        if depends_on(joints, CONTROLLED):
            self._controllers = BatchControllers(joints, self._servos.law, step_s)
            self._held = HeldTorques(plant.model, batch)
        bends = bool(joints["slip_nm"].any())
        self._presliding = BatchPresliding(joints, step_s) if bends else None
        self._torques = [
            (effect, np.repeat(values, runs, axis=0))
            for effect, values in variants.torques.items()
        ]
        self._adds = bends or bool(self._torques)
        # bind before the first step: a later view would lag by one step
        self._force = self._bind("actuator_force")
        self._applied = self._bind("qfrc_applied")
        self.outside = OutsideForces(batch, variants, runs, step_s)
        self._elastic: ElasticJoints | None = None
        self._is_new = True

    def begin(
        self,
        asked_rad: FloatArray | None = None,
        before_rad: Sequence[FloatArray | None] = (),
        rising: Sequence[FloatArray | None] = (),
    ) -> None:
        """Begin, or begin again, in the state that the simulations are in.

        `asked_rad` are the (n R, j) position targets so far; None for those of the
        first step. `before_rad` has for each run its joints' motion (rows, j) up to its
        start, which friction remembers, and `rising` their accelerations (j,) [rad/s^2]
        there, which tell the torques of integral terms; None where nothing is known.
        """
        offset = self.joints["offset_rad"]
        self._set_points.begin(None if asked_rad is None else asked_rad - offset)
        if self._gaps is not None:
            self._gaps.begin()
        if self._presliding is not None:
            self._presliding.begin(before_rad)
        if self._controllers is not None:
            needed = self._start_nm(rising) if self._controllers.remembers else None
            self._controllers.begin(needed)
        self.outside.begin()
        self._is_new = True
        is_first = self._elastic is None
        if np.isfinite(self.joints["spring_nm_rad"]).any():
            law, inertia = self._servos.law, self._rotor_kg_m2
            self._elastic = ElasticJoints(self.joints, law, inertia)
            if is_first:
                self._servos.soften(self._elastic, self._step_s)

    def servo(
        self, asked_rad: FloatArray, time_s: FloatArray, ends: Ends | None = None
    ) -> None:
        """Set the controls of the servos, and dry friction, for one physics step.

        Args:
          asked_rad: (n R, j) mean position targets of the step, in measured angles.
          time_s: (R,) times at which the step begins.
          ends: targets as the step begins and ends, if any jumps within it.
        """
        position, velocity = self.joint_state()
        offset = self.joints["offset_rad"]
        asked_rad = mean_rad = asked_rad - offset
        self._feel(asked_rad, position)
        if self._servos.varies:
            self._servos.weaken(time_s, self._driven_nm(velocity))
        if ends is not None:
            ends = ends[0] - offset, ends[1] - offset
            seen_rad = self.encoder_rad()
            asked_rad = self._servos.equal(mean_rad, ends, seen_rad, velocity)
        if self._slews:
            both, limited = ends or (mean_rad, mean_rad), self._set_points.limited
            slewed_rad = self._set_points.through(first_share(mean_rad, both), both)
            asked_rad = np.where(limited, slewed_rad, asked_rad)
            mean_rad = np.where(limited, slewed_rad, mean_rad)
        if self._friction.varies:
            self._rub(position, velocity, 0.0)
        if self._controllers is not None:
            seen = self.encoder_rad(), self.encoder_rad_s()
            if self._gaps is not None:
                seen = self._gaps.seen(*seen)
            asked_rad = self._controllers.through(asked_rad, mean_rad, *seen)
        if self._gaps is not None:
            asked_rad, free_nm = self._gaps.through(asked_rad, position, velocity)
            self._applied[:, self._dofs] = free_nm
        if self._adds:
            already = 0.0 if self._gaps is None else self._applied[:, self._dofs]
            own_nm = self._own_nm(position, velocity, time_s)
            self._applied[:, self._dofs] = already + own_nm
        if self._elastic is not None:
            asked_rad = self._elastic.drive(asked_rad, position, velocity, self._step_s)
        self._servos.limit(asked_rad, position, velocity)
        self._ctrl[:, self._actuators] = asked_rad

    def jumps(self, ends: Ends | None) -> list[Ends | None]:
        """For each of B steps its targets (n R, j) as it begins and ends, if any jumps.

        `ends` (B, n R, j) are the targets of all steps.
        """
        if ends is None:
            return []
        jumps = np.abs(ends[1] - ends[0]) > self._servos.least_jump_rad
        each = zip(*ends, np.any(jumps, axis=(1, 2)), strict=True)
        return [(before, after) if far else None for before, after, far in each]

    def push_joints(self, torque_nm: FloatArray, time_s: FloatArray) -> None:
        """Apply motor torques (n R, j) to joints without servos, at (R,) times [s]."""
        torque_nm = torque_nm * self._servos.on_share(time_s)
        position, velocity = self.joint_state()
        if self._elastic is not None:
            self._ctrl[:, self._actuators] = self._elastic.drive(
                position, position, velocity, self._step_s, torque_nm
            )
            torque_nm = np.where(self._elastic.soft, 0.0, torque_nm)
        if self._friction.varies:
            self._rub(position, velocity, torque_nm)
        if self._adds:
            torque_nm = torque_nm + self._own_nm(position, velocity, time_s)
        self._applied[:, self._dofs] = torque_nm

    def add_to_joints(self, torque_nm: FloatArray) -> None:
        """Add (n R, j) torques [N m] to those of the servos; call `servo` before."""
        set_before = self._gaps is not None or self._adds
        already = self._applied[:, self._dofs] if set_before else 0.0
        self._applied[:, self._dofs] = already + torque_nm

    def joint_state(self) -> tuple[FloatArray, FloatArray]:
        """Joint positions [rad] and velocities [rad/s], (n R, j) views of the batch."""
        return self._qpos[:, self._columns], self._qvel[:, self._dofs]

    def encoder_rad(self) -> FloatArray:
        """(n R, j) angles [rad] of joints or, if elastic, of motors; without offset."""
        position = self._qpos[:, self._columns]
        return position if self._elastic is None else self._elastic.seen(position)

    def encoder_rad_s(self) -> FloatArray:
        """(n R, j) speeds [rad/s] of joints or, if elastic, of motors."""
        velocity = self._qvel[:, self._dofs]
        return velocity if self._elastic is None else self._elastic.seen_speed(velocity)

    def _start_nm(self, rising: Sequence[FloatArray | None]) -> FloatArray:
        """(n R, j) torques [N m] that servos give at the start, see `begin`.

        What drag, pushes, presliding and friction by load add is left out.
        """
        position, velocity = self.joint_state()
        every = np.zeros_like(self._qvel)
        if rising:
            steady = np.zeros(velocity.shape[1])
            own = [steady if one is None else one for one in rising]
            every[:, self._dofs] = np.tile(own, (len(position) // len(own), 1))
        needed = self._held.at(every)[:, self._dofs]
        start = np.zeros((len(position), 1))
        for effect, values in self._torques:
            needed = needed - effect.torque_nm(values, position, velocity, start)
        return np.asarray(needed + self._servos.law["kd"] * velocity)

    def _rub(
        self,
        position: FloatArray,
        velocity: FloatArray,
        added_nm: FloatArray | float,
    ) -> None:
        """Set dry friction by joint angle, speed and the torque through the gear.

        `added_nm` (n R, j) are torques of motors without a servo.
        """
        driven_nm = self._driven_nm(velocity) + added_nm
        self._friction.follow(position, velocity, driven_nm)

    def _feel(self, asked_rad: FloatArray, position: FloatArray) -> None:
        """Give motors their torques (n R, j) before the first step, if it needs them.

        Springs between motors and joints begin without any.
        """
        needed = self._is_new and (self._friction.varies or self._servos.varies)
        self._is_new = False
        if needed:
            self._ctrl[:, self._actuators] = np.where(self._stiff, asked_rad, position)
            self._batch.forward()

    def _driven_nm(self, velocity: FloatArray) -> FloatArray:
        """(n R, j) torques [N m] of servos through their gears, in the step before.

        Each is the motor's minus its back-EMF, or the spring's at an elastic joint.
        """
        induced_nm = np.where(self._stiff, self._servos.law["emf"] * velocity, 0.0)
        return np.asarray(self._force[:, self._actuators] - induced_nm)

    def _own_nm(
        self, position: FloatArray, velocity: FloatArray, time_s: FloatArray
    ) -> FloatArray:
        """(n R, j) torques [N m] of each `TorqueEffect` and of presliding friction."""
        times_s = np.tile(time_s, len(position) // len(time_s))[:, None]
        torques = [
            effect.torque_nm(values, position, velocity, times_s)
            for effect, values in self._torques
        ]
        if self._presliding is not None:
            own = self._servos.inertia_kg_m2, self._servos.damping_nm_s_rad
            bending_nm, damping = self._presliding.step(position, velocity, *own)
            self._servos.damp_more(damping)
            torques.append(bending_nm)
        return np.asarray(sum(torques, np.zeros_like(velocity)))

    def _bind(self, name: str) -> FloatArray:
        """View of a field of `MjData` of all simulations; it changes as they step."""
        return np.asarray(self._batch.bind(name))

    def _expand(self, name: str) -> FloatArray:
        """View of a field of `MjModel` with a row per simulation, to be changed."""
        return np.asarray(self._batch.expand(name))

    def _carry(self, plant: Plant, loads: Sequence[Mapping[str, Load]]) -> None:
        """Add the loads of R runs to the bodies of their simulations."""
        if any(loads):
            inertias = [self._expand(name) for name in Inertias._fields]
            for run, own in enumerate(loads):
                part = (one[run :: len(loads)] for one in inertias)
                carry(Inertias(*part), plant, own)

    def _rotors(self) -> FloatArray:
        """Rotor inertias (n R, j); moves those of elastic joints out of the links.

        MuJoCo's `set_const` must follow: it computes constants from the inertias.
        """
        armature = self._expand("dof_armature")
        inertia = armature[:, self._dofs].copy()
        stiff = np.isinf(self.joints["spring_nm_rad"])
        armature[:, self._dofs] = np.where(stiff, inertia, 0.0)
        return inertia

"""A batch of simulations, one per variant and run, and the laws MuJoCo lacks."""

from collections.abc import Sequence

import numpy as np

from diagnosis.batch_friction import BatchFriction
from diagnosis.batch_servos import BatchServos
from diagnosis.elastic import ElasticJoints
from diagnosis.outside_forces import OutsideForces
from diagnosis.replay_tape import Tape
from diagnosis.run import Run
from diagnosis.variants import Variants
from groundwalk.arrays import FloatArray


class ReplayBatch:
    """n variants times R runs, variant by variant."""

    def __init__(
        self,
        runs: Sequence[Run],
        variants: Variants,
        step_s: float,
        threads: int,
    ) -> None:
        """Put every simulation into the state that its run starts from."""
        from mujoco.batch import Batch

        plant = variants.plant
        self.plant, self.step_s = plant, step_s
        self.n, self.count = variants.n * len(runs), len(runs)
        self._batch = Batch(plant.model, self.n, threads)
        self._expand("opt.timestep")[:] = step_s
        self.qpos, self.qvel, self._ctrl = map(self.bind, ("qpos", "qvel", "ctrl"))
        self._dofs, self._columns = plant.dofs, plant.qpos
        self._actuators = plant.actuators
        self._joints = joints = {
            name: np.repeat(values, len(runs), axis=0)
            for name, values in vars(variants.joints).items()
        }
        for name, values in variants.fields.items():
            self._expand(name)[:] = np.repeat(values, len(runs), axis=0)
        rotor_kg_m2 = self._rotors()
        self._batch.set_const()
        self._servos = BatchServos(self._batch, plant, runs, joints)
        self._friction = BatchFriction(self._batch, plant, joints, step_s)
        # most variants have none of these laws: they cost nothing then
        self._slews = bool(np.isfinite(joints["setpoint_speed_rad_s"]).any())
        self._gaps = bool(joints["gap_rad"].any())
        self._setpoint: FloatArray | None = None
        # what is bound later than the start would know of the start a step late
        self._force = self.bind("actuator_force")
        self._applied = self.bind("qfrc_applied")
        self._outside = OutsideForces(self._batch, variants, len(runs), step_s)
        self._start(runs)
        self._elastic = ElasticJoints.of(joints, self._servos.law, rotor_kg_m2)
        if self._elastic is not None:
            self._servos.soften(self._elastic, step_s)

    def tape(self, steps: int) -> Tape:
        """What notes positions and velocities of so many steps."""
        return Tape(self, steps)

    def servo(self, asked_rad: FloatArray, time_s: FloatArray) -> None:
        """Set the controls of one step.

        Args:
          asked_rad: (n R, j) position targets, as the encoders have it.
          time_s: (R,) now; fading servos need it.
        """
        asked_rad = asked_rad - self._joints["offset_rad"]
        if self._slews:
            asked_rad = self._slewed(asked_rad)
        if self._servos.fades:
            self._servos.fade(time_s)
        position, velocity = self.joint_state()
        if self._friction.varies:
            self._friction.follow(velocity, self._force[:, self._actuators])
        if self._gaps:
            asked_rad = self._through_gap(asked_rad, position, velocity)
        if self._elastic is not None:
            asked_rad = self._elastic.drive(asked_rad, position, velocity, self.step_s)
        self._ctrl[:, self._actuators] = asked_rad

    def push_joints(self, torque_nm: FloatArray) -> None:
        """Apply (n R, j) torques where no servo drives."""
        position, velocity = self.joint_state()
        if self._elastic is not None:
            self._ctrl[:, self._actuators] = self._elastic.drive(
                position, position, velocity, self.step_s, torque_nm
            )
            torque_nm = np.where(self._elastic.soft, 0.0, torque_nm)
        if self._friction.varies:
            driven_nm = self._force[:, self._actuators] + torque_nm
            self._friction.follow(velocity, driven_nm)
        self._applied[:, self._dofs] = torque_nm

    def push_bodies(self, time_s: FloatArray) -> None:
        """Apply forces from outside at (R,) times."""
        self._outside.apply(time_s)

    def step(self) -> None:
        """One step of physics; what blows up becomes NaN."""
        from mujoco.batch import SimulationError

        try:
            self._batch.step()
        except SimulationError as error:
            self.qpos[error.ids] = np.nan

    def joint_state(self) -> tuple[FloatArray, FloatArray]:
        """(n R, j) positions and velocities."""
        return self.qpos[:, self._columns], self.qvel[:, self._dofs]

    def encoder_rad(self) -> FloatArray:
        """(n R, j) positions on the encoders' side, without offsets."""
        position = self.qpos[:, self._columns]
        return position if self._elastic is None else self._elastic.seen(position)

    def bind(self, name: str) -> FloatArray:
        """A live view of a field of the simulations."""
        return np.asarray(self._batch.bind(name))

    def _expand(self, name: str) -> FloatArray:
        return np.asarray(self._batch.expand(name))

    def _start(self, runs: Sequence[Run]) -> None:
        n = self.n // self.count
        measured = np.tile([run.position_rad for run in runs], (n, 1))
        self.qpos[:, self._columns] = measured - self._joints["offset_rad"]
        self.qvel[:, self._dofs] = np.tile([run.velocity_rad_s for run in runs], (n, 1))
        bases = [run.base for run in runs if run.base is not None]
        if bases:
            base = np.tile(bases, (n, 1))
            self.qpos[:, :7], self.qvel[:, :6] = base[:, :7], base[:, 7:]
        self._batch.forward()

    def _slewed(self, asked_rad: FloatArray) -> FloatArray:
        if self._setpoint is None:
            self._setpoint = asked_rad.copy()
        most = self._joints["setpoint_speed_rad_s"] * self.step_s
        change = np.minimum(np.maximum(asked_rad - self._setpoint, -most), most)
        self._setpoint = self._setpoint + change
        return self._setpoint

    def _through_gap(
        self, asked_rad: FloatArray, position: FloatArray, velocity: FloatArray
    ) -> FloatArray:
        """Targets that give the torque of the error less the gap; none within it."""
        half = self._joints["gap_rad"] / 2
        error = asked_rad - position
        within = (np.abs(error) < half) & (half > 0)
        damping = self._servos.law["kd"] + self._servos.law["emf"]
        self._applied[:, self._dofs] = np.where(within, damping * velocity, 0.0)
        felt = np.sign(error) * np.maximum(np.abs(error) - half, 0.0)
        return np.asarray(position + felt)

    def _rotors(self) -> FloatArray:
        """Armatures; those of elastic joints turn beside their links, not with them.

        To be taken out before `set_const`, which the mass matrix of bodies with one
        simple joint is from.
        """
        armature = self._expand("dof_armature")
        inertia = armature[:, self._dofs].copy()
        stiff = np.isinf(self._joints["spring_nm_rad"])
        armature[:, self._dofs] = np.where(stiff, inertia, 0.0)
        return inertia

"""The deterministic world "sim": MuJoCo computes many robots in one batch."""

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from groundwalk.arrays import FloatArray
from groundwalk.errors import BadValueError
from robots.description import Description
from robots.engine_models.mjcf import ROOT_JOINT, mujoco_spec, quiet_mujoco
from robots.sole import contact_points, contact_shares
from terrain import Heightfield
from worlds.observation import Observation, Truth
from worlds.rollouts import RolloutWorld, Schedule
from worlds.soft_ground import FootSpring, soften_mujoco
from worlds.world import TICK_S, WorldOptions

if TYPE_CHECKING:
    import mujoco
    from mujoco.batch import Batch

ROOT_QPOS, ROOT_QVEL = 7, 6
"""How many entries of MuJoCo's `qpos` (x, y, z, quaternion) and `qvel` (linear, angular
velocity) belong to a floating base; those of the joints follow."""
_BASE_THICKNESS_M = 1.0
"""Thickness of a heightfield below its lowest point [m], so that no foot can pass
through it in one physics step."""


def mujoco_model(
    description: Description, options: WorldOptions, ground: Heightfield | None
) -> "mujoco.MjModel":
    """Compile a MuJoCo model of a robot, on ground or, for None, without.

    Of the options, time step, friction, sinkage and fixed base are used.
    """
    grounds = [] if ground is None else [ground]
    model = world_spec(description, options, grounds).compile()
    if options.sinkage_m:
        spring = FootSpring.sinking(description, options.sinkage_m)
        soften_mujoco(model, description, spring)
    return model


def world_spec(
    description: Description, options: WorldOptions, grounds: Sequence[Heightfield]
) -> "mujoco.MjSpec":
    """A MuJoCo specification, not yet compiled, of a robot and any grounds.

    Of the options, time step, friction and fixed base are used. All grounds become
    geoms in the one world, named by `ground_name`.
    """
    import mujoco

    quiet_mujoco()  # a world reports itself that its physics diverged
    spec = mujoco_spec(description)
    spec.option.timestep = options.timestep_s
    # A diverged robot must show its NaN instead of starting again unnoticed.
    spec.option.disableflags |= int(mujoco.mjtDisableBit.mjDSBL_AUTORESET)
    spec.compiler.discardvisual = True
    if options.fixed_base:
        spec.delete(spec.joint(ROOT_JOINT))
    for sole in [geom for geom in spec.geoms if geom.contype == 1]:
        sole.friction = [options.friction, *sole.friction[1:]]
        # The sole's friction counts, not the larger of sole's and ground's.
        sole.priority = 1
    for number, ground in enumerate(grounds):
        add_ground(spec, ground, ground_name(number))
    return spec


def ground_name(number: int) -> str:
    """Name of the MuJoCo geom of the ground with this number, counted from 0."""
    return f"ground_{number}" if number else "ground"


def add_ground(spec: Any, ground: Heightfield, name: str = "ground") -> None:
    """Add ground to a `mujoco.MjSpec`: a plane if it is flat, else a heightfield.

    `name` is that of the new geom, at heights in the world frame.
    """
    import mujoco

    heights = ground.heights_m
    low, span = float(heights.min()), float(np.ptp(heights))
    geom = spec.worldbody.add_geom(name=name, contype=0, conaffinity=1)
    if ground.is_flat:
        geom.type, geom.size = mujoco.mjtGeom.mjGEOM_PLANE, [0, 0, 1]
        geom.pos = [0, 0, low]
        return
    (x0, x1), (y0, y1) = ground.x_range_m, ground.y_range_m
    spec.add_hfield(
        name=name,
        nrow=heights.shape[0],
        ncol=heights.shape[1],
        size=[(x1 - x0) / 2, (y1 - y0) / 2, span, _BASE_THICKNESS_M],
        userdata=((heights - low) / span).ravel().tolist(),
    )
    geom.type, geom.hfieldname = mujoco.mjtGeom.mjGEOM_HFIELD, name
    geom.pos = [(x0 + x1) / 2, (y0 + y1) / 2, low]


def touch_shares(description: Description) -> FloatArray:
    """(contact points, 8) share of each point's force in each of the foot sensors."""
    left, right = (contact_shares(foot) for foot in description.feet)
    shares = np.zeros((len(left) + len(right), 8))
    shares[: len(left), :4], shares[len(left) :, 4:] = left, right
    return shares


class StartHeight:
    """Finds the torso height at which an upright robot's lower sole just touches."""

    def __init__(self, description: Description) -> None:
        """Compile a MuJoCo model of the robot for forward kinematics."""
        import mujoco

        self._mujoco = mujoco
        self._model = mujoco_model(description, WorldOptions(), None)
        self._data = mujoco.MjData(self._model)
        self._data.qpos[:ROOT_QPOS] = [0, 0, 0, 1, 0, 0, 0]
        self._soles: list[tuple[int, FloatArray]] = []
        for foot in description.feet:
            points = contact_points(foot)
            height = np.full((len(points), 1), foot.sole_height_m)
            link = description.links[foot.joint].link.name
            self._soles.append((self._model.body(link).id, np.hstack([points, height])))

    def heights_m(
        self, pose_rad: FloatArray, grounds: Sequence[Heightfield]
    ) -> FloatArray:
        """(n,) heights [m] of the torsos above the origin, in poses (n, joints)."""
        places = zip(pose_rad, grounds, strict=True)
        return np.array([self._height_m(pose, ground) for pose, ground in places])

    def _height_m(self, pose_rad: FloatArray, ground: Heightfield) -> float:
        data = self._data
        data.qpos[ROOT_QPOS:] = pose_rad
        self._mujoco.mj_kinematics(self._model, data)
        soles_m = [
            data.xpos[body] + points_m @ data.xmat[body].reshape(3, 3).T
            for body, points_m in self._soles
        ]
        x_m, y_m, z_m = np.vstack(soles_m).T
        return float(np.max(ground.height_at(x_m, y_m) - z_m))


class SimWorld(RolloutWorld):
    """The world "sim": n robots in one `mujoco.batch.Batch`, each on its own ground.

    Robot i's rollout has the same bits whatever n is and however many threads run.
    `qvel` (n, v) is a live view of MuJoCo's velocities of all v degrees of freedom.

    Example:
      >>> world = SimWorld(robot, [ground], [SeedSequence(1)], WorldOptions())
    """

    def _open(self) -> None:
        """Compile a model for each distinct ground, and make the batch of n robots."""
        if self.options.hidden:
            raise BadValueError("a sim has no hidden physics; only the real world can")
        self._batch = self._made_batch()
        self._qpos = self._batch.bind("qpos")
        self.qvel = self._batch.bind("qvel")
        self._ctrl = self._batch.bind("ctrl")
        self._sensors = self._batch.bind("sensordata")
        self._shares = touch_shares(self.description)
        fixed = self.options.fixed_base
        self._joints = slice(0 if fixed else ROOT_QPOS, None)
        self._speeds = slice(0 if fixed else ROOT_QVEL, None)
        self._start_height = StartHeight(self.description)

    def close(self) -> None:
        """Do nothing: a batch has no process to end, and Python frees its memory."""

    def _made_batch(self) -> "Batch":
        """Make a batch with a simulation for each robot on its own ground."""
        from mujoco.batch import Batch

        robot, options, models = self.description, self.options, {}
        for ground in self._grounds:
            if id(ground) not in models:
                under = None if options.fixed_base else ground
                models[id(ground)] = mujoco_model(robot, options, under)
        per_robot = [models[id(ground)] for ground in self._grounds]
        batch = Batch(per_robot[0], self.n, self.options.threads)
        if len(models) > 1:
            batch.set_models(per_robot)
        return batch

    def _start(self, pose_rad: FloatArray) -> None:
        self._batch.reset()
        self._qpos[:, self._joints] = pose_rad
        self._start_height_m = self._start_height.heights_m(pose_rad, self._grounds)
        if not self.options.fixed_base:
            self._qpos[:, 2] = self._start_height_m
        self._ctrl[:] = pose_rad
        self._batch.forward()

    def _advance(self, schedule: Schedule) -> None:
        for targets, steps in schedule:
            self._ctrl[:] = targets
            self._run(steps)

    def _run(self, steps: int) -> None:
        """Advance the active robots by physics steps; NaN marks those that diverge."""
        from mujoco.batch import SimulationError

        try:
            self._batch.step(ids=self.active, nstep=steps)
        except SimulationError as error:
            self._qpos[error.ids] = np.nan

    def _read(self) -> tuple[Truth, Observation]:
        """Current positions and velocities; forces, acceleration of the last step."""
        touch = len(self._shares)
        truth = self._read_truth()
        observation = Observation(
            time_s=self._ticks * TICK_S,
            position_rad=self._qpos[:, self._joints].copy(),
            velocity_rad_s=self.qvel[:, self._speeds].copy(),
            gyroscope_rad_s=truth.base_angular_velocity_rad_s.copy(),
            accelerometer_m_s2=self._sensors[:, touch + 3 : touch + 6].copy(),
            foot_force_n=np.maximum(self._foot_forces(), 0.0),
        )
        return truth, observation

    def _read_truth(self) -> Truth:
        if self.options.fixed_base:
            zeros = np.zeros((self.n, 3))
            position = zeros.copy()
            position[:, 2] = self._start_height_m
            upright = np.tile([1.0, 0.0, 0.0, 0.0], (self.n, 1))
            return Truth(position, upright, zeros, zeros)
        return Truth(
            base_position_m=self._qpos[:, :3].copy(),
            base_orientation=self._qpos[:, 3:7].copy(),
            base_linear_velocity_m_s=self.qvel[:, :3].copy(),
            base_angular_velocity_rad_s=self.qvel[:, 3:6].copy(),
        )

    def _foot_forces(self) -> FloatArray:
        """(n, 8) foot sensor forces [N]; a loop gives the same bits for every n."""
        touch = self._sensors[:, : len(self._shares)]
        forces = np.zeros((self.n, self._shares.shape[1]))
        for k, shares in enumerate(self._shares):
            forces += touch[:, k, None] * shares
        return forces

"""Replays: variants of a robot model driven by the commands of recordings."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from mujoco.batch import Batch, SimulationError

from diagnosis.effects.variants import Variants
from diagnosis.plant.servo import Servo
from diagnosis.replay.columns import Columns, columns
from diagnosis.replay.conforming_ground import conform
from diagnosis.replay.drive import Drive
from diagnosis.replay.laws import BatchLaws
from diagnosis.traces.trace import Trace
from diagnosis.traces.windows import Run
from groundwalk.arrays import FloatArray, IntArray

STEP_S = 0.002
"""Default time step of the physics in replays."""

BLOCK = 256
"""Number of physics steps whose commands are computed at once, for speed; any value of
this order does."""


@dataclass(frozen=True, eq=False)
class Replayed:
    """Predicted measurements of n variants in one run, at the T rows of its recording.

    Attributes:
      position_rad: (n, T, j) measured joint positions.
      velocity_rad_s: (n, T, j) measured joint velocities.
      servo_nm: (n, T, j) torques of the servos, without back-EMF.
      base: (n, T, 13) position (3), orientation w, x, y, z, linear velocity (3, world
        frame) and angular velocity (3, body frame) of the base; None if it is fixed.
      gyroscope_rad_s: (n, T, 3) gyroscope, base frame; only the bias if base is fixed.
    """

    position_rad: FloatArray
    velocity_rad_s: FloatArray
    servo_nm: FloatArray
    base: FloatArray | None
    gyroscope_rad_s: FloatArray


@np.errstate(over="ignore", invalid="ignore")
def replay(
    runs: Sequence[Run], variants: Variants, step_s: float = STEP_S, threads: int = 1
) -> list[Replayed]:
    """Simulate every variant of a robot model under the commands of every recording.

    Returns for each run the predicted measurements of all variants. A run has its own
    start state. Simulations that diverge hold numbers that are not finite.

    Example:
      >>> predicted = replay(runs, variants, threads=4)
      >>> position_rad = predicted[0].position_rad  # (n, rows, joints) of the first run
    """
    batch = ReplayBatch(runs, variants, step_s, threads)
    start_s = np.array([run.trace.time_s[0] for run in runs])
    longest_s = max(run.trace.duration_s for run in runs)
    steps = int(np.ceil((longest_s + 1e-9) / step_s))
    drive = Drive(runs, variants.signals.command_delay_s, step_s)
    tape = Tape(batch, steps)
    for first in range(0, steps, BLOCK):
        numbers = np.arange(first, min(first + BLOCK, steps))
        now_s = start_s + numbers[:, None] * step_s
        asked, pushed = drive.at(now_s)
        jumps = batch.laws.jumps(drive.ends(now_s))
        added = drive.added(now_s)
        for i in range(len(numbers)):
            if asked is not None:
                batch.laws.servo(asked[i], now_s[i], jumps[i])
            if pushed is not None:
                batch.laws.push_joints(pushed[i], now_s[i])
            if added is not None:
                batch.laws.add_to_joints(added[i])
            batch.laws.outside.apply(now_s[i])
            batch.step()
            tape.note(first + i + 1)
    return tape.read(runs, variants)


class ReplayBatch:
    """Simulations of all variants of a robot model in all runs, sorted by variant.

    `n` is the number of simulations, `count` that of runs. `qpos` (n, nq) and `qvel`
    (n, nv) are MuJoCo's, which change as the simulations step.
    """

    def __init__(
        self, runs: Sequence[Run], variants: Variants, step_s: float, threads: int
    ) -> None:
        """Put the simulations of n variants in R runs into the runs' start states."""
        self.plant, self.step_s = variants.plant, step_s
        self.n, self.count = variants.n * len(runs), len(runs)
        self._batch = Batch(self.plant.model, self.n, threads)
        np.asarray(self._batch.expand("opt.timestep"))[:] = step_s
        self.qpos, self.qvel = map(self.bind, ("qpos", "qvel"))
        servos = [_servo(run.trace) for run in runs]
        loads = [run.trace.loads for run in runs]
        self.laws = BatchLaws(self._batch, variants, servos, step_s, loads)
        self._start(runs, variants)
        self.laws.begin(
            before_rad=[run.before_rad for run in runs],
            rising=[run.acceleration_rad_s2 for run in runs],
        )

    def step(self) -> None:
        """Take one step of physics; a simulation that diverges gets NaN positions."""
        try:
            self._batch.step()
        except SimulationError as error:
            self.qpos[error.ids] = np.nan

    def bind(self, name: str) -> FloatArray:
        """(n, ...) live view of a field of `MjData` of all n simulations."""
        return np.asarray(self._batch.bind(name))

    def _start(self, runs: Sequence[Run], variants: Variants) -> None:
        """Set start positions and velocities, and ground bumps under the soles."""
        n, plant = variants.n, self.plant
        measured = np.tile([run.position_rad for run in runs], (n, 1))
        velocity = np.tile([run.velocity_rad_s for run in runs], (n, 1))
        # late sensors show where the joints were; by now they have moved on
        late_s = np.repeat(variants.late_s, self.count, axis=0)
        start = measured + late_s * velocity - self.laws.joints["offset_rad"]
        self.qpos[:, plant.qpos], self.qvel[:, plant.dofs] = start, velocity
        bases = [run.base for run in runs if run.base is not None]
        if bases:
            base = np.tile(bases, (n, 1))
            self.qpos[:, :7], self.qvel[:, :6] = base[:, :7], base[:, 7:]
        self._batch.forward()
        height_m = variants.outside.bump_height_m
        if height_m.any() and bases:
            conform(self._batch, plant, [*runs] * n, np.repeat(height_m, self.count))


def _servo(trace: Trace) -> Servo:
    """A recording's servo; only its back-EMF if torque commands drive the joints."""
    if trace.command_rad is not None:
        return trace.servo
    none = np.zeros_like(trace.servo.kp_nm_rad)
    return replace(trace.servo, kp_nm_rad=none, kd_nm_s_rad=none)


class Tape:
    """Stored states of the joints and of a floating base after every physics step."""

    def __init__(self, batch: "ReplayBatch", steps: int) -> None:
        """Make room for the states of `steps` physics steps, and store the start."""
        self._batch, shape = batch, (steps + 1, batch.n, len(batch.plant.joints))
        self._position, self._velocity, self._torque = map(np.empty, [shape] * 3)
        self._base: FloatArray | None = None
        if batch.plant.base == "floating":
            self._base = np.empty((steps + 1, batch.n, 13))
        self._force = batch.bind("actuator_force")
        self._actuators = columns(batch.plant.actuators)
        self.note(0)
        self._torque[0] = 0.0  # no step has been taken

    def note(self, step: int) -> None:
        """Store the simulations' present state, the one after `step` physics steps."""
        batch = self._batch
        self._velocity[step] = batch.laws.encoder_rad_s()
        self._position[step] = batch.laws.encoder_rad()
        self._torque[step] = self._force[:, self._actuators]
        if self._base is not None:
            self._base[step, :, :7] = batch.qpos[:, :7]
            self._base[step, :, 7:] = batch.qvel[:, :6]

    def read(self, runs: Sequence[Run], variants: Variants) -> list[Replayed]:
        """Predicted measurements for each run, at the rows of its recording."""
        return [self._read(k, run, variants) for k, run in enumerate(runs)]

    def _read(self, k: int, run: Run, variants: Variants) -> Replayed:
        """Predicted measurements for run number k."""
        rows = np.arange(variants.n) * self._batch.count + k
        since_s = run.trace.time_s - run.trace.time_s[0]
        now_s = np.tile(since_s, (variants.n, 1))
        position, velocity = self._seen_at(rows, now_s, variants)
        position = position + variants.joints.offset_rad[:, None]
        bias = variants.signals.gyro_bias_rad_s[:, None]
        gyroscope, base = np.repeat(bias, run.trace.ticks, axis=1), None
        if self._base is not None:
            low, t = self._between(now_s)
            row = rows[:, None]
            base = (1 - t) * self._base[low, row] + t * self._base[low + 1, row]
            base[:, :, 3:7] /= np.linalg.norm(base[:, :, 3:7], axis=2, keepdims=True)
            gyroscope = gyroscope + base[:, :, 10:]
        torque = self._torque_at(rows, since_s)
        return Replayed(position, velocity, torque, base, gyroscope)

    def _torque_at(self, rows: IntArray, since_s: FloatArray) -> FloatArray:
        """(n, T, j) servo torque [N m], averaged from the row before to the row after.

        A stiff servo's simulated torque jumps with its command. A real controller's
        does not: it computes once in a control tick and then holds the torque.
        """
        total = np.cumsum(self._torque[:, rows], axis=0) * self._batch.step_s
        low, t = self._between(since_s)
        at = (1 - t[..., None]) * total[low] + t[..., None] * total[low + 1]
        before, after = np.r_[0, : len(at) - 1], np.r_[1 : len(at), len(at) - 1]
        lasted_s = (since_s[after] - since_s[before])[:, None, None]
        lasted_s = np.where(lasted_s > 0, lasted_s, np.inf)  # a run of one row
        return np.asarray(((at[after] - at[before]) / lasted_s).transpose(1, 0, 2))

    def _seen_at(
        self, rows: IntArray, time_s: FloatArray, variants: Variants
    ) -> tuple[FloatArray, FloatArray]:
        """Positions and velocities (n, T, j) that are read at (n, T) times."""
        late_s = variants.late_s
        position, velocity = self._joints_at(rows, time_s - late_s[:, :1])
        for j in np.flatnonzero((late_s != late_s[:, :1]).any(axis=0)).tolist():
            own = self._joints_at(rows, time_s - late_s[:, j : j + 1], [j])
            position[..., [j]], velocity[..., [j]] = own
        return position, velocity

    def _joints_at(
        self, rows: IntArray, time_s: FloatArray, joints: Columns = slice(None)
    ) -> tuple[FloatArray, FloatArray]:
        """Positions and velocities (n, T, j) of joints in simulations at (n, T) times.

        Before the start, joints are assumed to have moved at their first velocities.
        """
        low, t = self._between(time_s)
        row = rows[:, None]
        both = self._position[..., joints], self._velocity[..., joints]
        before, after = ([one[at, row] for one in both] for at in (low, low + 1))
        position, velocity = hermite(before, after, self._batch.step_s, t)
        before_s = np.minimum(time_s, 0.0)[..., None]
        return position + before_s * both[1][0, row], velocity

    def _between(self, time_s: FloatArray) -> tuple[IntArray, FloatArray]:
        """Index of the physics step before each time, and the share of a step since."""
        last = len(self._position) - 1
        at = np.clip(time_s / self._batch.step_s, 0, last - 1e-9)
        low = at.astype(int)
        return low, (at - low)[..., None]


def hermite(
    before: Sequence[FloatArray],
    after: Sequence[FloatArray],
    step_s: float,
    share: FloatArray | float,
) -> tuple[FloatArray, FloatArray]:
    """Positions by cubic Hermite interpolation, velocities by linear interpolation.

    `before` and `after` are positions and velocities at two steps `step_s` apart, of
    one shape; `share` is what has passed of the step, 0 to 1. SciPy's
    `CubicHermiteSpline` is not used, since it needs the same times in all rows.
    """
    h, t = step_s, share
    (q0, v0), (q1, v1) = before, after
    v0, v1 = h * v0, h * v1
    rise = q1 - q0
    position = q0 + t * (v0 + t * (3 * rise - 2 * v0 - v1 + t * (v0 + v1 - 2 * rise)))
    return position, (v0 + t * (v1 - v0)) / h

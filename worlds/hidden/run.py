"""Simulates one robot with hidden physics that follows commands at control ticks."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from groundwalk.arrays import FloatArray, IntArray
from groundwalk.errors import BadValueError
from terrain import Heightfield
from worlds.hidden.drive import HiddenDrive
from worlds.hidden.effects.placed import Hidden, surroundings
from worlds.hidden.engine import BodySense, HiddenEngine
from worlds.hidden.plant import HiddenPlant
from worlds.observation import up_z
from worlds.real.hidden_robot import hidden_engine
from worlds.rollouts import fallen
from worlds.sim.world import StartHeight


@dataclass(frozen=True, eq=False)
class Clock:
    """The control ticks of a recorded run, as numbers of physics steps of `step_s`.

    The physics step at which each tick happens is in `ticks` (rows,), 0 first. The
    recording begins at tick number `first`, whose time is 0.
    """

    step_s: float
    ticks: IntArray
    first: int

    @property
    def time_s(self) -> FloatArray:
        """(rows,) time of each tick [s], negative before the recording begins."""
        return np.asarray((self.ticks - self.ticks[self.first]) * self.step_s)

    @classmethod
    def drawn(
        cls,
        step_s: float,
        rate_hz: float,
        spans_s: tuple[float, float],
        jitter_s: float,
        rng: np.random.Generator,
    ) -> "Clock":
        """Evenly spaced ticks, each early or late by a random number of physics steps.

        `spans_s` are the time before the recording begins and the recording's length;
        `jitter_s` is the largest deviation of a tick from its even time. BadValueError
        if it is so large that ticks change their order.
        """
        first = round(spans_s[0] * rate_hz)
        rows = first + round(spans_s[1] * rate_hz) + 1
        even = np.arange(rows) / rate_hz
        off = rng.uniform(-jitter_s, jitter_s, rows)
        ticks = np.round((even + off) / step_s).astype(np.intp)
        ticks -= ticks[0]
        if (np.diff(ticks) < 1).any():
            raise BadValueError(f"a jitter of {jitter_s} s swaps ticks")
        return cls(step_s, ticks, first)


Feed = Callable[[int, BodySense], FloatArray]
"""Function of a control tick's number and the sensors' readings at that tick, which
returns the position targets (j,) [rad] to send."""


@dataclass(frozen=True, eq=False)
class Run:
    """True motion of a simulated robot, without noise; one row per control tick.

    Commands sent, joint angles, readings of noiseless encoders with offsets and delays,
    and the motors' torques in the step before a tick are (rows, j). `sense` holds
    arrays (rows, ...) by attribute name of `BodySense`, but the motion of the base is
    in a frame whose z axis is the true vertical. `ok` says whether all numbers are
    finite and a floating base has not fallen.
    """

    clock: Clock
    command_rad: FloatArray
    encoder_rad: FloatArray
    position_rad: FloatArray
    torque_nm: FloatArray
    sense: dict[str, FloatArray]
    ok: bool

    def every(self, ticks: int) -> "Run":
        """The run with each n-th of its ticks only, the recording's first among them.

        Commands then hold for shorter than from row to row.
        """
        clock, rows = self.clock, slice(self.clock.first % ticks, None, ticks)
        return Run(
            Clock(clock.step_s, clock.ticks[rows], clock.first // ticks),
            self.command_rad[rows],
            self.encoder_rad[rows],
            self.position_rad[rows],
            self.torque_nm[rows],
            {name: table[rows] for name, table in self.sense.items()},
            self.ok,
        )


def run_hidden(
    plant: HiddenPlant,
    effects: Sequence[Hidden],
    engine: str,
    clock: Clock,
    feed: Feed,
    start_rad: FloatArray,
    seed: np.random.SeedSequence,
    paths: bool = False,
) -> Run:
    """Simulate a robot with hidden physics that follows commands.

    Args:
      plant: the nominal robot.
      effects: the physics that it lacks.
      engine: "bullet" or "mujoco".
      clock: times at which commands are sent and sensors are read.
      feed: gives the command of each tick.
      start_rad: (j,) joint angles at the first tick, where the robot is at rest.
      seed: for the random bumps of uneven ground.
      paths: whether targets move steadily from command to command, see `HiddenDrive`.
    """
    around = surroundings(effects)
    ground = around.ground(seed) if plant.floating else None
    world = hidden_engine(engine, plant, effects, clock.step_s, ground)
    height_m = 0.0
    if plant.description is not None and ground is not None:
        start_height = StartHeight(plant.description)
        height_m = float(start_height.heights_m(start_rad[None], [ground])[0])
    world.reset(start_rad, height_m)
    try:
        drive = HiddenDrive(plant, effects, world, clock.step_s, start_rad, paths)
        run = _recorded(world, drive, clock, feed)
    finally:
        world.close()
    return replace(
        run,
        sense=_upright(run.sense, around.tilt()),
        ok=run.ok and (ground is None or stands(run.sense, ground)),
    )


def _recorded(world: HiddenEngine, drive: HiddenDrive, clock: Clock, feed: Feed) -> Run:
    """Simulate all ticks; poses are in the ground's frame.

    Once the simulation diverges, nothing more is sent and the state stays.
    """
    ticks, zero = clock.ticks, int(clock.ticks[clock.first])
    commands, encoders, positions, torques, senses = [], [], [], [], []
    ok = True
    for row, steps in enumerate(np.diff(ticks, append=ticks[-1])):
        sense = _now(world.sense(), clock.step_s)
        senses.append(sense)
        positions.append(drive.positions())
        encoders.append(drive.encoders())
        torques.append(drive.motor_torques())
        ok = ok and bool(np.isfinite(positions[-1]).all())
        commands.append(feed(row, sense) if ok else positions[0])
        if ok and steps:
            drive.send(commands[-1])
            drive.advance(int(steps), zero)
    columns = zip(BodySense._fields, zip(*senses, strict=True), strict=True)
    felt = {name: np.stack(column) for name, column in columns}
    sent, read, true = map(np.stack, (commands, encoders, positions))
    return Run(clock, sent, read, true, np.stack(torques), felt, ok)


def _now(sense: BodySense, step_s: float) -> BodySense:
    """The readings with the base's pose half a physics step before, see `HiddenDrive`.

    The engine's positions are half a step ahead of the ticks.
    """
    import mujoco

    late_s, turned = -step_s / 2, sense.orientation.copy()
    mujoco.mju_quatIntegrate(turned, sense.angular_rad_s, late_s)
    moved_m = sense.position_m + late_s * sense.linear_m_s
    return sense._replace(position_m=moved_m, orientation=turned)


def stands(felt: dict[str, FloatArray], ground: Heightfield) -> bool:
    """Whether the pose of a floating base stays finite and the robot never falls.

    `felt` holds "position_m" (rows, 3) and "orientation" (rows, 4) w, x, y, z of the
    base in the ground's frame. For falls see `worlds.rollouts.fallen`.
    """
    place_m, turn = felt["position_m"], felt["orientation"]
    if not (np.isfinite(place_m).all() and np.isfinite(turn).all()):
        return False
    x, y, z = place_m.T
    height_m = z - ground.height_at(x, y)
    return not bool(fallen(up_z(turn), height_m, float(height_m[0])).any())


def _upright(felt: dict[str, FloatArray], turn: FloatArray) -> dict[str, FloatArray]:
    """Rotate the base's motion, as `Run.sense` has it, by a matrix `turn` (3, 3)."""
    import mujoco

    if np.array_equal(turn, np.eye(3)):
        return felt
    quaternion, product = np.zeros(4), np.zeros(4)
    mujoco.mju_mat2Quat(quaternion, turn.ravel())
    turned = []
    for orientation in felt["orientation"]:
        mujoco.mju_mulQuat(product, quaternion, orientation)
        turned.append(product.copy())
    return felt | {
        "position_m": felt["position_m"] @ turn.T,
        "linear_m_s": felt["linear_m_s"] @ turn.T,
        "orientation": np.array(turned),
    }

"""Lets a robot with hidden physics follow commands: the run behind one recording."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, fields, replace

import numpy as np

from groundwalk.arrays import FloatArray
from terrain import Heightfield
from worlds.falls import fallen
from worlds.hidden.clock import Clock
from worlds.hidden.drive import HiddenDrive
from worlds.hidden.effects.placed import Hidden, surroundings
from worlds.hidden.engine import BodySense, HiddenEngine
from worlds.hidden.plant import HiddenPlant
from worlds.observation import up_z
from worlds.real.engines import hidden_engine
from worlds.sim.start_height import StartHeight

Feed = Callable[[int, BodySense], FloatArray]
"""(j,) command of a tick, from the tick's number and the sensors' readings."""


@dataclass(frozen=True, eq=False)
class Run:
    """The true motion, without noise; rows are the clock's ticks.

    Attributes:
      clock: the ticks.
      command_rad: (rows, j) sent at each tick.
      encoder_rad: (rows, j) readings of noiseless encoders, offsets and delays
        included.
      position_rad: (rows, j) of the joints.
      sense: arrays (rows, ...) by `BodySense`'s names; the base's motion is in a frame
        whose z axis is the true vertical.
      ok: whether all numbers are finite and a floating base has not fallen.
    """

    clock: Clock
    command_rad: FloatArray
    encoder_rad: FloatArray
    position_rad: FloatArray
    sense: dict[str, FloatArray]
    ok: bool


def run_hidden(
    plant: HiddenPlant,
    effects: Sequence[Hidden],
    engine: str,
    clock: Clock,
    feed: Feed,
    start_rad: FloatArray,
    seed: np.random.SeedSequence,
) -> Run:
    """Let a robot with hidden physics follow commands.

    Args:
      plant: the nominal robot.
      effects: the hidden effects.
      engine: "bullet" or "mujoco".
      clock: when commands are sent and sensors read.
      feed: the commands.
      start_rad: (j,) pose at the first tick, where the robot rests.
      seed: of the bumps of uneven ground.

    Raises:
      GroundwalkError: a place is unknown, or the engine lacks an effect.
    """
    around = surroundings(effects)
    ground = around.ground(seed) if plant.floating else None
    world = hidden_engine(engine, plant, effects, clock.step_s, ground)
    height_m = 0.0
    if plant.description is not None and ground is not None:
        height_m = float(
            StartHeight(plant.description).heights_m(start_rad[None], [ground])[0]
        )
    world.reset(start_rad, height_m)
    try:
        drive = HiddenDrive(plant, effects, world, clock.step_s, start_rad)
        run = _recorded(world, drive, clock, feed)
    finally:
        world.close()
    return replace(
        run,
        sense=_upright(run.sense, around.tilt()),
        ok=run.ok and (ground is None or stands(run.sense, ground)),
    )


def _recorded(world: HiddenEngine, drive: HiddenDrive, clock: Clock, feed: Feed) -> Run:
    """All ticks, in the frame of the ground; no more commands once numbers blow up."""
    ticks, zero = clock.ticks, int(clock.ticks[clock.first])
    commands, encoders, positions, senses = [], [], [], []
    ok = True
    for row, steps in enumerate(np.diff(ticks, append=ticks[-1])):
        sense = world.sense()
        senses.append(sense)
        positions.append(world.position_rad.copy())
        encoders.append(drive.encoders())
        ok = ok and bool(np.isfinite(positions[-1]).all())
        commands.append(feed(row, sense) if ok else positions[0])
        if ok and steps:
            drive.send(commands[-1])
            drive.advance(int(steps), zero)
    felt = {
        field.name: np.stack([getattr(sense, field.name) for sense in senses])
        for field in fields(BodySense)
    }
    return Run(
        clock=clock,
        command_rad=np.stack(commands),
        encoder_rad=np.stack(encoders),
        position_rad=np.stack(positions),
        sense=felt,
        ok=ok,
    )


def stands(felt: dict[str, FloatArray], ground: Heightfield) -> bool:
    """Whether a floating base has finite numbers and never falls (`worlds.falls`).

    Args:
      felt: "position_m" (rows, 3) and "orientation" (rows, 4) w, x, y, z of the base,
        in the ground's frame.
      ground: under the robot.
    """
    place_m, turn = felt["position_m"], felt["orientation"]
    if not (np.isfinite(place_m).all() and np.isfinite(turn).all()):
        return False
    x, y, z = place_m.T
    height_m = z - ground.height_at(x, y)
    return not bool(fallen(up_z(turn), height_m, float(height_m[0])).any())


def _upright(felt: dict[str, FloatArray], turn: FloatArray) -> dict[str, FloatArray]:
    """The base's motion in a frame whose z axis is the true vertical.

    Args:
      felt: arrays (rows, ...) by `BodySense`'s names, in the ground's frame.
      turn: (3, 3) rotation from the ground's frame to the upright one.
    """
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

"""One recording of a robot with hidden physics: fine steps between ticks."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, fields

import numpy as np

from groundwalk.arrays import FloatArray
from worlds.hidden.body_sense import BodySense
from worlds.hidden.clock import Clock
from worlds.hidden.drive import HiddenDrive
from worlds.hidden.effects import Hidden
from worlds.hidden.engine import HiddenEngine, hidden_engine
from worlds.hidden.model import hidden_ground, tilt
from worlds.hidden.plant import HiddenPlant
from worlds.sim.start_height import Standing

Feed = Callable[[int, BodySense], FloatArray]
"""(j,) command of a tick, from its number and what is felt then."""
_FALLEN_UP = 0.5
"""Cosine between the base's up axis and the vertical: 60 degrees."""
_FALLEN_HEIGHT = 0.5


@dataclass(frozen=True, eq=False)
class Run:
    """What really happened, without noise; rows are the clock's ticks.

    Attributes:
      clock: the ticks.
      command_rad: (rows, j) sent at each tick.
      encoder_rad: (rows, j) what perfect encoders say, offsets and delays included.
      position_rad: (rows, j) of the joints.
      sense: arrays (rows, ...) by `BodySense`'s names, in the true vertical's frame.
      ok: whether the physics stayed sound and a floating base upright.
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
      effects: what is hidden.
      engine: "bullet" or "mujoco".
      clock: when commands are sent and sensors read.
      feed: the commands.
      start_rad: (j,) pose at the first tick, where the robot rests.
      seed: of uneven ground.

    Raises:
      GroundwalkError: a place is unknown, or the engine lacks an effect.
    """
    ground = hidden_ground(effects, seed) if plant.floating else None
    world = hidden_engine(engine, plant, effects, clock.step_s, ground)
    height_m = 0.0
    if plant.description is not None and ground is not None:
        height_m = float(
            Standing(plant.description).heights_m(start_rad[None], [ground])[0]
        )
    world.reset(start_rad, height_m)
    try:
        drive = HiddenDrive(plant, effects, world, clock.step_s, start_rad)
        return _recorded(world, drive, effects, clock, feed)
    finally:
        world.close()


def _recorded(
    world: HiddenEngine,
    drive: HiddenDrive,
    effects: Sequence[Hidden],
    clock: Clock,
    feed: Feed,
) -> Run:
    """All ticks; commands stop where the physics has blown up."""
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
        sense=_upright(felt, tilt(effects)),
        ok=ok and _stands(felt),
    )


def _stands(felt: dict[str, FloatArray]) -> bool:
    """Whether a base has stayed upright; one that is fixed has."""
    _, x, y, _ = felt["orientation"].T
    height_m = felt["position_m"][:, 2]
    up = bool((1 - 2 * (x * x + y * y) > _FALLEN_UP).all())
    return up and bool((height_m >= _FALLEN_HEIGHT * height_m[0]).all())


def _upright(felt: dict[str, FloatArray], turn: FloatArray) -> dict[str, FloatArray]:
    """The base's motion as seen from a frame whose z is the true vertical."""
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

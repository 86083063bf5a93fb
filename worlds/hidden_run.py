"""One recording of a robot with hidden physics: fine steps between ticks."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, fields

import numpy as np

from groundwalk.arrays import FloatArray
from worlds.hidden_clock import Clock, CommandLine
from worlds.hidden_effects import Hidden
from worlds.hidden_engine import (
    WATCH_STEPS,
    BodySense,
    HiddenEngine,
    hidden_engine,
    least_inertia_kg_m2,
)
from worlds.hidden_joints import HiddenJoints
from worlds.hidden_model import hidden_ground, tilt
from worlds.hidden_plant import HiddenPlant
from worlds.standing import Standing

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
    inertia = least_inertia_kg_m2(plant, [start_rad])
    joints = HiddenJoints(plant, effects, clock.step_s, inertia)
    height_m = 0.0
    if plant.description is not None and ground is not None:
        height_m = float(
            Standing(plant.description).heights_m(start_rad[None], [ground])[0]
        )
    world.reset(start_rad, height_m)
    try:
        return _Rollout(world, joints, effects, clock, start_rad).run(feed)
    finally:
        world.close()


class _Rollout:
    """A run while it goes on."""

    def __init__(
        self,
        world: HiddenEngine,
        joints: HiddenJoints,
        effects: Sequence[Hidden],
        clock: Clock,
        start_rad: FloatArray,
    ) -> None:
        self._world, self._joints, self._clock = world, joints, clock
        self._effects = effects
        self._line = CommandLine(start_rad, self._delay_steps("command_latency"))
        self._forces = [e for e in effects if e.name in ("external_force", "drag")]
        self._history = np.empty((int(clock.ticks[-1]) + 1, len(start_rad)))
        self._history[0] = start_rad

    def _delay_steps(self, name: str) -> float:
        delay_s = sum(e["delay"] for e in self._effects if e.name == name)
        return delay_s / self._clock.step_s

    def run(self, feed: Feed) -> Run:
        """All ticks, or up to the first at which the physics has blown up."""
        world, ticks = self._world, self._clock.ticks
        commands, positions, senses = [], [], []
        ok = True
        for row, tick in enumerate(ticks):
            sense = world.sense()
            senses.append(sense)
            positions.append(world.position_rad.copy())
            ok = ok and bool(np.isfinite(positions[-1]).all())
            commands.append(feed(row, sense) if ok else positions[0])
            if ok and row + 1 < len(ticks):
                self._line.send(int(tick), commands[-1])
                self._advance(int(tick), int(ticks[row + 1]))
        felt = {
            field.name: np.stack([getattr(sense, field.name) for sense in senses])
            for field in fields(BodySense)
        }
        ok = ok and _stands(felt)
        return Run(
            clock=self._clock,
            command_rad=np.stack(commands),
            encoder_rad=self._encoders(),
            position_rad=np.stack(positions),
            sense=_upright(felt, tilt(self._effects)),
            ok=ok,
        )

    def _advance(self, start: int, end: int) -> None:
        world, joints = self._world, self._joints
        zero = int(self._clock.ticks[self._clock.first])
        for step in range(start, end):
            time_s = (step - zero) * self._clock.step_s
            if self._forces:
                self._push(time_s)
            torque = joints.torque(
                time_s, world.position_rad, world.velocity_rad_s, self._line.over(step)
            )
            world.step(torque)
            self._history[step + 1] = joints.encoders(world.position_rad)
            if step >= end - WATCH_STEPS:
                world.watch()

    def _push(self, time_s: float) -> None:
        for effect in self._forces:
            if effect.name == "drag":
                speed = self._world.body_velocity(effect.place)
                self._world.push(effect.place, -effect["coefficient"] * speed)
            elif 0 <= time_s - effect["start"] < effect["duration"]:
                force_n = np.array([effect["x"], effect["y"], effect["z"]])
                self._world.push(effect.place, force_n)

    def _encoders(self) -> FloatArray:
        """(rows, j) read between fine steps where they are late."""
        late = self._clock.ticks - self._delay_steps("sensor_delay")
        steps = np.arange(len(self._history))
        columns = [np.interp(late, steps, angles) for angles in self._history.T]
        return np.stack(columns, axis=1) + self._joints.offset_rad


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

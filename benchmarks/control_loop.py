"""Benchmark: speed of the control loop compared with the bare physics.

The same 150 walks are computed in three ways, in turn, in several rounds:
- loop: `walk_trials`, that is walk engine and sim, as the gait search uses them;
- bare: only `Batch.step` of MuJoCo with the same model and the loop's commands;
- single: `mj_step` of MuJoCo for one robot after the other, for a few of the robots.
"""

import statistics
import time
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Any

import mujoco
import numpy as np
from mujoco.batch import Batch

import robots
import terrain
import worlds
from benchmarks.ratios import judged, seconds
from experiments.walking import TrialRules, walk_trials
from groundwalk.arrays import FloatArray
from walk_engine import Velocity, WalkEngine, gaits
from walk_engine.gait import PARAMETERS, from_unit, to_unit
from worlds.sim.world import SimWorld, mujoco_model

ROBOTS = 150
TICKS = 200
ROUNDS = 9
SINGLES = 6
PASS = 0.85
"""Smallest speed of the control loop, as a share of the bare physics' speed, with which
the benchmark passes."""


@dataclass(frozen=True)
class Timing:
    """Times [s] that one round of the benchmark took.

    Attributes:
      loop: the whole control loop: walk engine, physics and everything between.
      engine: part of `loop` spent in `WalkEngine.step`.
      physics: part of `loop` spent in MuJoCo's `Batch.step`.
      bare: replay of the loop's commands by `Batch.step` alone.
      single: replay of the loop's commands by `mj_step`, one robot at a time.
    """

    loop: float
    engine: float
    physics: float
    bare: float
    single: float


class _Stopwatch:
    """Context manager that adds up the time spent in a method of a class [s]."""

    def __init__(self, owner: Any, name: str) -> None:
        self.seconds = 0.0
        method: Callable[..., Any] = getattr(owner, name)

        def timed(*args: Any, **kwargs: Any) -> Any:
            start = time.perf_counter()
            try:
                return method(*args, **kwargs)
            finally:
                self.seconds += time.perf_counter() - start

        self._owner, self._name, self._method, self._timed = owner, name, method, timed

    def __enter__(self) -> "_Stopwatch":
        setattr(self._owner, self._name, self._timed)
        return self

    def __exit__(self, *_: object) -> None:
        setattr(self._owner, self._name, self._method)


def measure() -> list[Timing]:
    """Time the loop and both replays in `ROUNDS` rounds, after a round to warm up."""
    description = robots.get("nao")
    ground = terrain.make("flat", 0)
    seeds = [np.random.SeedSequence(0)] * ROBOTS
    world = SimWorld(description, [ground] * ROBOTS, seeds, worlds.WorldOptions())
    walks = _walks()
    commands = _commands(world, walks)
    model = mujoco_model(description, world.options, ground)
    rounds = []
    for _ in range(ROUNDS + 1):
        with (
            _Stopwatch(WalkEngine, "step") as engine,
            _Stopwatch(Batch, "step") as physics,
        ):
            loop = seconds(partial(walk_trials, world, walks, _rules()))
        batch = _started(world, walks, model)
        bare = seconds(partial(_replay, batch, commands, world.options))
        states = _started(world, walks, model).bind("qpos")[:SINGLES]
        single = seconds(partial(_single, model, states, commands, world.options))
        rounds.append(
            Timing(
                loop, engine.seconds, physics.seconds, bare, single * ROBOTS / SINGLES
            )
        )
    return rounds[1:]


def report(rounds: list[Timing]) -> tuple[str, bool]:
    """Text that reports the times, and whether the control loop is fast enough."""
    ratios = [t.bare / t.loop for t in rounds]
    line, passes = judged(
        "throughput against bare Batch.step", ratios, "at least", PASS
    )
    single = statistics.median(t.single / t.loop for t in rounds)
    engine = statistics.median(t.engine / t.loop for t in rounds)
    physics = statistics.median(t.physics / t.loop for t in rounds)
    rest = statistics.median((t.loop - t.engine - t.physics) / t.loop for t in rounds)
    speed = statistics.median(ROBOTS * TICKS * worlds.TICK_S / t.loop for t in rounds)
    lines = [
        f"control loop of {ROBOTS} walking robots, {TICKS} ticks, {ROUNDS} rounds",
        line,
        f"  throughput against one mj_step at a time : {single:.2f}",
        f"  time goes to physics {physics:.1%}, walk engine {engine:.1%}, reading "
        f"sensors, falls and bookkeeping {rest:.1%}",
        f"  {speed:.0f} robot seconds per second on this machine",
    ]
    return "\n".join(lines), passes


def _walks() -> FloatArray:
    """Vectors (150, 16) of gaits near the gait "start", which walk without falling."""
    unit = to_unit(gaits.get("start").to_vector())
    noise = np.random.default_rng(0).normal(0, 0.01, (ROBOTS, len(PARAMETERS)))
    return from_unit(np.clip(unit + noise, 0, 1))


def _rules() -> TrialRules:
    return TrialRules(limit_s=TICKS * worlds.TICK_S)


def _commands(world: SimWorld, walks: FloatArray) -> list[FloatArray]:
    """Commands (n, joints) [rad] of every tick of the walks; no robot may fall."""
    engine = WalkEngine(robots.biped(world.description), walks)
    seen = world.reset(engine.start_pose())
    commands = []
    for _ in range(TICKS):
        commands.append(
            engine.step(Velocity.forward(), seen.gyroscope_rad_s, seen.foot_force_n)
        )
        seen = world.step(commands[-1])
    if not world.active.all():
        raise RuntimeError("a robot fell: the replay would not be the same work")
    return commands


def _started(world: SimWorld, walks: FloatArray, model: mujoco.MjModel) -> Batch:
    """Make a MuJoCo batch of all robots in the state in which the walks begin."""
    pose_rad = WalkEngine(robots.biped(world.description), walks).start_pose()
    world.reset(pose_rad)
    batch = Batch(model, ROBOTS, world.options.threads)
    place = world.truth()
    batch.bind("qpos")[:] = np.hstack(
        [place.base_position_m, place.base_orientation, pose_rad]
    )
    batch.forward()
    return batch


def _replay(
    batch: Batch, commands: list[FloatArray], options: worlds.WorldOptions
) -> None:
    control = batch.bind("ctrl")
    for command in commands:
        control[:] = command
        batch.step(nstep=options.steps_per_tick)


def _single(
    model: mujoco.MjModel,
    states: FloatArray,
    commands: list[FloatArray],
    options: worlds.WorldOptions,
) -> None:
    for robot, state in enumerate(states):
        data = mujoco.MjData(model)
        data.qpos[:] = state
        for command in commands:
            data.ctrl[:] = command[robot]
            for _ in range(options.steps_per_tick):
                mujoco.mj_step(model, data)

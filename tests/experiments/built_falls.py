"""Falls whose cause is built in: a step's edge, ice, pushes, weak motors."""

import contextlib
import dataclasses

import numpy as np

import robots
import worlds
from experiments.walking.recorder import Recorder, servo_gains
from robots import biped
from terrain import TerrainSpec
from walk_engine import Velocity, WalkEngine, gaits
from worlds import TICK_S, Recording, RecordingMetadata
from worlds.hidden.effects import Hidden
from worlds.hidden.plant import hidden_plant
from worlds.hidden.run import Clock, run_hidden
from worlds.scenes.scene import Scene

AREA = {"x_range_m": (-1.0, 3.0), "y_range_m": (-2.0, 2.0)}
FINE_S = 0.0005


def strider():
    """A fast gait: walks at 40 cm/s on good ground."""
    return gaits.get("walk2014").replace(
        max_forward=0.42, base_leg_lift=0.03, com_offset=0.02, hip_height=0.21,
        gyro_sagittal=0.08, switch_min_phase=0.5,
    )  # fmt: skip


def walk(
    world_name, gait, spec, *, seeds=(1,), limit_s=6.0, description=None,
    **options,
):  # fmt: skip
    """Scenes of walks, and whether each robot fell."""
    robot = description or robots.get("nao")
    ground, n = spec.make(), len(seeds)
    usual = dataclasses.replace(worlds.kind(world_name).options, threads=1, **options)
    sequences = [np.random.SeedSequence([seed]) for seed in seeds]
    engine = WalkEngine(biped(robot), [gait] * n, TICK_S)
    recorder = Recorder(robot, range(n))
    spread = [
        np.random.default_rng(s).normal(0, 0.01, len(robot.joints)) for s in seeds
    ]
    world = worlds.make(world_name, robot, [ground] * n, sequences, usual)
    with contextlib.closing(world):
        observation = world.reset(engine.start_pose() + np.array(spread))
        for _ in range(round(limit_s / TICK_S)):
            active = world.active
            if not active.any():
                break
            command = engine.step(
                Velocity.forward(),
                observation.gyroscope_rad_s,
                observation.foot_force_n,
                active,
            )
            recorder.tick(observation, world.truth(), command, engine.support, active)
            observation = world.step(command)
        ended = world.ended
    scenes = []
    for i, end in enumerate(ended):
        about = RecordingMetadata(
            robot="nao", base="floating", source="built", servo=servo_gains(robot),
            terrain=spec.to_json(), gait=dict(gait), world=world_name, end=str(end),
        )  # fmt: skip
        scenes.append(Scene("built", recorder.recording(i, about), robot, ground))
    return scenes, [end == "fall" for end in ended]


def flat():
    return TerrainSpec("flat", AREA)


def edge(leg_m, begin_m):
    """One step up as high as the lift is, with a steep face."""
    return TerrainSpec(
        "stairs",
        AREA | {"step_m": 0.1 * leg_m, "steps": 1, "start_radius_m": begin_m},
    )


def slope(angle_rad, heading_rad):
    return TerrainSpec(
        "slope", AREA | {"angle_rad": angle_rad, "heading_rad": heading_rad}
    )


def weak(share, joints):
    """The NAO with a share of the torque in some joints."""
    robot = robots.get("nao")
    links = [
        dataclasses.replace(
            joint,
            motor=dataclasses.replace(
                joint.motor, stall_torque_nm=share * joint.motor.stall_torque_nm
            ),
        )
        if joints in joint.name
        else joint
        for joint in robot.links
    ]
    return dataclasses.replace(robot, links=tuple(links))


def pushed(engine_name, force_n, start_s=1.5, limit_s=3.0, **changes):
    """As `walk`, on flat ground, but a force pushes the torso for 0.1 s.

    Args:
      engine_name: "mujoco" or "bullet".
      force_n: x and y.
      start_s: when.
      limit_s: length of the walk.
      changes: of the gait.
    """
    robot, gait = robots.get("nao"), gaits.get("start").replace(**changes)
    plant = hidden_plant("nao", floating=True)
    x, y = force_n
    place = robot.root.name
    push = f"x={x},y={y},z=0,start={start_s},duration=0.1"
    effects = (Hidden.parse(f"external_force@{place}:{push}"),)
    engine, support = WalkEngine(biped(robot), [gait], TICK_S), []

    def feed(row, sense):
        rate, force = sense.gyroscope_rad_s[None], sense.foot_force_n[None]
        command = engine.step(Velocity.forward(), rate, force)[0]
        support.append(int(engine.support[0]))
        return command

    rng = np.random.default_rng(1)
    clock = Clock.drawn(FINE_S, 1 / TICK_S, (0.0, limit_s), 0.0, rng)
    start_rad = engine.start_pose()[0]
    seed = np.random.SeedSequence(1)
    run = run_hidden(plant, effects, engine_name, clock, feed, start_rad, seed)
    return [_scene_of(robot, gait, run, support)], [not run.ok]


def _scene_of(robot, gait, run, support):
    """The run up to the fall as a scene."""
    _, x, y, _ = run.sense["orientation"].T
    fallen = np.flatnonzero(1 - 2 * (x * x + y * y) < 0.5)
    rows = slice(0, fallen[0] if fallen.size else len(support))
    columns = {"time": TICK_S * np.arange(len(support))}
    for k, joint in enumerate(robot.joints):
        columns[f"position.{joint}"] = run.position_rad[:, k]
        columns[f"command.{joint}"] = run.command_rad[:, k]
    for name, axes in (("position_m", "xyz"), ("orientation", "wxyz")):
        for k, axis in enumerate(axes):
            columns[f"base.{name.removesuffix('_m')}.{axis}"] = run.sense[name][:, k]
    force_n = run.sense["foot_force_n"]
    columns["foot_force.left"] = force_n[:, :4].sum(axis=1)
    columns["foot_force.right"] = force_n[:, 4:].sum(axis=1)
    columns["support"] = np.array(support)
    about = RecordingMetadata(
        robot="nao", base="floating", source="pushed", servo=servo_gains(robot),
        terrain=flat().to_json(), gait=dict(gait), end="fall",
    )  # fmt: skip
    own = {name: values[rows] for name, values in columns.items()}
    return Scene("pushed", Recording(own, about), robot, flat().make())

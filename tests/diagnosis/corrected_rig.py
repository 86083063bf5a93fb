"""Robots in corrected sims, and what becomes of them."""

from dataclasses import fields

import numpy as np
from joint_rigs import smooth_command, ticks

import robots
from diagnosis.corrected.sim import CorrectedSim
from diagnosis.effects.parts import PlacedEffect
from robots import biped
from walk_engine import WalkEngine, gaits
from worlds import WorldOptions
from worlds.sim.world import SimWorld

NAO = robots.get("nao")
CROUCH = WalkEngine(biped(NAO), [gaits.get("start")], 0.01).start_pose()[0]


def model_of(*effects):
    return tuple(PlacedEffect(name, place, values) for name, place, *values in effects)


def sim(grounds, *effects, nominal=False, noise=None, latency_s=0.0, fixed=False):
    seeds = [np.random.SeedSequence(i) for i in range(len(grounds))]
    options = WorldOptions(
        threads=1, fixed_base=fixed, noise=noise, latency_s=latency_s
    )
    if nominal:
        return SimWorld(NAO, grounds, seeds, options)
    return CorrectedSim(NAO, grounds, seeds, options, model_of(*effects))


def roll(world, commands_rad):
    """Observations (ticks + 1, n, ...) by name, and where the torsos end."""
    rows = [world.reset(np.tile(commands_rad[0], (world.n, 1)))]
    rows += [
        world.step(np.tile(command, (world.n, 1))) for command in commands_rad[:-1]
    ]
    found = {
        field.name: np.stack([getattr(row, field.name) for row in rows])
        for field in fields(rows[0])
    }
    return {**found, "base": world.truth().base_position_m}


def swing(duration_s, about_rad=CROUCH):
    """(T, j) every joint moves about a pose; those of one motor alike."""
    course = smooth_command(ticks(duration_s))
    commands = about_rad + 0.5 * course[:, None] * np.ones(len(NAO.joints))
    commands[:, [0, 6]] = commands[:, [0, 6]].mean(axis=1, keepdims=True)
    return commands

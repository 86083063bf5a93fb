"""The worlds "sim" and "real" by name, and their default options."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from groundwalk.errors import UnknownNameError
from robots.description import Description
from terrain import Heightfield
from worlds.real.world import RealWorld
from worlds.rollouts import RolloutWorld
from worlds.sensor_noise import SensorNoise
from worlds.sim.world import SimWorld
from worlds.world import World, WorldOptions

REAL_LATENCY_S = 0.036
"""Time from command to measured motion on a NAO [s]: 3 cycles of 12 ms (B-Human)."""


@dataclass(frozen=True)
class WorldKind:
    """A world's class and its defaults; see `kind` for an example.

    The robots stand on `terrain` by default. The number `seed_key` is combined with a
    seed so that sim and real draw different random numbers from the same seed.
    """

    world: type[RolloutWorld]
    options: WorldOptions
    terrain: str
    seed_key: int


WORLDS = {
    "sim": WorldKind(SimWorld, WorldOptions(), "flat", seed_key=1),
    "real": WorldKind(
        RealWorld,
        WorldOptions(latency_s=REAL_LATENCY_S, noise=SensorNoise()),
        "lumps",
        seed_key=0,
    ),
}
"""The worlds by name. "real" differs from "sim" by its physics engine and, by default,
by its latency, its sensor noise and its ground.

Example:
  >>> sorted(WORLDS)
  ['real', 'sim']
"""


def kind(name: str) -> WorldKind:
    """Look up the class and the defaults of the world "sim" or "real".

    Example:
      >>> kind("real").options.latency_s
      0.036
    """
    if name not in WORLDS:
        raise UnknownNameError("world", name, WORLDS)
    return WORLDS[name]


def make(
    name: str,
    description: Description,
    grounds: Sequence[Heightfield],
    seeds: Sequence[np.random.SeedSequence],
    options: WorldOptions | None = None,
) -> World:
    """Make a world with one robot on each ground.

    Args:
      name: "sim" or "real".
      description: the robot.
      grounds: one per robot; give one object n times to share it.
      seeds: one per robot, for its sensor noise.
      options: the world's settings; None for the defaults of this world.

    Raises:
      GroundwalkError: the world is unknown, or its options do not fit the robot.

    Example:
      See docs/python.md, "Walk on your own ground".
    """
    chosen = kind(name)
    return chosen.world(description, grounds, seeds, options or chosen.options)

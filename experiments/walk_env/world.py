"""The world of an episode of the Gymnasium environment."""

import copy
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Literal, get_args

import numpy as np

import worlds
from groundwalk.errors import BadValueError, UnknownNameError
from robots import Description
from terrain import Heightfield, TerrainSpec, parse
from worlds import World, WorldOptions

if TYPE_CHECKING:
    from sgat.transformers.transformer import Transformer

WorldName = Literal["sim", "real", "grounded"]


@dataclass(frozen=True, eq=False)
class EnvWorld:
    """Makes a world with one robot for each episode.

    Attributes:
      name: "sim", "real", or "grounded": the sim behind an action transformer.
      description: the robot.
      terrain: ground in words, drawn anew for each episode, or a fixed ground; the
        world's own if None.
      transformer: action transformer of a grounded world: an object, which is copied so
        that no two environments share one, or the folder of a written one.
      options: options of the sim or the real world; its own if None.
    """

    name: WorldName
    description: Description
    terrain: str | Heightfield | None = None
    transformer: "Transformer | str | Path | None" = None
    options: WorldOptions | None = None

    def __post_init__(self) -> None:
        """Refuse arguments that do not fit together; read or copy the transformer."""
        if self.name not in get_args(WorldName):
            raise UnknownNameError("world", self.name, get_args(WorldName))
        if (self.name == "grounded") != (self.transformer is not None):
            raise BadValueError(
                "a grounded world, and no other, needs a transformer: an object, or "
                "the folder that sgat.transformers.catalogue has written"
            )
        terrain = self.terrain or worlds.kind(self.inner).terrain
        if isinstance(terrain, str):
            parse(terrain)
        object.__setattr__(self, "terrain", terrain)
        object.__setattr__(self, "transformer", _own(self.transformer))

    @property
    def inner(self) -> str:
        """Name of the world that computes the physics: "sim" or "real"."""
        return "sim" if self.name == "grounded" else self.name

    def make(
        self, of_ground: np.random.SeedSequence, of_noise: np.random.SeedSequence
    ) -> World:
        """The world of one episode, from the seeds of its ground and of its noise."""
        grounds = [self._ground(of_ground)]
        robot, seeds = self.description, [of_noise]
        world = worlds.make(self.inner, robot, grounds, seeds, self.options)
        if self.transformer is None:
            return world
        from sgat.walks.walk_senses import leg_senses
        from sgat.walks.wrapped_worlds import GroundedWorld

        assert not isinstance(self.transformer, str | Path)
        senses = leg_senses(self.description)
        return GroundedWorld(world, senses, self.transformer, [of_noise])

    def _ground(self, seed: np.random.SeedSequence) -> Heightfield:
        if isinstance(self.terrain, Heightfield):
            return self.terrain
        number = int(seed.generate_state(1)[0])
        return TerrainSpec(*parse(str(self.terrain)), seed=number).make()


def episode_seeds(
    generator: np.random.Generator,
) -> tuple[np.random.SeedSequence, np.random.SeedSequence, np.random.SeedSequence]:
    """Seeds of an episode's ground, its noise and its start pose."""
    root = np.random.SeedSequence(int(generator.integers(2**63)))
    ground, noise, pose = root.spawn(3)
    return ground, noise, pose


def _own(given: "Transformer | str | Path | None") -> "Transformer | None":
    if not isinstance(given, str | Path):
        return copy.deepcopy(given)
    from sgat.transformers.catalogue import read_transformer

    return read_transformer(Path(given))

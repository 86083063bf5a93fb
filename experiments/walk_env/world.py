"""The world of an episode of the Gymnasium environment."""

import copy
from pathlib import Path
from typing import TYPE_CHECKING, Literal, get_args

import numpy as np

import worlds
from groundwalk.errors import BadValueError, UnknownNameError
from robots import Description
from terrain import Heightfield, TerrainSpec, parse
from worlds import World, WorldOptions

if TYPE_CHECKING:
    from sgat.transformers.catalogue import Transformer

WorldName = Literal["sim", "real", "grounded"]


class EnvWorld:
    """Makes an episode's world, with one robot, from the arguments of `WalkEnv`."""

    def __init__(
        self,
        name: WorldName,
        description: Description,
        terrain: str | Heightfield | None,
        transformer: "Transformer | str | Path | None",
        options: WorldOptions | None,
    ) -> None:
        """Refuse arguments that do not fit together; read or copy the transformer.

        A copy, so that no two environments share one.
        """
        if name not in get_args(WorldName):
            raise UnknownNameError("world", name, get_args(WorldName))
        if (name == "grounded") != (transformer is not None):
            raise BadValueError(
                "a grounded world, and no other, needs a transformer: an object, or "
                "the folder that sgat.transformers.catalogue has written"
            )
        self._inner = "sim" if name == "grounded" else name
        self._description, self._options = description, options
        self._terrain = terrain or worlds.kind(self._inner).terrain
        if isinstance(self._terrain, str):
            parse(self._terrain)
        if isinstance(transformer, str | Path):
            from sgat.transformers.catalogue import read_transformer

            self._transformer: Transformer | None = read_transformer(Path(transformer))
        else:
            self._transformer = copy.deepcopy(transformer)

    def make(
        self, of_ground: np.random.SeedSequence, of_noise: np.random.SeedSequence
    ) -> World:
        """The world of one episode, from the seeds of its ground and of its noise."""
        ground, robot = self._terrain, self._description
        if isinstance(ground, str):
            number = int(of_ground.generate_state(1)[0])
            ground = TerrainSpec(*parse(ground), seed=number).make()
        world = worlds.make(self._inner, robot, [ground], [of_noise], self._options)
        if self._transformer is None:
            return world

        from sgat.walks.walk_senses import leg_senses
        from sgat.walks.wrapped_worlds import GroundedWorld

        return GroundedWorld(world, leg_senses(robot), self._transformer, [of_noise])


def episode_seeds(
    generator: np.random.Generator,
) -> tuple[np.random.SeedSequence, np.random.SeedSequence, np.random.SeedSequence]:
    """Seeds of an episode's ground, its noise and its start pose."""
    root = np.random.SeedSequence(int(generator.integers(2**63)))
    ground, noise, pose = root.spawn(3)
    return ground, noise, pose

"""A piece of ground in a few words: enough to make it again."""

import dataclasses
from collections.abc import Mapping
from dataclasses import dataclass, field

from groundwalk.json_data import from_plain, to_plain
from terrain.bounds import Parameter
from terrain.catalog import configuration
from terrain.heightfield import Heightfield
from terrain.seeds import checked_seed


@dataclass(frozen=True)
class TerrainSpec:
    """Name, parameters and seed of a terrain.

    Attributes:
      name: one of `terrain.names()`.
      parameters: any parameters of the family; parameters left out are filled in, so
        that a spec means the same ground when defaults change later.
      seed: a whole number of 0 or more.

    Raises:
      UnknownNameError: there is no such family, or it has no such parameter.
      BadValueError: a parameter or the seed has a value that it cannot take.
    """

    name: str
    parameters: Mapping[str, Parameter] = field(default_factory=dict, hash=False)
    seed: int = 0

    def __post_init__(self) -> None:
        """Check all parts, and fill in the defaults of missing parameters."""
        ground = configuration(self.name, **self.parameters)
        object.__setattr__(self, "parameters", dataclasses.asdict(ground))
        object.__setattr__(self, "seed", checked_seed(self.seed))

    def make(self) -> Heightfield:
        """Make the ground: the same bits every time."""
        return configuration(self.name, **self.parameters).make(self.seed)

    def to_json(self) -> dict[str, object]:
        """Describe the ground in plain types that JSON knows."""
        plain: dict[str, object] = to_plain(self)
        return plain

    @classmethod
    def from_json(cls, data: object) -> "TerrainSpec":
        """Read what `to_json` described.

        Raises:
          UnknownNameError: there is no such family, or it has no such parameter.
          BadValueError: the data has another shape, or holds an impossible value.
        """
        return from_plain(cls, data, "terrain")

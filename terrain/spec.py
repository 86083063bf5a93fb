"""Name, parameters and seed of a terrain, from which its ground can be made again."""

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
    """Name, parameters and seed of a terrain: enough to make the same ground again.

    Attributes:
      name: one of `terrain.names()`.
      parameters: parameters of the family of terrain. Defaults are filled in when the
        spec is made, so that it means the same ground even if they change later.
      seed: a whole number of 0 or more.

    Raises:
      UnknownNameError: there is no such family, or it has no such parameter.
      BadValueError: a parameter or the seed has a value that it cannot take.

    Example:
      >>> spec = TerrainSpec("stairs", {"steps": 3}, seed=1)
      >>> TerrainSpec.from_json(spec.to_json()) == spec
      True
    """

    name: str
    parameters: Mapping[str, Parameter] = field(default_factory=dict, hash=False)
    seed: int = 0

    def __post_init__(self) -> None:
        """Check name, parameters and seed, and fill in missing parameters' defaults."""
        ground = configuration(self.name, **self.parameters)
        object.__setattr__(self, "parameters", dataclasses.asdict(ground))
        object.__setattr__(self, "seed", checked_seed(self.seed))

    def make(self) -> Heightfield:
        """Make the ground's heightfield, with the same bits every time."""
        return configuration(self.name, **self.parameters).make(self.seed)

    def to_json(self) -> dict[str, object]:
        """Convert the spec to an object that `json.dumps` can write."""
        plain: dict[str, object] = to_plain(self)
        return plain

    @classmethod
    def from_json(cls, data: object) -> "TerrainSpec":
        """Make a spec from an object that `TerrainSpec.to_json` returned.

        Raises:
          UnknownNameError: there is no such family, or it has no such parameter.
          BadValueError: the data has another shape, or holds an impossible value.
        """
        return from_plain(cls, data, "terrain")

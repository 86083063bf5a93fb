"""What a search tried and how its best gaits walk, as plain columns."""

from collections.abc import Mapping, Sequence
from typing import NamedTuple

from groundwalk.arrays import FloatArray
from worlds.scenes.scene import Scene
from worlds.world import FALLS


class SearchWalk(NamedTuple):
    """A gait's walk, once more."""

    scene: Scene
    """Robot, ground and recording."""
    distance_m: float
    """Forward."""
    time_s: float
    """Until the end of the walk."""
    reward: float
    """What this walk is worth, in the unit of the search's rewards."""

    @property
    def fell(self) -> bool:
        """Whether the robot fell; physics that blew up counts as a fall."""
        return self.scene.recording.metadata.end in FALLS


class SearchHistory(NamedTuple):
    """What a search tried; its rows are generations."""

    rewards: Sequence[FloatArray]
    """Of the gaits that were tried, each generation's."""
    falls: FloatArray
    """(generations,) how many of them fell."""
    mean_reward: FloatArray
    """(generations,) of the gait in the middle of the distribution."""
    mean: Mapping[str, FloatArray]
    """(generations,) each parameter of that gait."""
    spread: Mapping[str, FloatArray]
    """(generations,) standard deviation of each parameter, in its own unit."""
    best: Mapping[str, FloatArray]
    """(generations,) each parameter of the best gait; empty where it is not known."""
    units: Mapping[str, str]
    """Of parameters and, as "reward", of the reward."""
    walks: Sequence[SearchWalk] = ()
    """Each generation's best gait; none, or one for each generation."""
    no_walks: str = ""
    """Why there are no walks though the best gaits are known."""

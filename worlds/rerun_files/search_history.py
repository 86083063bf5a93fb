"""The history of a search for gaits: rewards, parameters, walks of the best gaits."""

from collections.abc import Mapping, Sequence
from typing import NamedTuple

from groundwalk.arrays import FloatArray
from worlds.scenes.scene import Scene
from worlds.world import FALLS


class SearchWalk(NamedTuple):
    """A walk of one generation's best gait, repeated in order to be shown.

    Attributes:
      scene: robot, ground and recording of the walk.
      distance_m: distance walked forward.
      time_s: duration of the walk.
      reward: in the unit of the search's rewards.
    """

    scene: Scene
    distance_m: float
    time_s: float
    reward: float

    @property
    def fell(self) -> bool:
        """Whether the robot fell; diverged physics counts as a fall."""
        return self.scene.recording.metadata.end in FALLS


class SearchHistory(NamedTuple):
    """History of a search for gaits; all arrays have one row for each generation.

    Each generation draws gaits from a normal distribution, tries and rewards them.

    Attributes:
      rewards: for each generation, the rewards (gaits,) of all gaits that it tried.
      falls: number of tried gaits that fell.
      mean_reward: reward of the mean gait of the distribution.
      mean, spread, best: by parameter name, its value in the mean gait, its standard
        deviation, and its value in the best gait ({} if unknown), in its unit.
      units: unit of each parameter by its name, and of the rewards under "reward".
      walks: walk of the best gait of each generation; empty if there are none.
      no_walks: reason, shown in the viewer, why the known best gaits have no walks.
    """

    rewards: Sequence[FloatArray]
    falls: FloatArray
    mean_reward: FloatArray
    mean: Mapping[str, FloatArray]
    spread: Mapping[str, FloatArray]
    best: Mapping[str, FloatArray]
    units: Mapping[str, str]
    walks: Sequence[SearchWalk] = ()
    no_walks: str = ""

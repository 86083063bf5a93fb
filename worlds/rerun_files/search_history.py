"""The history of a search for gaits: rewards, parameters, walks of the best gaits."""

from collections.abc import Mapping, Sequence
from typing import NamedTuple

from groundwalk.arrays import FloatArray
from worlds.scenes.scene import Scene
from worlds.world import FALLS


class SearchWalk(NamedTuple):
    """A walk of one generation's best gait, repeated in order to be shown."""

    scene: Scene
    """Robot, ground and recording of the walk."""
    distance_m: float
    """Distance walked forward [m]."""
    time_s: float
    """Duration of the walk [s]."""
    reward: float
    """Reward of this walk, in the unit of the search's rewards."""

    @property
    def fell(self) -> bool:
        """Whether the robot fell; diverged physics counts as a fall."""
        return self.scene.recording.metadata.end in FALLS


class SearchHistory(NamedTuple):
    """History of a search for gaits; all arrays have one row for each generation.

    Each generation draws gaits from a normal distribution, tries and rewards them.
    """

    rewards: Sequence[FloatArray]
    """For each generation, the rewards (gaits,) of all gaits that it tried."""
    falls: FloatArray
    """(generations,) number of tried gaits that fell."""
    mean_reward: FloatArray
    """(generations,) reward of the mean gait of the distribution."""
    mean: Mapping[str, FloatArray]
    """By parameter name, (generations,) its value in the mean gait, in its unit."""
    spread: Mapping[str, FloatArray]
    """By parameter name, (generations,) its standard deviation, in its unit."""
    best: Mapping[str, FloatArray]
    """By parameter name, (generations,) its value in the best gait; {} if unknown."""
    units: Mapping[str, str]
    """Unit of each parameter by its name, and of the rewards under "reward"."""
    walks: Sequence[SearchWalk] = ()
    """Walk of the best gait of each generation; empty if there are none."""
    no_walks: str = ""
    """Reason, shown in the viewer, why the known best gaits have no walks."""

"""The course of a search as columns: rewards, gaits, and walks of the best gaits."""

from collections.abc import Mapping, Sequence
from typing import NamedTuple

from groundwalk.arrays import FloatArray
from worlds.scenes.scene import Scene
from worlds.world import FALLS


class SearchWalk(NamedTuple):
    """A repeated walk of one generation's best gait."""

    scene: Scene
    """Robot, ground and recording."""
    distance_m: float
    """Distance walked forward [m]."""
    time_s: float
    """Duration of the walk [s]."""
    reward: float
    """Reward of this walk, in the unit of the search's rewards."""

    @property
    def fell(self) -> bool:
        """Whether the robot fell; physics that blew up counts as a fall."""
        return self.scene.recording.metadata.end in FALLS


class SearchHistory(NamedTuple):
    """The course of a search; rows of all arrays are generations."""

    rewards: Sequence[FloatArray]
    """For each generation, the rewards of all gaits that it tried."""
    falls: FloatArray
    """(generations,) number of tried gaits that fell."""
    mean_reward: FloatArray
    """(generations,) reward of the gait in the middle of the distribution."""
    mean: Mapping[str, FloatArray]
    """(generations,) each parameter of the gait in the middle, by name."""
    spread: Mapping[str, FloatArray]
    """(generations,) standard deviation of each parameter, in its own unit."""
    best: Mapping[str, FloatArray]
    """(generations,) each parameter of the best gait; no entries if it is unknown."""
    units: Mapping[str, str]
    """Unit of each parameter by its name, and of the reward under "reward"."""
    walks: Sequence[SearchWalk] = ()
    """Walk of each generation's best gait; none, or one for each generation."""
    no_walks: str = ""
    """Why there are no walks though the best gaits are known."""

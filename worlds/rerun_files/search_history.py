"""The history of a search for gaits: rewards, parameters, walks of the best gaits."""

from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np

from groundwalk.arrays import FloatArray
from worlds.scenes.scene import Scene
from worlds.world import FALLS


class SearchWalk(NamedTuple):
    """A walk of one generation's best gait, repeated in order to be shown.

    The reward is in the unit of the search's rewards, the distance that walked forward.
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


SAME_REWARD = 0.05
"""Rewards that differ by less count as equal, because one decimal is printed."""


def search_page(history: SearchHistory, generation: int) -> str:
    """Markdown about one generation: rewards, the best gait's walk, all parameters."""
    best = float(np.max(history.rewards[generation]))
    mean = float(history.mean_reward[generation])
    unit = history.units.get("reward", "")
    lines = [
        f"## Generation {generation}",
        "",
        f"Reward of the best gait {best:.1f}, of the mean gait {mean:.1f} {unit}.",
        "",
    ]
    if history.walks:
        lines += [_walk(history.walks[generation], best, unit), ""]
    elif history.no_walks:
        lines += [f"The best gait cannot walk here: {history.no_walks}", ""]
    lines += [
        "| parameter | unit | best gait | mean | spread |",
        "|---|---|---:|---:|---:|",
    ]
    for name in history.mean:
        columns = (history.best, history.mean, history.spread)
        cells = [_cell(column, name, generation) for column in columns]
        lines.append(
            " | ".join((f"| {name}", history.units.get(name, ""), *cells)) + " |"
        )
    return "\n".join(lines)


def _walk(walk: SearchWalk, rated: float, unit: str) -> str:
    """Sentence about the repeated walk; a warning if its reward is not `rated`."""
    end = walk.scene.recording.metadata.end
    text = f"The best gait walked {walk.distance_m:.2f} m in {walk.time_s:.2f} s"
    text += f": {end}." if end else "."
    if abs(walk.reward - rated) < SAME_REWARD:
        return text
    return (
        f"{text} **That is worth {walk.reward:.1f} {unit}, the search found "
        f"{rated:.1f}: robot, correction, program or machine are not the same.**"
    )


def _cell(column: Mapping[str, FloatArray], name: str, generation: int) -> str:
    return f"{column[name][generation]:.4g}" if name in column else ""

"""Text about one generation of a search for gaits, in Markdown."""

from collections.abc import Mapping

import numpy as np

from groundwalk.arrays import FloatArray
from worlds.rerun_files.search_history import SearchHistory, SearchWalk

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

"""Draws the search and the walks of a run, and writes its recordings for Rerun."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from experiments.reports.report import write_figure
from experiments.runs.folder import HISTORY, RECORDINGS, RunFolder
from experiments.seeing.scenes import make_scenes, read_recordings
from experiments.seeing.walk_figure import draw_walk
from groundwalk.errors import BadValueError, RunFolderError
from worlds.rerun_files.log import write_rrd

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure


MEAN, BEST, TRIED, FALLS = "#0072b2", "#e69f00", "#7f8894", "#d55e00"
"""Colours of the mean's, best and tried gaits' rewards and of the falls: a palette that
colour-blind people can distinguish (Okabe and Ito)."""

MOST_MARKED = 40
"""Number of generations above which lines have no markers, which would overlap."""

WIDTH = 0.6
"""Width of a generation's dots and bar, as a share of the distance to the next one."""


def search_figure(history: Sequence[Mapping[str, Any]]) -> "Figure":
    """Draw the rewards of a search and, in a panel below, the share of gaits that fell.

    The history has of each generation the `rewards` [cm/s] and number of `falls` of the
    gaits tried, and `mean_reward` [cm/s] and `mean_fell` of the mean gait.
    """
    from matplotlib.figure import Figure
    from matplotlib.ticker import MaxNLocator

    if not history:
        raise BadValueError("the search has no generation yet that could be drawn")
    figure = Figure(figsize=(8.0, 5.4), dpi=200, layout="constrained")
    above, below = figure.subplots(2, 1, sharex=True, height_ratios=(3, 1))
    _draw_rewards(above, history)
    _draw_falls(below, history)
    below.set_xlabel("generation")
    below.set_xlim(-0.6, len(history) - 0.4)
    below.xaxis.set_major_locator(MaxNLocator(integer=True, min_n_ticks=1))
    for axes in (above, below):
        axes.grid(axis="y", color="0.9")
        axes.set_axisbelow(True)
        axes.spines[["top", "right"]].set_visible(False)
    figure.align_ylabels()
    return figure


def _draw_rewards(axes: "Axes", history: Sequence[Mapping[str, Any]]) -> None:
    for generation, entry in enumerate(history):
        _draw_tried(axes, generation, entry["rewards"])
    every = np.arange(len(history))
    best = np.array([max(entry["rewards"]) for entry in history])
    mean = np.array([entry["mean_reward"] for entry in history])
    fell = np.array([entry["mean_fell"] for entry in history])
    dots, triangles = ("o", "^") if len(history) <= MOST_MARKED else ("", "")
    axes.plot(every, best, triangles + "--", color=BEST, lw=1, ms=4, label="best")
    axes.plot(every, mean, dots + "-", color=MEAN, lw=2.5, ms=5, label="the mean gait")
    if fell.any():
        axes.plot(every[fell], mean[fell], "kx", ms=9, label="the mean gait fell")
    axes.axhline(0, color="0.6", lw=0.8)
    axes.set_ylabel("reward [cm/s]\n(speed, less a penalty after a fall)")
    axes.set_title(
        f"CMA-ES search: reward of the mean gait {mean[0]:.1f} → {mean[-1]:.1f} cm/s",
        pad=24,
    )
    axes.legend(ncols=4, frameon=False, loc="lower center", bbox_to_anchor=(0.5, 1.0))


def _draw_tried(axes: "Axes", generation: int, rewards: Sequence[float]) -> None:
    """Draw the rewards [cm/s] of a generation's gaits as dots beside each other."""
    count = len(rewards)
    aside = WIDTH * ((np.arange(count) + 0.5) / count - 0.5)
    label = "gaits that were tried" if generation == 0 else None
    look: dict[str, Any] = {"color": TRIED, "alpha": 0.45, "ms": 5.5, "mew": 0}
    axes.plot(generation + aside, rewards, ".", label=label, **look)


def _draw_falls(axes: "Axes", history: Sequence[Mapping[str, Any]]) -> None:
    share = [100 * entry["falls"] / len(entry["rewards"]) for entry in history]
    axes.bar(range(len(history)), share, width=WIDTH, color=FALLS)
    axes.set_ylim(0, max(20, 1.15 * max(share)))
    axes.set_ylabel("tried gaits\nthat fell [%]")


SEARCH_PICTURE, WALK_PICTURE, WALK_RERUN = "search.png", "walk.png", "walk.rrd"
OVERLAY = "overlay.rrd"


def picture_run(folder: RunFolder) -> None:
    """Draw a run's search and walks, and write a Rerun file, as far as it has data."""
    picture_search(folder)
    recordings = read_recordings(folder.path / RECORDINGS)
    if recordings:
        draw_walk(recordings, folder.path / WALK_PICTURE)
        write_rrd(folder.path / WALK_RERUN, make_scenes(recordings))


def picture_search(folder: RunFolder) -> Path | None:
    """Draw a run's search, unless the picture is newer than the last generation.

    The result is the picture's path; None if the run has no finished generation.
    """
    history, picture = folder.path / HISTORY, folder.path / SEARCH_PICTURE
    if not history.exists():
        return None
    if not picture.exists() or picture.stat().st_mtime < history.stat().st_mtime:
        generations = folder.read_json(HISTORY).get("generations")
        if not generations:
            raise RunFolderError(f"{history} holds no generations")
        write_figure(search_figure(generations), picture)
    return picture

"""The figure of cliff walking: returns over noise, and two paths along the cliff."""

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from experiments.transfer.cliff_study.study import GAT, OPTIMUM, SGAT, UNGROUNDED, Row

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

FIGURE = "transfer_cliff.png"

STYLES: dict[str, dict[str, Any]] = {
    OPTIMUM: {"color": "#56b4e9", "linewidth": 6, "alpha": 0.6},
    UNGROUNDED: {"color": "#7f8894", "linestyle": "--", "marker": "s", "markersize": 9},
    GAT: {"color": "#d55e00", "marker": "^"},
    SGAT: {"color": "#0072b2", "marker": "o"},
}
"""Lines of the methods, in colours that colour-blind people can distinguish (Okabe
and Ito)."""

CLIFF_COLOUR, GOAL_COLOUR = "#f4c7b8", "#bfe3d0"


def cliff_figure(rows: Sequence[Row], grid: tuple[int, int]) -> "Figure":
    """Returns of all methods above; below, paths where GAT and SGAT differ most.

    `grid` is the number of rows and of columns of the grid world.
    """
    from matplotlib.figure import Figure

    figure = Figure(figsize=(8.0, 6.4), dpi=200, layout="constrained")
    above, below = figure.subplots(2, 1, height_ratios=(2.4, 1))
    _draw_returns(above, rows)
    _draw_paths(below, max(rows, key=_gap), grid)
    return figure


def _gap(row: Row) -> float:
    """Exact return of SGAT's policy minus that of GAT's."""
    return float(row["methods"][SGAT]["exact"] - row["methods"][GAT]["exact"])


def _draw_returns(axes: "Axes", rows: Sequence[Row]) -> None:
    noise = [row["noise"] for row in rows]
    for name, style in STYLES.items():
        scores = [row["methods"][name] for row in rows]
        axes.errorbar(
            noise,
            [score["mean"] for score in scores],
            yerr=[score["standard_error"] for score in scores],
            label=name,
            **style,
        )
    axes.set_xlabel("noise: chance that a move is random")
    axes.set_ylabel("return in the real world\n(mean and standard error)")
    axes.grid(axis="y", color="0.9")
    axes.set_axisbelow(True)
    axes.spines[["top", "right"]].set_visible(False)
    axes.legend(frameon=False)


def _draw_paths(axes: "Axes", row: Row, grid: tuple[int, int]) -> None:
    rows, columns = grid
    cells = {
        "cliff": (1, columns - 2, CLIFF_COLOUR),
        "goal": (columns - 1, 1, GOAL_COLOUR),
    }
    for text, (first, width, colour) in cells.items():
        axes.bar(first - 0.5, 1, width, rows - 1.5, align="edge", color=colour)
        axes.text(first - 0.5 + width / 2, rows - 0.56, text, ha="center")
    for name, aside in ((GAT, -0.06), (SGAT, 0.06)):
        path = np.array(row["methods"][name]["path"]) + aside
        axes.plot(
            path[:, 1], path[:, 0], lw=2.5, color=STYLES[name]["color"], label=name
        )
    axes.set_title(
        f"where the policies mean to go at noise {row['noise']:g}", fontsize=10
    )
    axes.set_xticks(np.arange(-0.5, columns), labels=[])
    axes.set_yticks(np.arange(-0.5, rows), labels=[])
    axes.set(xlim=(-0.5, columns - 0.5), ylim=(rows - 0.5, -0.5), aspect="equal")
    axes.grid(color="0.85")
    axes.set_axisbelow(True)
    axes.tick_params(length=0)
    axes.legend(frameon=False, loc="center left", bbox_to_anchor=(1.0, 0.5))

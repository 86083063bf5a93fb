"""Figure of a Gymnasium study: each method's return in the real world, over noise."""

from collections.abc import Sequence
from typing import TYPE_CHECKING

from experiments.transfer.gym_studies.rows import Row
from experiments.transfer.gym_studies.study import ANE, GAT, NONE, REAL, SGAT, SGAT_FULL

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

COLOURS = {
    NONE: "#7f8894",
    GAT: "#d55e00",
    SGAT: "#56b4e9",
    SGAT_FULL: "#0072b2",
    ANE: "#e69f00",
}
"""Colours that colour-blind people can distinguish (Okabe and Ito)."""
OTHER_COLOUR = "#009e73"
LINE_COLOUR = "#b2182b"
GROUP_WIDTH = 0.8


def returns_figure(rows: Sequence[Row]) -> "Figure":
    """Bars for the methods over noise, dashed lines for training in the real world.

    There is at least one row of results; each setting has its own axes.
    """
    from matplotlib.figure import Figure

    settings = list(dict.fromkeys(row["setting"] for row in rows))
    figure = Figure(figsize=(6.4 * len(settings), 4), dpi=150, layout="constrained")
    every = figure.subplots(1, len(settings), squeeze=False)[0]
    for axes, setting in zip(every, settings, strict=True):
        _draw(axes, [row for row in rows if row["setting"] == setting])
        axes.set_title(setting)
    every[0].set_ylabel("return on real\n(mean and standard error over seeds)")
    return figure


def _draw(axes: "Axes", rows: Sequence[Row]) -> None:
    bars = [name for name in rows[0]["methods"] if name != REAL]
    width = GROUP_WIDTH / max(len(bars), 1)
    for column, name in enumerate(bars):
        found = [row["methods"][name]["deterministic"] for row in rows]
        aside = (column - (len(bars) - 1) / 2) * width
        axes.bar(
            [place + aside for place in range(len(rows))],
            [score["mean"] for score in found],
            width,
            yerr=[score["standard_error"] for score in found],
            color=COLOURS.get(name, OTHER_COLOUR),
            capsize=3,
            label=name,
        )
    for place, row in enumerate(rows):
        if REAL in row["methods"]:
            height = row["methods"][REAL]["deterministic"]["mean"]
            axes.plot(
                [place - GROUP_WIDTH / 2, place + GROUP_WIDTH / 2],
                [height, height],
                color=LINE_COLOUR,
                linestyle="--",
                label=None if place else "as many steps on real",
            )
    axes.set_xticks(range(len(rows)), [f"{row['noise']:g}" for row in rows])
    axes.set_xlabel("noise: standard deviation over half of the action's range")
    axes.spines[["top", "right"]].set_visible(False)
    axes.legend(frameon=False, loc="center left", bbox_to_anchor=(1.0, 0.5))
